//! Plays a pack on a microcontroller. Copy this folder, put in your pack, your poses and your servos.
#![no_std]
#![no_main]

mod motion;

use kinesic::{Pack, Pose, Translator, TranslatorState};
use semihosting::{println, process};

/// `kinesic inspect weary.kin` prints the two capacities.
type Style = Translator<'static, 19, 60>;

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
    let mut state = TranslatorState::new();
    state.controls.strength = 0.8;
    let mut styled = Pose::identity();
    // On a board: `loop`, and wait for a timer that fires 60 times a second.
    for frame in 0..motion::FRAMES {
        let source = motion::read_pose(frame);
        style.step(&mut state, &source, &mut styled);
        if frame % 30 == 29 {
            // On a board: angles to the servos.
            println!("frame {frame}: neck bends by {} milliradians", motion::neck(&styled));
        }
    }
    process::exit(0)
}
