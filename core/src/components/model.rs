//! The components: a checked, immutable view of a pack.

use crate::kernel::Tiled;
use crate::model::{ComponentsMeta, LoadError, ModelMeta, Pack};
use crate::pose::Skeleton;

/// Style components for up to `JOINTS` joints and `COUNT` components, borrowed from a pack.
#[derive(Clone, Copy, Debug)]
pub struct Components<'a, const JOINTS: usize, const COUNT: usize> {
    pub(super) meta: ComponentsMeta<'a>,
    pub(super) skeleton: Skeleton<'a>,
    /// Mean heading-local pose of the content, m.
    pub(super) mean: &'a [[f32; 3]],
    /// What the style adds to the mean pose, m.
    pub(super) shift: &'a [[f32; 3]],
    /// Pseudo-inverse of `C_C`, `K x 3 joints`, 1/m.
    pub(super) project: Tiled<'a>,
    /// `C_C`, `3 joints x K`, m.
    pub(super) compose: Tiled<'a>,
    /// `C_X - C_C`, `3 joints x K`, m.
    pub(super) change: Tiled<'a>,
    /// Stored stream, `frames x K`.
    pub(super) weights: &'a [f32],
    /// Path of the stored stream: `[travel x, travel z, sine, cosine of the turn]` since the frame before.
    pub(super) track: &'a [[f32; 4]],
    /// Local rotations `[i, j, k, w]` that the stored stream takes its twists from; the root faces +Z.
    pub(super) reference: &'a [[f32; 4]],
}

impl<'a, const JOINTS: usize, const COUNT: usize> Components<'a, JOINTS, COUNT> {
    /// The components of a pack, after every check that makes [`step`](Self::step) infallible.
    pub fn load(pack: &Pack<'a>) -> Result<Self, LoadError> {
        let meta = pack
            .metadata()
            .models
            .iter()
            .find_map(ModelMeta::components)
            .ok_or(LoadError::NoModel { expected: "style components" })?;
        let skeleton = Skeleton::load(pack)?;
        let (joints, count, frames) = (skeleton.joints(), meta.count as usize, meta.frames as usize);
        fits("JOINTS", joints, JOINTS)?;
        fits("COUNT", count, COUNT)?;
        Ok(Self {
            meta,
            skeleton,
            mean: pack.slice("components/mean", joints)?,
            shift: pack.slice("components/shift", joints)?,
            project: Tiled::load(pack, "components/project", count, 3 * joints)?,
            compose: Tiled::load(pack, "components/compose", 3 * joints, count)?,
            change: Tiled::load(pack, "components/change", 3 * joints, count)?,
            weights: pack.slice("components/weights", frames.saturating_mul(count))?,
            track: pack.slice("components/track", frames)?,
            reference: pack.slice("components/reference", joints)?,
        })
    }

    /// Name of the style, shape and plausible strengths.
    pub fn meta(&self) -> &ComponentsMeta<'a> {
        &self.meta
    }

    /// The skeleton that poses must have.
    pub fn skeleton(&self) -> &Skeleton<'a> {
        &self.skeleton
    }

    /// Frames of the stored stream; 0 if there is none.
    pub fn frames(&self) -> usize {
        self.track.len()
    }

    /// Multiply-adds of projection and composition of one live frame, without kinematics.
    pub fn multiply_adds(&self) -> usize {
        2 * 3 * self.skeleton.joints() * self.change.columns()
    }
}

fn fits(parameter: &'static str, found: usize, capacity: usize) -> Result<(), LoadError> {
    if found > capacity { Err(LoadError::Capacity { parameter, found, capacity }) } else { Ok(()) }
}
