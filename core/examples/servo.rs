//! A robot arm of four servos: poses come in from a network that drops and garbles frames, pulse widths go out.
//!
//! `cargo run --release -p kinesic --example servo`; everything in `frame` runs on the device as it stands here.

use kinesic::limit::{LimitTable, Limiter};
use kinesic::model::{LimitsMeta, LoadError};
use kinesic::{Pipeline, PipelineState, Pose};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};

const JOINTS: usize = 4;
const FRAME_RATE: f32 = 50.0;

const X: [f32; 3] = [1.0, 0.0, 0.0];
const Y: [f32; 3] = [0.0, 1.0, 0.0];
const NONE: [f32; 3] = [0.0; 3];

/// Base (about the vertical), shoulder, elbow, wrist: hinges. On a product these tables come from a pack.
static TABLE: LimitTable = LimitTable {
    kinds: &[1; JOINTS],
    axes: &[[Y, NONE, NONE], [X, NONE, NONE], [X, NONE, NONE], [X, NONE, NONE]],
    neutral: &[[0.0, 0.0, 0.0, 1.0]; JOINTS],
    lower: &[[-1.5, 0.0, 0.0], [-0.8, 0.0, 0.0], [0.0, 0.0, 0.0], [-1.2, 0.0, 0.0]],
    upper: &[[1.5, 0.0, 0.0], [1.4, 0.0, 0.0], [2.2, 0.0, 0.0], [1.2, 0.0, 0.0]],
    velocity: &[[4.0; 3]; JOINTS],
    acceleration: &[[30.0; 3]; JOINTS],
    rest: &[NONE, NONE, [0.4, 0.0, 0.0], NONE],
};

/// No engine, so their capacities are 0; a style is added with `with_translator` and a `STATES`.
type Arm<'a> = Pipeline<'a, JOINTS, 0, 0, 0, 0, 0>;
type ArmState = PipelineState<JOINTS, 0, 0, 0>;

/// One frame: a pose, or none, in; pulse widths in microseconds out, 1500 at zero, 637 a radian.
fn frame(arm: &Arm, state: &mut ArmState, input: Option<&Pose<JOINTS>>) -> [u16; JOINTS] {
    let mut pose = Pose::identity();
    arm.step(state, input, &mut pose);
    core::array::from_fn(|joint| {
        let [angle, ..] = state.limit().angles(joint);
        (1500.0 + 637.0 * angle) as u16
    })
}

fn main() -> Result<(), LoadError> {
    let arm = Arm::new(Limiter::new(TABLE, LimitsMeta::default(), FRAME_RATE)?);
    let mut state = ArmState::new();
    println!("frame  base shldr elbow wrist  fault");
    for at in 0..250 {
        let input = wave(at);
        let mut garbled = input;
        garbled.rotations[2] = UnitQuaternion::new_unchecked(Quaternion::new(f32::NAN, 0.0, 0.0, 0.0));
        let input = match at {
            80..90 => Some(&garbled),
            120..200 => None,
            _ => Some(&input),
        };
        let [base, shoulder, elbow, wrist] = frame(&arm, &mut state, input);
        let report = state.report();
        if at % 10 == 0 {
            let fault = report.fault.map_or(String::new(), |fault| format!("{fault:?}, {} frames", report.gap));
            println!("{at:5}  {base:4}  {shoulder:4}  {elbow:4}  {wrist:4}  {fault}");
        }
    }
    let report = state.report();
    println!("{} frames, {} quarantined, {} clamped", report.frames, report.faulty_frames, report.clamped_frames);
    println!("a recovery takes at most {} frames", arm.limiter().recovery_frames());
    Ok(())
}

/// Waves, further than the servos go.
fn wave(at: i32) -> Pose<JOINTS> {
    let time = at as f32 / FRAME_RATE;
    let turn = |axis: [f32; 3], angle: f32| UnitQuaternion::from_scaled_axis(Vector3::from(axis) * angle);
    let (slow, fast) = (libm::sinf(2.0 * time), libm::sinf(5.0 * time));
    Pose {
        root: Vector3::zeros(),
        rotations: [turn(Y, 1.8 * slow), turn(X, 0.6 * slow), turn(X, 0.9 + 0.5 * fast), turn(X, 0.4 * fast)],
    }
}
