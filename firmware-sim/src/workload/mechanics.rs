//! The repository's own body mechanics, `models/mechanics.kin`, over a made walk of its skeleton.

use std::path::Path;

use kinesic::Pack;
use kinesic::model::{Floats, Integers, Numbers};
use kinesic_host::pack::{PackFile, Provenance};
use kinesic_host::quantise::to_int8;
use kinesic_host::rig::Rig;
use kinesic_workloads::mechanics::{JOINTS, Mechanics};

use super::translator::numbers;
use super::{Prepared, WorkloadError, aligned, on_host};
use crate::data::home;
use crate::synthetic;

const SEED: u64 = 3;
const MODEL: &str = "models/mechanics.kin";

pub fn prepare(name: &str, frames: usize) -> Result<Prepared, WorkloadError> {
    over_a_walk::<Floats>(name, "mechanics.kin", model()?, frames)
}

/// The same model with int8 weights.
pub fn int8(name: &str, frames: usize) -> Result<Prepared, WorkloadError> {
    let provenance = Provenance { tool: "kinesic-firmware-sim".to_owned(), seed: SEED, ..Provenance::default() };
    let pack = to_int8(&PackFile::from_bytes(&model()?), &provenance)?;
    over_a_walk::<Integers>(name, "mechanics-i8.kin", pack, frames)
}

fn over_a_walk<N: Numbers>(
    name: &str,
    pack_name: &'static str,
    pack: Vec<u8>,
    frames: usize,
) -> Result<Prepared, WorkloadError> {
    let refused = |_| WorkloadError::Refused { name: name.to_owned() };
    let words = aligned(&pack);
    let rig = Rig::from_pack(&Pack::load(&bytemuck::cast_slice(&words)[..pack.len()]).map_err(refused)?)?;
    let clip = synthetic::walk_on(&rig.skeleton, frames, SEED);
    on_host::<Mechanics<N>>(name, pack_name, pack, &numbers(&rig, &clip, JOINTS))
}

pub fn model() -> Result<Vec<u8>, WorkloadError> {
    let path = home().parent().unwrap_or(Path::new(".")).join(MODEL);
    std::fs::read(&path).map_err(|source| WorkloadError::Read { path, source })
}

#[cfg(test)]
mod tests {
    use super::*;
    use kinesic::mechanics::{Decoupled, MechanicsState};
    use kinesic_host::mechanics::HostMechanics;

    #[test]
    fn both_feet_stand_and_fly() {
        let pack = model().unwrap();
        let words = aligned(&pack);
        let pack = Pack::load(&bytemuck::cast_slice(&words)[..pack.len()]).unwrap();
        let rig = Rig::from_pack(&pack).unwrap();
        let model = HostMechanics::load(&pack).unwrap();
        let (mut state, mut parts) = (MechanicsState::new(), Decoupled::identity());
        let mut seen = [[false; 2]; 2];
        for pose in rig.poses(&synthetic::walk_on(&rig.skeleton, 1000, SEED)) {
            model.step(&mut state, &pose, &mut parts);
            for (seen, stands) in seen.iter_mut().zip(state.contacts().stands) {
                seen[usize::from(stands)] = true;
            }
        }
        assert_eq!(seen, [[true; 2]; 2]);
    }
}
