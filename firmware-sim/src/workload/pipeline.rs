//! Everything at once on the skeleton of `models/mechanics.kin`: its body mechanics, and a translator, components, an emotion and
//! limits with seeded numbers, over a made walk. One style pack, as `kinesic limits --with` makes it.

use kinesic::Pack;
use kinesic::model::Kind;
use kinesic_host::clip::Clip;
use kinesic_host::emotion::synthetic::{Moment, over};
use kinesic_host::pack::{PackFile, PackWriter, Provenance};
use kinesic_host::quantise::{to_int8, to_int16};
use kinesic_host::rig::Rig;
use kinesic_workloads::mechanics::JOINTS;
use kinesic_workloads::posed::{COUNT, KEYS, Whole};

use super::translator::numbers;
use super::{Prepared, WorkloadError, aligned, components, limit, mechanics, on_host, translator};
use crate::synthetic::{self, FRAME_RATE};

const SEED: u64 = 3;
/// Hidden units of the emotion, the paper's.
const UNITS: usize = 10;
/// Frames between two of its keyframes.
const STRIDE: usize = 5;

/// All engines in f32.
pub fn float(name: &str, frames: usize) -> Result<Prepared, WorkloadError> {
    prepare(name, "pipeline.kin", frames, &|_, pack| Ok(pack))
}

/// The network in int8 and the translator in int16, as `kinesic quantize` makes them.
pub fn integer(name: &str, frames: usize) -> Result<Prepared, WorkloadError> {
    prepare(name, "pipeline-int.kin", frames, &|part, pack| {
        let file = PackFile::from_bytes(&pack);
        Ok(match part {
            Part::Translator => to_int16(&file, &provenance())?,
            Part::Mechanics => to_int8(&file, &provenance())?,
            Part::Other => pack,
        })
    })
}

fn provenance() -> Provenance {
    Provenance { tool: "kinesic-firmware-sim".to_owned(), seed: SEED, ..Provenance::default() }
}

#[derive(Clone, Copy)]
enum Part {
    Translator,
    Mechanics,
    Other,
}

/// A cycle of the walk, and one of the seconds after it for full strength.
fn emotion(rig: &Rig, walk: &Clip) -> Vec<u8> {
    let poses = rig.poses(walk);
    let cycle = |from: usize| -> Vec<Moment> {
        (0..KEYS).map(|key| ((key * STRIDE) as f64 / FRAME_RATE, poses[(from + key * STRIDE) % poses.len()])).collect()
    };
    over(rig, &[cycle(0), cycle(KEYS * STRIDE)], [COUNT, UNITS]).pack(rig, &provenance())
}

type Rounding<'a> = &'a dyn Fn(Part, Vec<u8>) -> Result<Vec<u8>, WorkloadError>;

fn prepare(
    name: &str,
    pack_name: &'static str,
    frames: usize,
    rounded: Rounding<'_>,
) -> Result<Prepared, WorkloadError> {
    let refused = |_| WorkloadError::Refused { name: name.to_owned() };
    let model = mechanics::model()?;
    let words = aligned(&model);
    let rig = Rig::from_pack(&Pack::load(&bytemuck::cast_slice(&words)[..model.len()]).map_err(refused)?)?;
    let limits = limit::limits(&rig);
    let rig = limits.rig(&rig)?;
    let walk = synthetic::walk_on(&rig.skeleton, frames, SEED);
    let mut pack = PackWriter::new(Kind::Style, "made", FRAME_RATE as f32);
    rig.write(&mut pack);
    let parts = [
        (Part::Translator, translator::shared(&rig, &walk)),
        (Part::Mechanics, model),
        (Part::Other, components::pack(&rig, &walk)),
        (Part::Other, emotion(&rig, &walk)),
    ];
    for (kind, part) in parts {
        let part = rounded(kind, part)?;
        let words = aligned(&part);
        let part = Pack::load(&bytemuck::cast_slice(&words)[..part.len()]).map_err(refused)?;
        pack.copy_models(&part).map_err(refused)?;
    }
    let pack = pack.finish(&provenance());
    let words = aligned(&pack);
    let pack = Pack::load(&bytemuck::cast_slice(&words)[..pack.len()]).map_err(refused)?;
    let pack = limits.pack_with(&pack, &rig, &provenance())?;
    on_host::<Whole>(name, pack_name, pack, &numbers(&rig, &walk, JOINTS))
}
