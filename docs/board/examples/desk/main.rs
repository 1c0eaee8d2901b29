//! A desk robot of four hobby servos: a timer steps the style 50 times a second, and pulse widths go to the servos.
//! Copy this folder; put in your pack, your move and your board.
#![no_std]
#![no_main]

// Of the two parts one has an FPU.
#[cfg_attr(target_abi = "eabihf", path = "board_stm32f405.rs")]
#[cfg_attr(not(target_abi = "eabihf"), path = "board_rp2040.rs")]
mod board;
// `kinesic export --rust calm.csv --robot lively.kin` makes it.
mod calm;
mod registers;
mod robot;

use core::fmt::Write;
use core::sync::atomic::{AtomicU32, Ordering};

use board::Serial;
use robot::Robot;

/// In flash, aligned, used in place.
static PACK: &[u8] = kinesic::include_pack!("lively.kin");

// The timer's rate is the move's and the pack's.
const _: () = assert!(calm::FRAME_RATE == robot::RATE as f32);

/// Frames that the timer has stepped. Only its interrupt writes it.
static FRAMES: AtomicU32 = AtomicU32::new(0);

#[cortex_m_rt::entry]
fn main() -> ! {
    board::start_clocks();
    let mut serial = Serial::start();
    // All that can fail, fails here.
    let robot = match Robot::load(PACK, &calm::FRAMES) {
        Ok(robot) => robot,
        Err(error) => {
            _ = writeln!(serial, "the pack is refused: {error}\r");
            loop {
                registers::wait_while(|| true);
            }
        }
    };
    // The servos hold where they stand until the first frame.
    board::start_pulses(&robot.standing());
    _ = writeln!(serial, "frame,pan,tilt,left_antenna,right_antenna\r");
    board::start_timer();
    let mut told = 0;
    loop {
        registers::wait_while(|| FRAMES.load(Ordering::Relaxed) == told);
        let [pan, tilt, left, right] = board::pulses();
        _ = writeln!(serial, "{told},{pan},{tilt},{left},{right}\r");
        told = told.wrapping_add(1);
    }
}

/// 50 times a second: the next frame becomes four pulse widths.
#[cortex_m_rt::exception]
fn SysTick() {
    // The interrupt's own: nothing else sees the robot, so nothing is locked.
    static mut ROBOT: Option<Robot> = None;
    if ROBOT.is_none() {
        *ROBOT = Robot::load(PACK, &calm::FRAMES).ok();
    }
    let frame = FRAMES.load(Ordering::Relaxed);
    if let Some(robot) = ROBOT {
        board::set_pulses(&robot.frame(robot::mood(frame), robot::lost(frame)));
        FRAMES.store(frame.wrapping_add(1), Ordering::Relaxed);
    }
}

/// Nothing here panics. If something of yours does, the servos hold where they are.
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {
        registers::wait_while(|| true);
    }
}
