//! A trained emotion model, and how it goes into a pack and comes back.

use kinesic::Pack;
use kinesic::emotion::Emotion;
use kinesic::kernel::ROWS as TILE;
use kinesic::model::{ATTRIBUTES, AttributeMeta, EmotionMeta, Kind, LoadError, ModelMeta};

use crate::learn::Regression;
use crate::pack::{PackWriter, Provenance};
use crate::rig::{MAX_ROWS, Rig};

/// Keyframes that the host plays.
pub const MAX_KEYS: usize = 64;
/// Components, or hidden units and attributes together, that the host plays.
pub const MAX_WIDTH: usize = 256;

/// The device's emotion model at the host's capacity.
pub type HostEmotion<'a> = Emotion<'a, MAX_ROWS, MAX_KEYS, MAX_WIDTH>;

/// One attribute.
#[derive(Clone, Debug, PartialEq)]
pub struct Attribute {
    /// Name, as the training table called it.
    pub name: String,
    /// Strengths that nearly all training motions lie between.
    pub strength: [f32; 2],
}

/// An emotion model: what training makes and the device loads.
#[derive(Clone, Debug, PartialEq)]
pub struct EmotionModel {
    /// Name of the motion.
    pub motion: String,
    /// Frames per second of the training clips: what playback uses where nobody asks for another rate.
    pub frame_rate: f32,
    /// 1 to [`ATTRIBUTES`] attributes, the network's inputs.
    pub attributes: Vec<Attribute>,
    /// Keyframes, K.
    pub keyframes: usize,
    /// True for a cycle: the last keyframe is the first one of the next round.
    pub cycle: bool,
    /// Shortest and longest time between two keyframes, s.
    pub duration: [f32; 2],
    /// Strengths -> components `[K x D]`.
    pub network: Regression,
    /// Back-projection `[2 channels x D]`, row-major: [`channels`](super::coordinates), rad or m, then velocities times levers, m/s.
    pub basis: Vec<f64>,
    /// Mean keyframe `[2 channels]`.
    pub mean: Vec<f64>,
    /// How far a unit of each channel moves the body, m per rad or m.
    pub levers: Vec<f64>,
    /// How the host reads motions. The device does not use it.
    pub reading: Reading,
}

/// How strengths are read from the positions of a motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Reading {
    /// Part of the length at which each keyframe lies on average, 0 to 1.
    pub parts: Vec<f64>,
    /// Posture at each keyframe: positions seen from the root, m, `[K x 3 joints]`.
    pub postures: Vec<f64>,
    /// Ranking functions of the [features](super::features) `[attributes x (K x 6 joints)]`.
    pub rank: Vec<f64>,
    /// Their constants.
    pub bias: Vec<f64>,
}

impl EmotionModel {
    /// Components of a keyframe, D.
    pub fn components(&self) -> usize {
        self.network.bias.len() / self.keyframes.max(1)
    }

    /// The model as a pack for `rig`.
    pub fn pack(&self, rig: &Rig, provenance: &Provenance) -> Vec<u8> {
        let mut pack = PackWriter::new(Kind::Emotion, &self.motion, self.frame_rate);
        rig.write(&mut pack);
        let (units, inputs) = (self.network.hidden_bias.len(), self.network.inputs);
        let (components, channels) = (self.components(), self.levers.len());
        let mut attributes = [None; ATTRIBUTES];
        for (to, attribute) in attributes.iter_mut().zip(&self.attributes) {
            *to = Some(AttributeMeta { name: &attribute.name, strength: attribute.strength });
        }
        pack.model(&ModelMeta::Emotion(EmotionMeta {
            motion: &self.motion,
            attributes,
            keyframes: self.keyframes as u32,
            components: components as u32,
            hidden: units as u32,
            cycle: self.cycle,
            duration: self.duration,
        }));
        let rows = self.network.hidden.chunks_exact(inputs).zip(&self.network.hidden_bias);
        let hidden: Vec<f64> = rows.flat_map(|(row, bias)| row.iter().chain([bias]).copied()).collect();
        pack.f32s("emotion/hidden", inputs + 1, &single(&hidden));
        pack.tiled("emotion/output", units + inputs, &self.output_layers());
        pack.f32s("emotion/output_bias", components, &single(&self.network.bias));
        let (coordinates, velocity) = self.basis.split_at(channels * components);
        pack.tiled("emotion/coordinates", components, &single(coordinates));
        pack.f32s("emotion/mean", 1, &single(&self.mean[..channels]));
        pack.tiled("emotion/velocity", components, &single(velocity));
        pack.f32s("emotion/velocity_mean", 1, &single(&self.mean[channels..]));
        pack.f32s("emotion/lever", 1, &single(&self.levers));
        let Reading { parts, postures, rank, bias } = &self.reading;
        pack.f32s("emotion/parts", 1, &single(parts));
        pack.f32s("emotion/postures", 3, &single(postures));
        pack.f32s("emotion/rank", 6 * rig.joints(), &single(rank));
        pack.f32s("emotion/rank_bias", 1, &single(bias));
        pack.finish(provenance)
    }

