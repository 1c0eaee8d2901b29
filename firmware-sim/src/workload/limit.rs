//! Joint limits on a made walk: elbows and knees are hinges, shoulders and hips chains of three servos, other joints balls. The
//! limits are tight enough that a walk runs into them.

use kinesic_host::limit::{JointLimit, LimitsModel};
use kinesic_host::pack::Provenance;
use kinesic_host::rig::Rig;
use kinesic_workloads::posed::{Limit, SHORT_JOINTS};

use super::translator::numbers;
use super::{Prepared, WorkloadError, on_host};
use crate::synthetic::{self, FRAME_RATE};

const SEED: u64 = 3;
const X: [f32; 3] = [1.0, 0.0, 0.0];
const Y: [f32; 3] = [0.0, 1.0, 0.0];
const Z: [f32; 3] = [0.0, 0.0, 1.0];

pub fn prepare(name: &str, frames: usize) -> Result<Prepared, WorkloadError> {
    let rig = synthetic::short_rig();
    let provenance = Provenance { tool: "kinesic-firmware-sim".to_owned(), seed: SEED, ..Provenance::default() };
    let walk = synthetic::walk_on(&rig.skeleton, frames, SEED);
    on_host::<Limit>(name, "limit.kin", limits(&rig).pack(&rig, &provenance)?, &numbers(&rig, &walk, SHORT_JOINTS))
}

/// The limits of a rig whose joints have the made body's names.
pub fn limits(rig: &Rig) -> LimitsModel {
    let mut model = LimitsModel::free("made", FRAME_RATE, rig, 6.0, 60.0);
    for (limit, joint) in model.joints.iter_mut().zip(&rig.skeleton.joints).skip(1) {
        let is = |ends: &[&str]| ends.iter().any(|end| joint.name.ends_with(end));
        *limit = if is(&["ForeArm", "tLeg"]) && !is(&["UpLeg"]) {
            JointLimit::hinge(X, [-0.3, 0.4], 3.0, 30.0)
        } else if is(&["tArm", "UpLeg"]) {
            JointLimit::chain([X, Y, Z], [-0.3; 3], [0.3; 3], 3.0, 30.0)
        } else {
            JointLimit::ball([-0.2; 3], [0.2; 3], 3.0, 30.0)
        };
    }
    model
}
