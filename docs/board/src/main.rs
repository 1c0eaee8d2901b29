//! Plays a pack on a microcontroller. Copy this folder, put in your pack, your poses and your servos.
#![no_std]
#![no_main]

mod motion;

use kinesic::{Pack, Pipeline, PipelineState, Pose, Translator, TranslatorState};
use semihosting::{println, process};

// Capacities: `kinesic inspect weary.kin` prints the least that they must be.
const ROWS: usize = 20;
const STATES: usize = 60;

/// The engine between pose and pose. With joint limits in the pack: `(Translator<..>, Limiter<'static, ROWS>)`.
type Style = Pipeline<'static, Translator<'static, ROWS, STATES>, ROWS>;

/// What it remembers; with limits `(TranslatorState<..>, LimitState<ROWS>)`.
type State = PipelineState<TranslatorState<ROWS, STATES>, ROWS>;

/// In flash, aligned, used in place.
static PACK: &[u8] = kinesic::include_pack!("../../../models/weary.kin");

#[cfg_attr(target_arch = "arm", cortex_m_rt::entry)]
#[cfg_attr(target_arch = "riscv32", riscv_rt::entry)]
fn main() -> ! {
    // All that can fail, fails here.
    let style = match Pack::load(PACK).and_then(|pack| Style::load(&pack)) {
        Ok(style) => style,
        Err(error) => {
            println!("the pack is refused: {error}");
            process::exit(1)
        }
    };
    let mut state = State::new();
    state.engine.controls.strength = 0.8;
    let mut styled = Pose::identity();
    // On a board: `loop`, and wait for a timer that fires 60 times a second.
    for frame in 0..motion::FRAMES {
        // A frame that is missing or garbled never reaches the filters: what was shown last is held.
        let source = motion::read_pose(frame);
        style.step(&mut state, source.as_ref(), &mut styled);
        if frame % 25 == 24 {
            // On a board: angles to the servos.
            println!("frame {frame}: the left arm is turned by {} milliradians", motion::arm(&styled));
        }
    }
    println!("{} of {} frames were held", state.report().faulty, state.report().frames);
    process::exit(0)
}
