//! The components: a checked, immutable view of a pack.

use crate::kernel::Tiled;
use crate::model::{ComponentsMeta, LoadError, ModelMeta, Pack};
use crate::rig::Rig;

/// Style components for up to `ROWS` rows of coordinates and `COUNT` components, borrowed from a pack.
#[derive(Clone, Copy, Debug)]
pub struct Components<'a, const ROWS: usize, const COUNT: usize> {
    pub(super) meta: ComponentsMeta<'a>,
    pub(super) rows: usize,
    /// The first row is the root's.
    pub(super) travels: bool,
    /// Mean coordinates of the content, rad or m.
    pub(super) mean: &'a [[f32; 3]],
    /// What the style adds to the mean.
    pub(super) shift: &'a [[f32; 3]],
    /// Pseudo-inverse of `C_C`, `K x 3 rows`.
    pub(super) project: Tiled<'a>,
    /// `C_C`, `3 rows x K`.
    pub(super) compose: Tiled<'a>,
    /// `C_X - C_C`, `3 rows x K`.
    pub(super) change: Tiled<'a>,
    /// Stored stream, `frames x K`.
    pub(super) weights: &'a [f32],
    /// Path of the stored stream: `[travel x, travel z, sine, cosine of the turn]` since the frame before.
    pub(super) track: &'a [[f32; 4]],
}

impl<'a, const ROWS: usize, const COUNT: usize> Components<'a, ROWS, COUNT> {
    /// The components of a pack, after every check that makes [`step`](Self::step) infallible.
    pub fn load(pack: &Pack<'a>) -> Result<Self, LoadError> {
        let meta = pack
            .metadata()
            .models
            .iter()
            .find_map(ModelMeta::components)
            .ok_or(LoadError::NoModel { expected: "style components" })?;
        let rig = Rig::load(pack)?;
        let (rows, count, frames) = (rig.rows(), meta.count as usize, meta.frames as usize);
        fits("ROWS", rows, ROWS)?;
        fits("COUNT", count, COUNT)?;
        Ok(Self {
            meta,
            rows,
            travels: rig.travels(),
            mean: pack.slice("components/mean", rows)?,
            shift: pack.slice("components/shift", rows)?,
            project: Tiled::load(pack, "components/project", count, 3 * rows)?,
            compose: Tiled::load(pack, "components/compose", 3 * rows, count)?,
            change: Tiled::load(pack, "components/change", 3 * rows, count)?,
            weights: pack.slice("components/weights", frames.saturating_mul(count))?,
            track: pack.slice("components/track", frames)?,
        })
    }

    /// Name of the style, shape and plausible strengths.
    pub fn meta(&self) -> &ComponentsMeta<'a> {
        &self.meta
    }

    /// Rows of coordinates.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Frames of the stored stream; 0 if there is none.
    pub fn frames(&self) -> usize {
        self.track.len()
    }

    /// Multiply-adds of projection and composition of one live frame.
    pub fn multiply_adds(&self) -> usize {
        2 * 3 * self.rows * self.change.columns()
    }
}

fn fits(parameter: &'static str, found: usize, capacity: usize) -> Result<(), LoadError> {
    if found > capacity { Err(LoadError::Capacity { parameter, found, capacity }) } else { Ok(()) }
}
