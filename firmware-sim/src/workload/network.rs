//! The network of Boehs 2017 at full size, 23-100-300-120, with seeded weights on the body of `models/mechanics.kin`; and the same
//! shape for a peer.

use kinesic::Pack;
use kinesic::mechanics::FEATURES;
use kinesic::model::{Floats, Integers, LoadError, ModelMeta, Numbers};
use kinesic_host::pack::{PackFile, PackWriter, Provenance};
use kinesic_host::quantise::to_int8;
use kinesic_host::rig::Rig;
use kinesic_workloads::mechanics::{JOINTS, Network};
use kinesic_workloads::peer::{EmbeddedNn, SHAPE};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

use super::mechanics::model;
use super::translator::numbers;
use super::{Prepared, WorkloadError, on_host};
use crate::synthetic::{self, FRAME_RATE};

const SEED: u64 = 3;
const LAYERS: [&str; 3] = ["mechanics/hidden", "mechanics/code", "mechanics/decoder"];

fn provenance() -> Provenance {
    Provenance { tool: "kinesic-firmware-sim".to_owned(), seed: SEED, ..Provenance::default() }
}

/// Weights of the three layers, row-major, that keep the units' tanh at work.
fn weights() -> [Vec<f32>; 3] {
    let mut random = ChaCha8Rng::seed_from_u64(SEED);
    [0, 1, 2].map(|layer| {
        let size = (3.0 / SHAPE[layer] as f32).sqrt();
        (0..SHAPE[layer] * SHAPE[layer + 1]).map(|_| random.random_range(-size..size)).collect()
    })
}

/// The shipped pack with other layers.
fn pack() -> Result<PackFile, WorkloadError> {
    assert_eq!(SHAPE[0], FEATURES, "the peer has the network's shape");
    let file = PackFile::from_bytes(&model()?);
    let pack = file.pack().map_err(kinesic_host::quantise::QuantiseError::from)?;
    let metadata = pack.metadata();
    let mut out = PackWriter::new(pack.kind(), "network", metadata.frame_rate);
    metadata.joints.iter().for_each(|joint| out.joint(joint.name, joint.parent));
    for meta in metadata.models.iter().filter_map(ModelMeta::mechanics) {
        let (hidden, code) = (SHAPE[1] as u32, SHAPE[2] as u32);
        out.model(&ModelMeta::Mechanics(kinesic::model::MechanicsMeta { hidden, code, ..meta }));
    }
    for tensor in metadata.tensors.iter().filter(|tensor| !LAYERS.iter().any(|layer| tensor.name.starts_with(layer))) {
        let bytes = pack.bytes(&tensor).ok_or(kinesic_host::quantise::QuantiseError::Load(LoadError::Metadata))?;
        out.copy(&tensor, bytes);
    }
    for (layer, (name, weights)) in LAYERS.iter().zip(weights()).enumerate() {
        out.tiled(name, SHAPE[layer], &weights);
        out.f32s(&format!("{name}_bias"), 1, &vec![0.01; SHAPE[layer + 1]]);
    }
    Ok(PackFile::from_bytes(&out.finish(&provenance())))
}

fn over_a_walk<N: Numbers>(
    name: &str,
    pack_name: &'static str,
    pack: &PackFile,
    frames: usize,
) -> Result<Prepared, WorkloadError> {
    let refused = |_| WorkloadError::Refused { name: name.to_owned() };
    let view: Pack = pack.pack().map_err(refused)?;
    let rig = Rig::from_pack(&view)?;
    let clip = synthetic::walk_on(&rig.skeleton, frames, SEED);
    on_host::<Network<N>>(name, pack_name, pack.bytes().to_vec(), &numbers(&rig, &clip, JOINTS))
}

pub fn f32(name: &str, frames: usize) -> Result<Prepared, WorkloadError> {
    over_a_walk::<Floats>(name, "network.kin", &pack()?, frames)
}

pub fn i8(name: &str, frames: usize) -> Result<Prepared, WorkloadError> {
    let rounded = PackFile::from_bytes(&to_int8(&pack()?, &provenance())?);
    over_a_walk::<Integers>(name, "network-i8.kin", &rounded, frames)
}

/// The same weights for embedded-nn, row-major, one scale a layer.
pub fn embedded_nn(name: &str, frames: usize) -> Result<Prepared, WorkloadError> {
    let mut out = PackWriter::new(kinesic::model::Kind::Style, "peer", FRAME_RATE as f32);
    for (tensor, weights) in ["peer/hidden", "peer/code", "peer/decoder"].iter().zip(weights()) {
        let largest = weights.iter().fold(0.0f32, |most, weight| most.max(weight.abs()));
        let rounded: Vec<i8> = weights.iter().map(|weight| (weight / largest * 127.0).round() as i8).collect();
        out.i8s(tensor, 1, &rounded);
    }
    let mut random = ChaCha8Rng::seed_from_u64(SEED);
    let input: Vec<Vec<f32>> =
        (0..frames).map(|_| (0..FEATURES).map(|_| random.random_range(-1.0..1.0f32)).collect()).collect();
    on_host::<EmbeddedNn>(name, "peer-embedded-nn.kin", out.finish(&provenance()), &input)
}
