//! Eight servos under a translator of order 40 and limits, with seeded numbers: cost depends on the shape alone.

use kinesic::rig::JointKind;
use kinesic_host::clip::{Joint, Skeleton};
use kinesic_host::limit::{JointLimit, LimitsModel};
use kinesic_host::rig::{JointCoordinates, Rig};
use kinesic_workloads::servos::{SERVOS, ServosFixed, ServosFloat};
use nalgebra::Vector3;

use super::styled::with_limits;
use super::{Prepared, WorkloadError, on_host, translator};
use crate::synthetic::FRAME_RATE;

/// Principal coordinates of the translator.
const DRIVES: usize = 6;

pub fn float(name: &str, frames: usize) -> Result<Prepared, WorkloadError> {
    let (pack, frames) = made(name, frames, false)?;
    on_host::<ServosFloat>(name, "servos.kin", pack, &frames)
}

/// The translator in fixed point.
pub fn fixed(name: &str, frames: usize) -> Result<Prepared, WorkloadError> {
    let (pack, frames) = made(name, frames, true)?;
    on_host::<ServosFixed>(name, "servos-i16.kin", pack, &frames)
}

fn made(name: &str, frames: usize, fixed: bool) -> Result<(Vec<u8>, Vec<Vec<f32>>), WorkloadError> {
    let joint = |index: usize| Joint {
        name: format!("servo{index}"),
        parent: index.checked_sub(1),
        offset: Vector3::new(0.0, 0.05, 0.0),
        end: None,
    };
    let skeleton = Skeleton { joints: (0..SERVOS).map(joint).collect() };
    let rig = Rig::machine(&skeleton, &[JointCoordinates::new(JointKind::Hinge); SERVOS])?;
    let mut limits = LimitsModel::free("servos", FRAME_RATE, &rig, 6.0, 60.0);
    limits.joints = vec![JointLimit::hinge([1.0, 0.0, 0.0], [-0.4, 0.4], 3.0, 30.0); SERVOS];
    let rig = limits.rig(&rig)?;
    let angle = |frame: usize, servo: usize| {
        let (time, servo) = (frame as f64 / FRAME_RATE, servo as f64);
        0.4 * libm::sin(time * (2.0 + 0.3 * servo)) + 0.1 * libm::sin(time * (5.0 - 0.4 * servo))
    };
    let rows: Vec<f64> = (0..frames)
        .flat_map(|frame| (0..3 * rig.rows()).map(move |at| if at < SERVOS { angle(frame, at) } else { 0.0 }))
        .collect();
    let numbers = rows.chunks_exact(3 * rig.rows()).map(|row| row[..SERVOS].iter().map(|x| *x as f32).collect());
    let numbers = numbers.collect();
    let translator = translator::shared_over(&rig, &rig.standing(rows), DRIVES);
    let translator = if fixed { translator::fixed(&translator)? } else { translator };
    Ok((with_limits(name, &rig, &translator, &limits)?, numbers))
}
