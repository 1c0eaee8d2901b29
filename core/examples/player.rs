//! A head of two servos that idles, nods when it is spoken to, and looks at what moves: layers, then limits of jerk too.
//!
//! `cargo run --release -p kinesic --example player`; everything in `frame` runs on the device as it stands here. A mood is one more engine before the
//! limits: `(Translator<..>, SmoothLimiter<..>)`.

use core::array::from_fn;

use kinesic::limit::LimitTable;
use kinesic::model::{LimitsMeta, LoadError};
use kinesic::play::{Mode, Move};
use kinesic::rig::JointKind;
use kinesic::{Pipeline, PipelineState, Player, Rig, SmoothLimitState, SmoothLimiter};

/// Pan and tilt.
const SERVOS: usize = 2;
const FRAME_RATE: f32 = 50.0;
const SECOND: u16 = 50;

/// Coordinates stand in rows of three.
const ROWS: usize = 1;

/// The layers, from the bottom.
const IDLE: usize = 0;
const GESTURE: usize = 1;
const GAZE: usize = 2;

// On a product these tables come from the robot's pack (`kinesic robot import`).
static KINDS: [u16; SERVOS] = [JointKind::Hinge as u16; SERVOS];
static AXES: [[[f32; 3]; 3]; SERVOS] = [[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]; SERVOS];
static REFERENCE: [[f32; 4]; SERVOS] = [[0.0, 0.0, 0.0, 1.0]; SERVOS];
static MIDDLE: [[f32; 3]; SERVOS] = [[0.0; 3]; SERVOS];
static TABLE: LimitTable = LimitTable {
    lower: &[[-1.5, -0.6, 0.0]],
    upper: &[[1.5, 0.6, 0.0]],
    velocity: &[[6.0, 6.0, 0.0]],
    acceleration: &[[60.0, 60.0, 0.0]],
    jerk: &[[1500.0, 1500.0, 0.0]],
    rest: &[[0.0; 3]],
};

type Head<'a> = Pipeline<'a, SmoothLimiter<'a, ROWS>, ROWS>;
type HeadState = PipelineState<SmoothLimitState<ROWS>, ROWS>;

/// One frame: what the servos are told, rad.
fn frame(player: &mut Player<SERVOS, 3>, head: &Head, state: &mut HeadState) -> [f32; SERVOS] {
    let mut out = [0.0; SERVOS];
    head.step_coordinates(state, Some(player.step()), &mut out);
    out
}

fn main() -> Result<(), LoadError> {
    // On a product: arrays in flash, by `kinesic export --rust idle.csv --robot head.kin --out idle.rs`.
    let idle: [[f32; SERVOS]; 100] = from_fn(|at| {
        let time = at as f32 / 100.0 * core::f32::consts::TAU;
        [0.1 * libm::sinf(time), 0.05 * libm::sinf(2.0 * time)]
    });
    let nod: [[f32; SERVOS]; 60] = from_fn(|at| [0.0, 0.3 * libm::sinf(at as f32 * 0.2094)]);
    let (Some(idle), Some(nod)) = (Move::new(&idle), Move::new(&nod)) else { return Ok(()) };

    let rig = Rig::new(&KINDS, &AXES, &REFERENCE, &MIDDLE, None)?;
    let head = Head::new(rig, SmoothLimiter::new(rig, TABLE, LimitsMeta::default(), FRAME_RATE)?)?;
    let mut state = HeadState::new();
    let mut player = Player::new([0.0; SERVOS]);

    // Where the servos stand when they are switched on.
    let here = [0.8, -0.3];
    head.start_coordinates(&mut state, &here);
    player.start(here, SECOND);
    player.layers[IDLE].play(idle.looped(), SECOND);
    player.layers[GESTURE].mask([0.0, 1.0], 0);
    player.layers[GAZE].mode = Mode::Add;
    player.layers[GAZE].mask([1.0, 0.5], 0);

    println!("frame    pan   tilt");
    for at in 0..600 {
        match at {
            150 => player.layers[GESTURE].gesture(nod, SECOND / 5),
            // In the middle of the nod: half of it.
            170 => player.layers[GESTURE].strength(0.5, SECOND / 2),
            200..400 => player.layers[GAZE].follow(&[if at < 300 { 0.9 } else { -0.4 }, 0.2], SECOND / 2),
            400 => player.layers[GAZE].leave(SECOND),
            500 => player.rest(SECOND),
            _ => {}
        }
        let [pan, tilt] = frame(&mut player, &head, &mut state);
        if at % 20 == 0 {
            println!("{at:5} {pan:6.3} {tilt:6.3}");
        }
    }
    println!("clamped in {} of 600 frames", state.engine.report().clamped_frames);
    println!("RAM: {} bytes of layers, {} of limits", size_of_val(&player), size_of_val(&state));
    Ok(())
}
