//! The body-mechanics network: from what the body does to the pose that this alone asks for (Boehs 2017, section 3).

use core::marker::PhantomData;

use super::decouple::{Decoupled, Decoupler, LARGEST_EXPONENT};
use super::features::{DynamicFeatures, FEATURES, FeatureState};
use super::layers::{FARTHEST, Layers, Precision};
use crate::model::{AnyNumbers, LoadError, MechanicsMeta, ModelMeta, Numbers, Pack};
use crate::pose::Pose;

/// Features -> hidden layer (tanh) -> code (tanh) -> decoder (linear) -> local unit quaternions of all joints but the hips.
///
/// Holds up to `JOINTS` joints, `UNITS` units in the hidden layer and the code together (each rounded up to 4) and `WINDOW` frames of memory; the weights stay in flash.
#[derive(Clone, Copy, Debug)]
pub struct BodyMechanics<'a, const JOINTS: usize, const UNITS: usize, const WINDOW: usize, N = AnyNumbers> {
    meta: MechanicsMeta,
    features: DynamicFeatures<'a>,
    mean: &'a [f32],
    inverse_deviation: &'a [f32],
    layers: Layers<'a>,
    numbers: PhantomData<N>,
    /// Activity index.
    pub decoupler: Decoupler,
}

/// What a running model remembers.
pub type MechanicsState<const JOINTS: usize, const WINDOW: usize> = FeatureState<JOINTS, WINDOW>;

impl<'a, const JOINTS: usize, const UNITS: usize, const WINDOW: usize> BodyMechanics<'a, JOINTS, UNITS, WINDOW> {
    /// The body mechanics of a pack in any number type, after every check that makes [`step`](Self::step) infallible.
    pub fn load(pack: &Pack<'a>) -> Result<Self, LoadError> {
        Self::load_numbers(pack)
    }
}

impl<'a, const JOINTS: usize, const UNITS: usize, const WINDOW: usize, N: Numbers>
    BodyMechanics<'a, JOINTS, UNITS, WINDOW, N>
{
    /// [`load`](BodyMechanics::load) for the number types `N`: `Integers` links no f32 network, `Floats` no int8 one.
    pub fn load_numbers(pack: &Pack<'a>) -> Result<Self, LoadError> {
        let models = pack.metadata().models;
        let meta = models.iter().find_map(ModelMeta::mechanics);
        let meta = meta.ok_or(LoadError::NoModel { expected: "body mechanics" })?;
        let features = DynamicFeatures::load(pack, &meta, JOINTS, WINDOW)?;
        let (hidden, code) = (meta.hidden as usize, meta.code as usize);
        if !meta.gain.is_finite() || !(1..=LARGEST_EXPONENT).contains(&meta.exponent) || hidden == 0 || code == 0 {
            return Err(LoadError::Metadata);
        }
        let outputs = 4 * features.skeleton().joints().saturating_sub(1);
        Ok(Self {
            meta,
            features,
            mean: pack.slice("mechanics/feature_mean", FEATURES)?,
            inverse_deviation: pack.slice("mechanics/feature_inverse_deviation", FEATURES)?,
            layers: Layers::load::<N>(pack, [hidden, code, outputs], UNITS)?,
            numbers: PhantomData,
            decoupler: Decoupler { gain: meta.gain, exponent: meta.exponent },
        })
    }

    /// Shape and sizes.
    pub fn meta(&self) -> &MechanicsMeta {
        &self.meta
    }

    /// How the features are computed.
    pub fn features(&self) -> &DynamicFeatures<'a> {
        &self.features
    }

    /// Multiply-adds of the network alone, a frame.
    pub fn multiply_adds(&self) -> usize {
        self.layers.multiply_adds()
    }

    /// Number type of the weights.
    pub fn precision(&self) -> Precision {
        self.layers.precision()
    }

    /// `B`: the pose that the features ask for. Root and hips are those of `observed`.
    ///
    /// A joint about which the network is undecided (a quaternion of no length) is at rest. Cost:
    /// [`multiply_adds`](Self::multiply_adds) and a tanh a unit. RAM: `UNITS` numbers on the stack, 4 B each in f32, 2 B in int8.
    pub fn predict(&self, features: &[f32; FEATURES], observed: &Pose<JOINTS>, mechanics: &mut Pose<JOINTS>) {
        let mut input = [0.0; FEATURES];
        for (((input, feature), mean), scale) in
            input.iter_mut().zip(features).zip(self.mean).zip(self.inverse_deviation)
        {
            *input = ((feature - mean) * scale).clamp(-FARTHEST, FARTHEST);
        }
        *mechanics = *observed;
        let joints = self.features.skeleton().joints().saturating_sub(1);
        self.layers.apply::<UNITS, N>(&input, mechanics.rotations.iter_mut().skip(1).take(joints));
    }

    /// One frame: features, network, decoupling. Infallible; every loop has a length fixed at load time.
    ///
    /// A pose that is not sound (dropped, garbled, not finite) is held: the last sound one is decoupled again.
    pub fn step(
        &self,
        state: &mut MechanicsState<JOINTS, WINDOW>,
        observed: &Pose<JOINTS>,
        parts: &mut Decoupled<JOINTS>,
    ) {
        self.features.step(state, observed);
        let mut mechanics = Pose::identity();
        self.predict(state.features(), state.pose(), &mut mechanics);
        self.decoupler.split(state.pose(), &mechanics, parts);
    }
}
