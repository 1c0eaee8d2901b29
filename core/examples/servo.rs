//! A robot arm of four servos: angles come in from a network that drops and garbles frames, pulse widths go out.
//!
//! `cargo run --release -p kinesic --example servo`; everything in `frame` runs on the device as it stands here. A servo angle is a
//! coordinate: nothing here knows of rotations. An engine before the limits is one more entry: `Pipeline<'_, (Translator<..>, Limiter<..>), ROWS>`.

use kinesic::limit::{LimitTable, Limiter};
use kinesic::model::{LimitsMeta, LoadError};
use kinesic::rig::JointKind;
use kinesic::{Pipeline, PipelineState, Rig};

const JOINTS: usize = 4;
const FRAME_RATE: f32 = 50.0;

/// Coordinates stand in rows of three: base, shoulder, elbow; wrist.
const ROWS: usize = 2;

/// What no servo uses.
const FREE: f32 = 0.0;

// Base, shoulder, elbow, wrist: hinges. On a product these tables come from a pack. Axes and references say how a pose would show the arm; angles
// alone do not ask for them.
static KINDS: [u16; JOINTS] = [JointKind::Hinge as u16; JOINTS];
static AXES: [[[f32; 3]; 3]; JOINTS] = [[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]; JOINTS];
static REFERENCE: [[f32; 4]; JOINTS] = [[0.0, 0.0, 0.0, 1.0]; JOINTS];
static MIDDLE: [[f32; 3]; JOINTS] = [[0.0; 3]; JOINTS];

static TABLE: LimitTable = LimitTable {
    lower: &[[-1.5, -0.8, 0.0], [-1.2, FREE, FREE]],
    upper: &[[1.5, 1.4, 2.2], [1.2, FREE, FREE]],
    velocity: &[[4.0, 4.0, 4.0], [4.0, FREE, FREE]],
    acceleration: &[[30.0, 30.0, 30.0], [30.0, FREE, FREE]],
    jerk: &[],
    rest: &[[0.0, 0.0, 0.4], [0.0, FREE, FREE]],
};

type Arm<'a> = Pipeline<'a, Limiter<'a, ROWS>, ROWS>;
type ArmState = PipelineState<kinesic::LimitState<ROWS>, ROWS>;

/// One frame: angles in rad, or none, in; pulse widths in microseconds out, 1500 at zero, 637 per radian.
fn frame(arm: &Arm, state: &mut ArmState, angles: Option<&[f32]>) -> [u16; JOINTS] {
    let mut limited = [0.0; JOINTS];
    arm.step_coordinates(state, angles, &mut limited);
    limited.map(|angle| (1500.0 + 637.0 * angle) as u16)
}

fn main() -> Result<(), LoadError> {
    let rig = Rig::new(&KINDS, &AXES, &REFERENCE, &MIDDLE, None)?;
    let arm = Arm::new(rig, Limiter::new(rig, TABLE, LimitsMeta::default(), FRAME_RATE)?)?;
    let mut state = ArmState::new();
    println!("frame  base shldr elbow wrist  fault");
    for at in 0..250 {
        let angles = wave(at);
        let [base, shoulder, _, wrist] = angles;
        let garbled = [base, shoulder, f32::NAN, wrist];
        let input: Option<&[f32]> = match at {
            80..90 => Some(&garbled),
            120..200 => None,
            _ => Some(&angles),
        };
        let [base, shoulder, elbow, wrist] = frame(&arm, &mut state, input);
        let report = state.report();
        if at % 10 == 0 {
            let fault = report.fault.map_or(String::new(), |fault| format!("{fault:?}, {} frames", report.gap));
            println!("{at:5}  {base:4}  {shoulder:4}  {elbow:4}  {wrist:4}  {fault}");
        }
    }
    let (report, limits) = (state.report(), state.engine.report());
    println!("{} frames, {} kept out, {} clamped", report.frames, report.faulty, limits.clamped_frames);
    println!("a recovery takes at most {} frames", arm.engine.recovery_frames());
    Ok(())
}

/// Waves, farther than the servos go.
fn wave(at: i32) -> [f32; JOINTS] {
    let time = at as f32 / FRAME_RATE;
    let (slow, fast) = (libm::sinf(2.0 * time), libm::sinf(5.0 * time));
    [1.8 * slow, 0.6 * slow, 0.9 + 0.5 * fast, 0.4 * fast]
}
