//! The body-mechanics network: from what the body does to the pose that this alone asks for (Boehs 2017, section 3).

use nalgebra::Quaternion;

use super::decouple::{Decoupled, Decoupler, LARGEST_EXPONENT};
use super::features::{DynamicFeatures, FEATURES, FeatureState, fits};
use crate::kernel::{ROWS, Tiled, tanh};
use crate::model::{LoadError, MechanicsMeta, ModelMeta, Pack};
use crate::pose::{Pose, unit};

/// Features this many deviations away from the mean are cut: further away the network knows nothing.
const FARTHEST: f32 = 6.0;

/// Features -> hidden layer (tanh) -> code (tanh) -> decoder (linear) -> local unit quaternions of all joints but the hips.
///
/// Holds up to `JOINTS` joints, `UNITS` units in a layer and `WINDOW` frames of memory; the weights stay in flash.
#[derive(Clone, Copy, Debug)]
pub struct BodyMechanics<'a, const JOINTS: usize, const UNITS: usize, const WINDOW: usize> {
    meta: MechanicsMeta,
    features: DynamicFeatures<'a>,
    mean: &'a [f32],
    inverse_deviation: &'a [f32],
    hidden: Layer<'a>,
    code: Layer<'a>,
    decoder: Layer<'a>,
    /// Activity index.
    pub decoupler: Decoupler,
}

/// What a running model remembers.
pub type MechanicsState<const JOINTS: usize, const WINDOW: usize> = FeatureState<JOINTS, WINDOW>;

/// `W x + b`.
#[derive(Clone, Copy, Debug)]
struct Layer<'a> {
    weights: Tiled<'a>,
    bias: &'a [f32],
}

impl<'a> Layer<'a> {
    fn load(
        pack: &Pack<'a>,
        [weights, bias]: [&'static str; 2],
        rows: usize,
        columns: usize,
    ) -> Result<Self, LoadError> {
        let expected = rows.div_ceil(ROWS).saturating_mul(columns);
        let tiles = pack.slice(weights, expected)?;
        let shape = LoadError::Shape { tensor: weights, found: tiles.len(), expected };
        Ok(Self { weights: Tiled::new(rows, columns, tiles).ok_or(shape)?, bias: pack.slice(bias, rows)? })
    }

    /// `out` gets one value a row; what lies behind is left alone.
    fn apply(&self, x: &[f32], out: &mut [f32]) {
        let rows = self.bias.len().min(out.len());
        if let Some((out, _)) = out.split_at_mut_checked(rows) {
            for (out, bias) in out.iter_mut().zip(self.bias) {
                *out = *bias;
            }
            self.weights.multiply_add(x, out);
        }
    }

    fn apply_tanh(&self, x: &[f32], out: &mut [f32]) {
        self.apply(x, out);
        for out in out.iter_mut().take(self.bias.len()) {
            *out = tanh(*out);
        }
    }
}

impl<'a, const JOINTS: usize, const UNITS: usize, const WINDOW: usize> BodyMechanics<'a, JOINTS, UNITS, WINDOW> {
    /// The body mechanics of a pack, after every check that makes [`step`](Self::step) infallible.
    pub fn load(pack: &Pack<'a>) -> Result<Self, LoadError> {
        let models = pack.metadata().models;
        let meta = models.iter().find_map(ModelMeta::mechanics);
        let meta = meta.ok_or(LoadError::NoModel { expected: "body mechanics" })?;
        let features = DynamicFeatures::load(pack, &meta, JOINTS, WINDOW)?;
        let (hidden, code) = (meta.hidden as usize, meta.code as usize);
        fits("UNITS", hidden.max(code), UNITS)?;
        if !meta.gain.is_finite() || !(1..=LARGEST_EXPONENT).contains(&meta.exponent) || hidden == 0 || code == 0 {
            return Err(LoadError::Metadata);
        }
        let outputs = 4 * features.skeleton().joints().saturating_sub(1);
        Ok(Self {
            meta,
            features,
            mean: pack.slice("mechanics/feature_mean", FEATURES)?,
            inverse_deviation: pack.slice("mechanics/feature_inverse_deviation", FEATURES)?,
            hidden: Layer::load(pack, ["mechanics/hidden", "mechanics/hidden_bias"], hidden, FEATURES)?,
            code: Layer::load(pack, ["mechanics/code", "mechanics/code_bias"], code, hidden)?,
            decoder: Layer::load(pack, ["mechanics/decoder", "mechanics/decoder_bias"], outputs, code)?,
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
        let layers = [self.hidden, self.code, self.decoder];
        layers.iter().map(|l| l.bias.len().next_multiple_of(ROWS) * l.weights.columns()).sum()
    }

    /// `B`: the pose that the features ask for. Root and hips are those of `observed`.
    ///
    /// A joint about which the network is undecided (a quaternion of no length) is at rest. Cost:
    /// [`multiply_adds`](Self::multiply_adds) and a tanh a unit.
    pub fn predict(&self, features: &[f32; FEATURES], observed: &Pose<JOINTS>, mechanics: &mut Pose<JOINTS>) {
        let mut input = [0.0; FEATURES];
        for (((input, feature), mean), scale) in
            input.iter_mut().zip(features).zip(self.mean).zip(self.inverse_deviation)
        {
            *input = ((feature - mean) * scale).clamp(-FARTHEST, FARTHEST);
        }
        let (mut hidden, mut code, mut output) = ([0.0; UNITS], [0.0; UNITS], [[0.0f32; 4]; JOINTS]);
        self.hidden.apply_tanh(&input, &mut hidden);
        self.code.apply_tanh(&hidden, &mut code);
        self.decoder.apply(&code, output.as_flattened_mut());
        *mechanics = *observed;
        let joints = self.features.skeleton().joints().saturating_sub(1);
        for (rotation, [x, y, z, w]) in mechanics.rotations.iter_mut().skip(1).zip(output).take(joints) {
            *rotation = unit(Quaternion::new(w, x, y, z));
        }
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
