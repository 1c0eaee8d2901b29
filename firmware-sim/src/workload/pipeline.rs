//! Everything at once on the skeleton of `models/mechanics.kin`: its body mechanics, and a translator, components and limits with seeded
//! numbers, over a made walk. One style pack, as `kinesic limits --with` makes it.

use kinesic::Pack;
use kinesic::model::Kind;
use kinesic_host::pack::{PackWriter, Provenance};
use kinesic_host::rig::Rig;
use kinesic_workloads::pipeline::{JOINTS, Whole};

use super::translator::numbers;
use super::{Prepared, WorkloadError, aligned, components, limit, mechanics, on_host, translator};
use crate::made::{self, FRAME_RATE};

const SEED: u64 = 3;

pub fn prepare(name: &str, frames: usize) -> Result<Prepared, WorkloadError> {
    let refused = |_| WorkloadError::Refused { name: name.to_owned() };
    let model = mechanics::model()?;
    let words = aligned(&model);
    let rig = Rig::from_pack(&Pack::load(&bytemuck::cast_slice(&words)[..model.len()]).map_err(refused)?)?;
    let walk = made::walk_on(&rig.skeleton, frames, SEED);
    let mut pack = PackWriter::new(Kind::Style, "made", FRAME_RATE as f32);
    rig.write(&mut pack);
    for part in [translator::shared(&rig, &walk), model, components::pack(&rig, &walk)] {
        let words = aligned(&part);
        let part = Pack::load(&bytemuck::cast_slice(&words)[..part.len()]).map_err(refused)?;
        pack.copy_models(&part).map_err(refused)?;
    }
    limit::limits(&rig).write(&mut pack);
    let provenance = Provenance { tool: "kinesic-firmware-sim".to_owned(), seed: SEED, ..Provenance::default() };
    on_host::<Whole>(name, "pipeline.kin", pack.finish(&provenance), &numbers(&rig, &walk, JOINTS))
}
