//! A trained model, and how it goes into a pack.

use kinesic::mechanics::Body;
use kinesic::model::{Kind, MechanicsMeta, ModelMeta};

use super::network::Network;
use crate::pack::{PackWriter, Provenance};
use crate::rig::Rig;

/// Trained body mechanics: features -> hidden -> code -> pose. Shapes are those of [`kinesic::mechanics`].
#[derive(Clone, Debug)]
pub struct MechanicsModel {
    /// Name of the pack.
    pub name: String,
    /// Frames per second.
    pub frame_rate: f64,
    /// Sizes and joints.
    pub body: Body,
    /// Mean of the features.
    pub mean: Vec<f32>,
    /// 1 / deviation of the features; 0 for one that never changed.
    pub inverse_deviation: Vec<f32>,
    /// Three layers: hidden, code, decoder. The decoder gives quaternions as they are.
    pub network: Network,
}

impl MechanicsModel {
    /// The model as a pack for `rig`.
    pub fn pack(&self, rig: &Rig, provenance: &Provenance) -> Vec<u8> {
        let mut pack = PackWriter::new(Kind::Mechanics, &self.name, self.frame_rate as f32);
        rig.write(&mut pack);
        let units = |layer: usize| self.network.layers.get(layer).map_or(0, |l| l.outputs as u32);
        let paper = kinesic::mechanics::Decoupler::default();
        pack.model(&ModelMeta::Mechanics(MechanicsMeta {
            hidden: units(0),
            code: units(1),
            body_height: self.body.height,
            hip_height: self.body.hip_height,
            gain: paper.gain,
            exponent: paper.exponent,
        }));
        pack.u16s("mechanics/feet", 4, self.body.feet.as_flattened());
        pack.f32s("mechanics/clearance", 4, self.body.clearance.as_flattened());
        pack.u16s("mechanics/thighs", 2, &self.body.thighs);
        pack.f32s("mechanics/feature_mean", 1, &self.mean);
        pack.f32s("mechanics/feature_inverse_deviation", 1, &self.inverse_deviation);
        let names = [
            ("mechanics/hidden", "mechanics/hidden_bias"),
            ("mechanics/code", "mechanics/code_bias"),
            ("mechanics/decoder", "mechanics/decoder_bias"),
        ];
        for (layer, (weights, bias)) in self.network.layers.iter().zip(names) {
            pack.tiled(weights, layer.inputs, &layer.weights);
            pack.f32s(bias, 1, &layer.bias);
        }
        pack.finish(provenance)
    }
}
