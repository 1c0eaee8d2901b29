//! Style components, trained by the host crate on two made walks of 23 joints, over a third one.

use kinesic_host::components::{Optimiser, TrainOptions, train};
use kinesic_host::pack::Provenance;
use kinesic_workloads::components::{COUNT, JOINTS, Restyle};

use super::translator::numbers;
use super::{Prepared, WorkloadError, on_host};
use crate::made;

const SEED: u64 = 3;
/// Frames of each walk that is trained on, 60 a second.
const TRAINED: usize = 150;
/// Steps of style learning: cost depends on the shape, so no more than give every component a change.
const STEPS: usize = 50;

pub fn prepare(name: &str, frames: usize) -> Result<Prepared, WorkloadError> {
    let rig = made::short_rig();
    let walk = |frames, seed| made::walk_on(&rig.skeleton, frames, seed);
    let options = TrainOptions {
        count: Some(COUNT),
        optimiser: Optimiser { max_steps: STEPS, ..Optimiser::default() },
        ..TrainOptions::default()
    };
    let trained = train(&rig, &walk(TRAINED, SEED), &walk(TRAINED, SEED + 1), "made", &options)?;
    let provenance = Provenance { tool: "kinesic-firmware-sim".to_owned(), seed: SEED, ..Provenance::default() };
    let pack = trained.model.pack(&rig, &provenance);
    on_host::<Restyle>(name, "components.kin", pack, &numbers(&rig, &walk(frames, SEED + 2), JOINTS))
}