    /// `[D x (units + inputs)]` of every keyframe, row-major, each padded to whole tiles.
    fn output_layers(&self) -> Vec<f32> {
        let (units, inputs) = (self.network.hidden_bias.len(), self.network.inputs);
        let components = self.components();
        let mut layers = Vec::new();
        for key in 0..self.keyframes {
            for row in key * components..(key + 1) * components {
                layers.extend(single(&self.network.output[row * units..][..units]));
                layers.extend(single(&self.network.linear[row * inputs..][..inputs]));
            }
            layers.resize((key + 1) * components.next_multiple_of(TILE) * (units + inputs), 0.0);
        }
        layers
    }

    /// The model that a pack holds.
    pub fn from_pack(pack: &Pack) -> Result<Self, LoadError> {
        // Everything that the device checks.
        let device = HostEmotion::load(pack)?;
        let meta = device.meta();
        let (inputs, channels) = (device.attributes(), pack.rows("emotion/lever")?);
        let (keyframes, components, units) = (meta.keyframes as usize, meta.components as usize, meta.hidden as usize);
        let hidden: &[f32] = pack.slice("emotion/hidden", units * (inputs + 1))?;
        let padded = components.next_multiple_of(TILE);
        let output: &[f32] = flat(pack, "emotion/output", keyframes * padded * (units + inputs))?;
        let output = untile(units + inputs, output);
        let mut network = Regression {
            inputs,
            hidden: hidden.chunks_exact(inputs + 1).flat_map(|row| double(&row[..inputs])).collect(),
            hidden_bias: hidden.chunks_exact(inputs + 1).map(|row| f64::from(row[inputs])).collect(),
            output: Vec::new(),
            linear: Vec::new(),
            bias: double(pack.slice("emotion/output_bias", keyframes * components)?),
        };
        for layer in output.chunks_exact(padded * (units + inputs)) {
            for row in layer.chunks_exact(units + inputs).take(components) {
                network.output.extend(double(&row[..units]));
                network.linear.extend(double(&row[units..]));
            }
        }
        let mut basis = Vec::new();
        for name in ["emotion/coordinates", "emotion/velocity"] {
            let tiles = flat(pack, name, channels.next_multiple_of(TILE) * components)?;
            basis.extend(double(&untile(components, tiles)[..channels * components]));
        }
        let numbers = |name| Ok::<_, LoadError>(double(pack.slice(name, channels)?));
        Ok(Self {
            motion: meta.motion.to_owned(),
            frame_rate: pack.metadata().frame_rate,
            attributes: meta
                .attributes
                .iter()
                .flatten()
                .map(|attribute| Attribute { name: attribute.name.to_owned(), strength: attribute.strength })
                .collect(),
            keyframes,
            cycle: meta.cycle,
            duration: meta.duration,
            network,
            basis,
            mean: [numbers("emotion/mean")?, numbers("emotion/velocity_mean")?].concat(),
            levers: numbers("emotion/lever")?,
            reading: Reading::from_pack(pack, keyframes, inputs)?,
        })
    }
}

impl Reading {
    fn from_pack(pack: &Pack, keyframes: usize, attributes: usize) -> Result<Self, LoadError> {
        let joints = pack.metadata().joints.len();
        let postures = pack.slice::<[f32; 3]>("emotion/postures", keyframes * joints)?;
        Ok(Self {
            parts: double(pack.slice("emotion/parts", keyframes)?),
            postures: double(postures.as_flattened()),
            rank: double(pack.slice("emotion/rank", attributes * keyframes * 6 * joints)?),
            bias: double(pack.slice("emotion/rank_bias", attributes)?),
        })
    }
}

fn flat<'a>(pack: &Pack<'a>, name: &'static str, numbers: usize) -> Result<&'a [f32], LoadError> {
    Ok(pack.slice::<[f32; TILE]>(name, numbers / TILE)?.as_flattened())
}

fn single(values: &[f64]) -> Vec<f32> {
    values.iter().map(|x| *x as f32).collect()
}

fn double(values: &[f32]) -> Vec<f64> {
    values.iter().map(|x| f64::from(*x)).collect()
}

/// Row-major, with the padding rows, from the order of [`kinesic::kernel::Tiled`].
fn untile(columns: usize, tiles: &[f32]) -> Vec<f32> {
    let mut rows = vec![0.0; tiles.len()];
    for (tile, block) in tiles.chunks_exact(TILE * columns).enumerate() {
        for (at, value) in block.iter().enumerate() {
            rows[(tile * TILE + at % TILE) * columns + at / TILE] = *value;
        }
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::emotion::synthetic;
    use crate::pack::PackFile;

    #[test]
    fn a_pack_gives_the_model_back_and_the_device_computes_its_network() {
        let (model, rig) = synthetic::model(2);
        let file = PackFile::from_bytes(&model.pack(&rig, &Provenance::default()));
        let pack = file.pack().unwrap();
        let back = EmotionModel::from_pack(&pack).unwrap();
        assert_eq!(back.pack(&rig, &Provenance::default()), file.bytes());
        let device = HostEmotion::load(&pack).unwrap();
        let mut motion = vec![0.0; model.network.bias.len()];
        device.motion(&[0.3, -0.2, 0.0, 0.0], &mut motion);
        let expected = model.network.apply(&[0.3, -0.2]);
        for (found, expected) in motion.iter().zip(&expected) {
            assert!((f64::from(*found) - expected).abs() < 1e-4, "{found} {expected}");
        }
    }
}
