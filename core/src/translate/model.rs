//! The translator: a checked, immutable view of a pack.

use super::fixed::Fixed;
use super::float::Float;
use core::marker::PhantomData;

use crate::model::{AnyNumbers, LoadError, ModelMeta, Numbers, Pack, TensorType, TranslatorMeta};
use crate::pose::Skeleton;

/// A style translator for up to `JOINTS` joints and `STATES` filter states, borrowed from a pack.
///
/// Coefficients are f32, or int16 with int32 states (`kinesic quantize --precision i16`): the pack decides. `STATES` counts two for every 2 x 2 block, plus, in the whole-body form, one for every principal coordinate.
#[derive(Clone, Copy, Debug)]
pub struct Translator<'a, const JOINTS: usize, const STATES: usize, N = AnyNumbers> {
    pub(super) meta: TranslatorMeta<'a>,
    pub(super) skeleton: Skeleton<'a>,
    /// Heading-local input: mean, m, and 1 / deviation, 1/m. Row 0 is `[travel x, height, travel z]` of the root.
    pub(super) mean: &'a [[f32; 3]],
    pub(super) inverse_deviation: &'a [[f32; 3]],
    pub(super) linear: Linear<'a>,
    numbers: PhantomData<N>,
}

/// Everything between the normalised input and the output, in the pack's number type.
#[derive(Clone, Copy, Debug)]
pub(super) enum Linear<'a> {
    Float(Float<'a>),
    Fixed(Fixed<'a>),
}

impl<'a, const JOINTS: usize, const STATES: usize> Translator<'a, JOINTS, STATES> {
    /// The translator of a pack in any number type, after every check that makes [`step`](Self::step) infallible.
    pub fn load(pack: &Pack<'a>) -> Result<Self, LoadError> {
        Self::load_numbers(pack)
    }
}

impl<'a, const JOINTS: usize, const STATES: usize, N: Numbers> Translator<'a, JOINTS, STATES, N> {
    /// [`load`](Translator::load) for the number types `N`: `Translator::<J, S, Integers>::load_numbers(&pack)` links no f32 bank.
    pub fn load_numbers(pack: &Pack<'a>) -> Result<Self, LoadError> {
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
        let linear = match pack.number("translate/direct")? {
            TensorType::F32 if N::FLOAT => Linear::Float(Float::load(pack, &meta, joints)?),
            TensorType::I16 if N::INTEGER => Linear::Fixed(Fixed::load(pack, &meta, joints)?),
            found => return Err(LoadError::NumberType { tensor: "translate/direct", found }),
        };
        Ok(Self {
            meta,
            skeleton,
            mean: pack.slice("translate/mean", joints)?,
            inverse_deviation: pack.slice("translate/inverse_deviation", joints)?,
            linear,
            numbers: PhantomData,
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
        let recursion = match &self.linear {
            Linear::Float(linear) => linear.multiply_adds(joints),
            Linear::Fixed(linear) => linear.multiply_adds(joints),
        };
        9 * joints + recursion
    }

    /// Number type of the coefficients: f32, or i16 with int32 states and sums.
    pub fn number(&self) -> TensorType {
        match self.linear {
            Linear::Float(_) => TensorType::F32,
            Linear::Fixed(_) => TensorType::I16,
        }
    }
}

fn fits(parameter: &'static str, found: usize, capacity: usize) -> Result<(), LoadError> {
    if found > capacity { Err(LoadError::Capacity { parameter, found, capacity }) } else { Ok(()) }
}
