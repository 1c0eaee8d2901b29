//! The translator: a checked, immutable view of a pack.

use super::bank::Bank;
use crate::model::{Form, LoadError, ModelMeta, Pack, TranslatorMeta};
use crate::pose::Skeleton;

/// A style translator for up to `JOINTS` joints and `STATES` filter states, borrowed from a pack.
///
/// `STATES` counts two for every 2 x 2 block, plus, in the whole-body form, one for every principal coordinate.
#[derive(Clone, Copy, Debug)]
pub struct Translator<'a, const JOINTS: usize, const STATES: usize> {
    pub(super) meta: TranslatorMeta<'a>,
    pub(super) skeleton: Skeleton<'a>,
    /// Heading-local input: mean, m, and 1 / deviation, 1/m. Row 0 is `[travel x, height, travel z]` of the root.
    pub(super) mean: &'a [[f32; 3]],
    pub(super) inverse_deviation: &'a [[f32; 3]],
    /// Output at zero input and state, m.
    pub(super) bias: &'a [[f32; 3]],
    /// Direct term from a joint to itself, row-major 3 x 3, m.
    pub(super) direct: &'a [[f32; 9]],
    pub(super) timing: TimingHead<'a>,
    pub(super) bank: Bank<'a>,
}

/// log2 of the duration, as a linear function of the normalised input (and, whole body, of the states).
#[derive(Clone, Copy, Debug)]
pub(super) struct TimingHead<'a> {
    pub bias: f32,
    /// Lowest and highest log2 that was seen in training.
    pub range: [f32; 2],
    pub input: &'a [f32],
    pub states: &'a [f32],
}

impl<'a, const JOINTS: usize, const STATES: usize> Translator<'a, JOINTS, STATES> {
    /// The translator of a pack, after every check that makes [`step`](Self::step) infallible.
    pub fn load(pack: &Pack<'a>) -> Result<Self, LoadError> {
        let meta = pack
            .metadata()
            .models
            .iter()
            .find_map(ModelMeta::translator)
            .ok_or(LoadError::NoModel { expected: "translator" })?;
        let skeleton = Skeleton::load(pack)?;
        let joints = skeleton.joints();
        fits("JOINTS", joints, JOINTS)?;
        let states = 2 * meta.blocks as usize;
        fits("STATES", states.saturating_add(meta.drives as usize), STATES)?;
        let bank = Bank::load(pack, &meta, joints)?;
        let timing_states = if meta.form == Form::WholeBody { states + meta.drives as usize } else { 0 };
        let [bias, low, high] = match pack.slice::<[f32; 3]>("translate/timing", 1)? {
            [timing] => *timing,
            _ => [0.0; 3],
        };
        Ok(Self {
            meta,
            skeleton,
            mean: pack.slice("translate/mean", joints)?,
            inverse_deviation: pack.slice("translate/inverse_deviation", joints)?,
            bias: pack.slice("translate/bias", joints)?,
            direct: pack.slice("translate/direct", joints)?,
            timing: TimingHead {
                bias,
                range: [low, high],
                input: pack.slice("translate/timing_input", 3 * joints)?,
                states: pack.slice("translate/timing_states", timing_states)?,
            },
            bank,
        })
    }

    /// Name of the style, form, shape and plausible strengths.
    pub fn meta(&self) -> &TranslatorMeta<'a> {
        &self.meta
    }

    /// The skeleton that poses must have.
    pub fn skeleton(&self) -> &Skeleton<'a> {
        &self.skeleton
    }

    /// Multiply-adds of the recursion of one frame: the bank alone, without kinematics.
    pub fn multiply_adds(&self) -> usize {
        let joints = self.skeleton.joints();
        9 * joints + self.bank.multiply_adds(joints)
    }
}

fn fits(parameter: &'static str, found: usize, capacity: usize) -> Result<(), LoadError> {
    if found > capacity { Err(LoadError::Capacity { parameter, found, capacity }) } else { Ok(()) }
}
