//! From f32 packs to packs with int8 weights (networks) or int16 coefficients (translators).

mod translator;

pub use translator::to_int16;

use kinesic::kernel::{LARGEST_ACTIVATION, MOST_COLUMNS, PRE_ACTIVATION_BITS};
use kinesic::mechanics::{Decoupled, FEATURES, INPUT_SCALE, OUTPUT_BITS};
use kinesic::model::{LoadError, TensorType};
use kinesic::{MechanicsState, Pack, Pose};

use nalgebra::UnitQuaternion;
use serde::Serialize;

use crate::clip::Clip;
use crate::mechanics::HostMechanics;
use crate::pack::layout::{IntegerLayer, row_major, tile_bytes};
use crate::pack::{PackFile, PackWriter, Provenance};
use crate::rig::{MAX_JOINTS, Rig};
use crate::translate::{self, play};

/// Largest size of a weight in int8.
const LARGEST_WEIGHT: f64 = 127.0;

/// Why a pack cannot be quantised.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum QuantiseError {
    /// The pack does not load.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// A translator of several actions.
    #[error("the pack holds experts for several actions, which have no int16 form")]
    #[diagnostic(help("keep the f32 pack, or train one action, or train with --no-gate"))]
    Experts,
    /// Nothing in it has an int8 form.
    #[error("the pack holds no body mechanics: found {found}")]
    #[diagnostic(help(
        "int8 is for networks; translators have int16 (--precision i16), components and faces stay in f32"
    ))]
    NoNetwork {
        /// What it holds.
        found: String,
    },
    /// Nothing in it has an int16 form.
    #[error("the pack holds no translator: found {found}")]
    #[diagnostic(help(
        "int16 is for translators; networks have int8 (--precision i8), components and faces stay in f32"
    ))]
    NoTranslator {
        /// What it holds.
        found: String,
    },
    /// It is done already.
    #[error("the numbers of the pack are {number} already")]
    #[diagnostic(help("quantise the f32 pack that it was made from"))]
    Done {
        /// Their type.
        number: &'static str,
    },
    /// A pole too near the unit circle, or a pair of poles that are coupled too strongly.
    #[error("block {block} has a pole so near the unit circle, or a coupling so strong, that int16 cannot hold it")]
    #[diagnostic(help("train with fewer states (--order), or keep the f32 pack"))]
    Pole {
        /// Index of the 2 x 2 block.
        block: usize,
    },
    /// A layer has more columns than sums can hold.
    #[error("the layer {layer} has {found} columns, int32 sums hold at most {MOST_COLUMNS}")]
    #[diagnostic(help("train a smaller network: --hidden, --code"))]
    Columns {
        /// Name of its tensor.
        layer: &'static str,
        /// Columns.
        found: usize,
    },
    /// A weight or a bias too large for the fixed-point result.
    #[error(
        "row {row} of the layer {layer} has a weight or bias of size {found:.1}, too large for the fixed-point result"
    )]
    #[diagnostic(help(
        "train a translator with --form per-joint, a network with more weight decay, or keep the f32 pack"
    ))]
    Range {
        /// Name of its tensor.
        layer: &'static str,
        /// The row.
        row: usize,
        /// Largest size in the row.
        found: f32,
    },
}

/// Rounds a row-major layer of `columns` inputs to int8 with a scale a row. `input` is the value of one unit of its integer input;
/// results are in units of `2^-bits`.
pub fn layer(
    name: &'static str,
    columns: usize,
    weights: &[f32],
    bias: &[f32],
    input: f64,
    bits: u32,
) -> Result<IntegerLayer, QuantiseError> {
    if columns > MOST_COLUMNS {
        return Err(QuantiseError::Columns { layer: name, found: columns });
    }
    let (mut rows, mut multipliers, mut biases) = (Vec::new(), Vec::new(), Vec::new());
    let unit = f64::from(1u32 << bits);
    for (row, (weights, bias)) in weights.chunks_exact(columns.max(1)).zip(bias).enumerate() {
        let largest = weights.iter().fold(0.0f32, |most, w| most.max(w.abs()));
        let scale = f64::from(largest) / LARGEST_WEIGHT;
        let multiplier = (scale * input * unit * 4_294_967_296.0).round();
        let bias_units = (f64::from(*bias) * unit).round();
        // Half of the range for the bias, so that it and the sum fit together.
        if multiplier > f64::from(i32::MAX) || bias_units.abs() > f64::from(i32::MAX / 2) {
            return Err(QuantiseError::Range { layer: name, row, found: largest.max(bias.abs()) });
        }
        multipliers.push(multiplier as i32);
        biases.push(bias_units as i32);
        let rounded = |weight: &f32| if scale > 0.0 { (f64::from(*weight) / scale).round() as i8 } else { 0 };
        rows.push(weights.iter().map(rounded).collect::<Vec<i8>>());
    }
    Ok(IntegerLayer { weights: tile_bytes(columns, &rows), multipliers, bias: biases })
}

/// Weights, scale and bias of a layer by name.
struct Names {
    weights: &'static str,
    scale: &'static str,
    bias: &'static str,
}

const LAYERS: [Names; 3] = [
    Names { weights: "mechanics/hidden", scale: "mechanics/hidden_scale", bias: "mechanics/hidden_bias" },
    Names { weights: "mechanics/code", scale: "mechanics/code_scale", bias: "mechanics/code_bias" },
    Names { weights: "mechanics/decoder", scale: "mechanics/decoder_scale", bias: "mechanics/decoder_bias" },
];

