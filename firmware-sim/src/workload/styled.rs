//! A whole-body translator of order 40 and limits on the made gait of 19 joints, with seeded numbers: cost depends on the shape alone.

use kinesic::Pack;
use kinesic_host::clip::JointMap;
use kinesic_host::gait::{Manner, walk};
use kinesic_host::limit::LimitsModel;
use kinesic_host::pack::Provenance;
use kinesic_host::rig::Rig;
use kinesic_workloads::by_hand::ByHand;
use kinesic_workloads::held::StyledFeet;
use kinesic_workloads::posed::{GAIT_JOINTS, Styled, StyledFixed};

use super::translator::{self, numbers};
use super::{Prepared, WorkloadError, aligned, limit, on_host};
use crate::synthetic::FRAME_RATE;

const SEED: u64 = 3;

pub(super) fn float(name: &str, frames: usize) -> Result<Prepared, WorkloadError> {
    let (pack, frames) = made(name, frames, false)?;
    on_host::<Styled>(name, "styled.kin", pack, &frames)
}

/// The same engines without `Pipeline`. It has no budget: a test compares it with `styled`.
pub fn by_hand(frames: usize) -> Result<Prepared, WorkloadError> {
    let name = "by-hand";
    let (pack, frames) = made(name, frames, false)?;
    on_host::<ByHand>(name, "styled.kin", pack, &frames)
}

/// Then feet are held.
pub(super) fn feet(name: &str, frames: usize) -> Result<Prepared, WorkloadError> {
    let (pack, frames) = made(name, frames, false)?;
    on_host::<StyledFeet>(name, "styled.kin", pack, &frames)
}

/// The translator in fixed point.
pub(super) fn fixed(name: &str, frames: usize) -> Result<Prepared, WorkloadError> {
    let (pack, frames) = made(name, frames, true)?;
    on_host::<StyledFixed>(name, "styled-i16.kin", pack, &frames)
}

fn made(name: &str, frames: usize, fixed: bool) -> Result<(Vec<u8>, Vec<Vec<f32>>), WorkloadError> {
    let clip = walk(&Manner::NEUTRAL, frames as f64 / FRAME_RATE, FRAME_RATE, 0.0, SEED);
    let map = JointMap::detect(&clip.skeleton).expect("the made gait has known names");
    let rig = Rig::new(&clip.skeleton, &map)?;
    let limits = limit::limits(&rig);
    let rig = limits.rig(&rig)?;
    let translator = translator::shared(&rig, &clip);
    let translator = if fixed { translator::fixed(&translator)? } else { translator };
    let pack = with_limits(name, &rig, &translator, &limits)?;
    Ok((pack, numbers(&rig, &clip, GAIT_JOINTS)))
}

/// One pack of a translator and limits, on the rig of the limits.
pub(super) fn with_limits(
    name: &str,
    rig: &Rig,
    translator: &[u8],
    limits: &LimitsModel,
) -> Result<Vec<u8>, WorkloadError> {
    let refused = |_| WorkloadError::Refused { name: name.to_owned() };
    let words = aligned(translator);
    let part = Pack::load(&bytemuck::cast_slice(&words)[..translator.len()]).map_err(refused)?;
    let provenance = Provenance { tool: "kinesic-firmware-sim".to_owned(), seed: SEED, ..Provenance::default() };
    Ok(limits.pack_with(&part, rig, &provenance)?)
}
