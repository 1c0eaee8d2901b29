//! Style components of 23 joints with seeded directions, over a made walk. Cost depends on the shape alone, so nothing has
//! to be trained to measure it, and a better trainer does not move the budgets.

use faer::Mat;
use kinesic_host::clip::Clip;
use kinesic_host::components::{ComponentsModel, Factors, Motion};
use kinesic_host::pack::Provenance;
use kinesic_host::rig::Rig;
use kinesic_workloads::posed::{COUNT, Restyle, SHORT_JOINTS as JOINTS};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

use super::translator::numbers;
use super::{Prepared, WorkloadError, on_host};
use crate::synthetic::{self, FRAME_RATE};

const SEED: u64 = 3;
/// Share of the joints that a component moves: the density that training chooses is about this.
const DENSITY: f64 = 0.4;
/// Frames of the stored content: the live pose does not play them.
const STORED: usize = 60;

pub fn prepare(name: &str, frames: usize) -> Result<Prepared, WorkloadError> {
    let rig = synthetic::short_rig();
    let walk = synthetic::walk_on(&rig.skeleton, frames, SEED);
    on_host::<Restyle>(name, "components.kin", pack(&rig, &walk), &numbers(&rig, &walk, JOINTS))
}

/// The pack for a walk on a rig.
pub fn pack(rig: &Rig, walk: &Clip) -> Vec<u8> {
    let rows = rig.rows();
    let poses = rig.poses(walk);
    let Motion { mean, scale, .. } = Motion::new(rig, &rig.locals(&poses));
    let mut random = ChaCha8Rng::seed_from_u64(SEED);
    let mut matrix = |rows: usize, columns: usize, size: f64| -> Mat<f64> {
        Mat::from_fn(rows, columns, |_, _| random.random_range(-size..size))
    };
    let mut components = matrix(3 * rows, COUNT, 0.5);
    let change = matrix(3 * rows, COUNT, 0.1);
    let weights = matrix(STORED, COUNT, 1.0);
    for k in 0..COUNT {
        for row in (0..rows).filter(|_| random.random_bool(1.0 - DENSITY)).collect::<Vec<_>>() {
            (0..3).for_each(|axis| components[(3 * row + axis, k)] = 0.0);
        }
    }
    let model = ComponentsModel {
        style: "made".to_owned(),
        frame_rate: FRAME_RATE,
        shift: (0..mean.len()).map(|_| random.random_range(-0.01..0.01)).collect(),
        mean,
        scale,
        learned: &components + &change,
        content: Factors { weights, components },
        track: vec![[0.0, 0.02, 0.0, 1.0]; STORED],
        strength: [0.0, 1.0],
    };
    let provenance = Provenance { tool: "kinesic-firmware-sim".to_owned(), seed: SEED, ..Provenance::default() };
    model.pack(rig, &provenance)
}