/// The pack with int8 weights in its body-mechanics network. Everything else is copied bit for bit; nothing random.
pub fn to_int8(file: &PackFile, provenance: &Provenance) -> Result<Vec<u8>, QuantiseError> {
    let pack = file.pack()?;
    let metadata = pack.metadata();
    let Some(meta) = metadata.models.iter().find_map(|model| model.mechanics()) else {
        return Err(QuantiseError::NoNetwork { found: named(&pack) });
    };
    if pack.number(LAYERS[0].weights)? == TensorType::I8 {
        return Err(QuantiseError::Done { number: "int8" });
    }
    let (hidden, code) = (meta.hidden as usize, meta.code as usize);
    let outputs = 4 * metadata.joints.len().saturating_sub(1);
    let shapes = [(hidden, FEATURES), (code, hidden), (outputs, code)];
    let activation = 1.0 / f64::from(LARGEST_ACTIVATION);
    let units = [
        (1.0 / f64::from(INPUT_SCALE), PRE_ACTIVATION_BITS),
        (activation, PRE_ACTIVATION_BITS),
        (activation, OUTPUT_BITS),
    ];

    let mut out = PackWriter::new(pack.kind(), metadata.name, metadata.frame_rate);
    metadata.joints.iter().for_each(|joint| out.joint(joint.name, joint.parent));
    metadata.models.iter().for_each(|model| out.model(&model));
    let replaced = |name: &str| LAYERS.iter().any(|layer| name == layer.weights || name == layer.bias);
    for tensor in metadata.tensors.iter().filter(|tensor| !replaced(tensor.name)) {
        out.copy(&tensor, pack.bytes(&tensor).ok_or(LoadError::Metadata)?);
    }
    for ((names, (rows, columns)), (input, bits)) in LAYERS.iter().zip(shapes).zip(units) {
        let weights = row_major(&pack, names.weights, rows, columns)?;
        let bias: &[f32] = pack.slice(names.bias, rows)?;
        let integer = layer(names.weights, columns, &weights, bias, input, bits)?;
        out.integer_layer([names.weights, names.scale, names.bias], &integer);
    }
    Ok(out.finish(provenance))
}

/// What a pack holds, in a word.
fn named(pack: &Pack) -> String {
    format!("{:?}", pack.kind()).to_lowercase()
}

/// How far the poses of two packs are apart: angle between the joints' rotations, all joints but the hips, degrees.
#[derive(Clone, Debug, Serialize)]
pub struct Difference {
    /// Frames compared.
    pub frames: usize,
    /// Mean over frames and joints.
    pub mean_deg: f64,
    /// 99 % of the joints in all frames are nearer.
    pub p99_deg: f64,
    /// The farthest joint in any frame.
    pub worst_deg: f64,
}

/// Steps the features over the clips and compares what the two networks predict of them, through the device's code: the
/// networks' raw output, before decoupling, which hides most of the difference.
pub fn difference(before: &Pack, after: &Pack, rig: &Rig, clips: &[Clip]) -> Result<Difference, LoadError> {
    let mut angles = Angles::new(rig.joints());
    let (first, second) = (HostMechanics::load(before)?, HostMechanics::load(after)?);
    let mut state = Box::new(MechanicsState::new());
    let mut parts = Decoupled::identity();
    let (mut a, mut b) = (Pose::identity(), Pose::identity());
    for clip in clips {
        *state = MechanicsState::new();
        for pose in &rig.poses(clip) {
            first.step(&mut state, pose, &mut parts);
            first.predict(state.features(), state.pose(), &mut a);
            second.predict(state.features(), state.pose(), &mut b);
            angles.add(&a, &b);
        }
    }
    Ok(angles.finish())
}

/// Translates the clips with both packs, each from the state that its first pose leads to, and compares the styled poses.
pub fn translated_difference(before: &Pack, after: &Pack, rig: &Rig, clips: &[Clip]) -> Result<Difference, LoadError> {
    let mut angles = Angles::new(rig.joints());
    let settings = translate::Settings::default();
    for clip in clips {
        let played = |pack| play(pack, rig, clip, &settings).map(|clip| rig.poses(&clip));
        let (first, second) = (played(before)?, played(after)?);
        first.iter().zip(&second).for_each(|(a, b)| angles.add(a, b));
    }
    Ok(angles.finish())
}

/// Angles between the joints of two poses, frame by frame.
struct Angles {
    joints: usize,
    frames: usize,
    degrees: Vec<f64>,
}

impl Angles {
    fn new(joints: usize) -> Self {
        Self { joints, frames: 0, degrees: Vec::new() }
    }

    fn add(&mut self, a: &Pose<MAX_JOINTS>, b: &Pose<MAX_JOINTS>) {
        self.frames += 1;
        // Of the rotation between them: exact for small angles, where an arc cosine is not.
        let between = |(a, b): (&UnitQuaternion<f32>, &UnitQuaternion<f32>)| {
            let between = a.cast::<f64>().inverse() * b.cast::<f64>();
            (2.0 * between.imag().norm().atan2(between.w.abs())).to_degrees()
        };
        self.degrees.extend(a.rotations.iter().zip(&b.rotations).take(self.joints).skip(1).map(between));
    }

    fn finish(mut self) -> Difference {
        self.degrees.sort_by(f64::total_cmp);
        let mean_deg = self.degrees.iter().sum::<f64>() / self.degrees.len().max(1) as f64;
        let p99_deg = self.degrees.get(self.degrees.len() * 99 / 100).copied().unwrap_or(0.0);
        let worst_deg = self.degrees.last().copied().unwrap_or(0.0);
        Difference { frames: self.frames, mean_deg, p99_deg, worst_deg }
    }
}
