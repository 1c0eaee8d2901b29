//! Everything that is unsafe by nature: linker symbols, the raw stack, semihosting, faults and panics.

use core::arch::{asm, global_asm};
use kinesic_workloads::Frames;
use semihosting::{process, sys::arm_compat};

use crate::report;

#[cfg(target_arch = "arm")]
use cortex_m_rt as _;
#[cfg(target_arch = "riscv32")]
use riscv_rt as _;

const PAINT: u32 = 0xc5c5_5c5c;
/// Bytes above the statics that must stay painted.
const GUARD: usize = 1024;
/// Words below the stack pointer that are left alone: the painter's own frame may be pushed after it read the pointer.
const MARGIN: usize = 16;

// One instruction each, at a known address: the plugin starts and stops counting there and leaves the two out. Calls the
// compiler cannot see into, so no work moves across them.
#[cfg(target_arch = "arm")]
global_asm!(
    ".section .text.kinesic_marks,\"ax\",%progbits",
    ".syntax unified",
    ".global kinesic_frame_begin",
    ".type kinesic_frame_begin,%function",
    ".thumb_func",
    "kinesic_frame_begin: bx lr",
    ".global kinesic_frame_end",
    ".type kinesic_frame_end,%function",
    ".thumb_func",
    "kinesic_frame_end: bx lr",
    ".previous",
);
#[cfg(target_arch = "riscv32")]
global_asm!(
    ".section .text.kinesic_marks,\"ax\",@progbits",
    ".global kinesic_frame_begin",
    ".type kinesic_frame_begin,@function",
    "kinesic_frame_begin: ret",
    ".global kinesic_frame_end",
    ".type kinesic_frame_end,@function",
    "kinesic_frame_end: ret",
    ".previous",
);

unsafe extern "C" {
    safe fn kinesic_frame_begin();
    safe fn kinesic_frame_end();
    static mut __euninit: u32;
    static mut _stack_start: u32;
    static _kinesic_frames: u8;
}

/// Starts counting.
#[inline(always)]
pub fn frame_begin() {
    kinesic_frame_begin();
}

/// Stops counting.
#[inline(always)]
pub fn frame_end() {
    kinesic_frame_end();
}

/// The only reference to a workload's state.
///
/// # Safety
/// `state` must be valid, initialised, and taken once.
pub unsafe fn take_state<T>(state: *mut T) -> &'static mut T {
    // SAFETY: by the caller's promise.
    unsafe { &mut *state }
}

#[inline(always)]
fn stack_pointer() -> *mut u32 {
    let sp: *mut u32;
    // SAFETY: reads a register.
    unsafe {
        #[cfg(target_arch = "arm")]
        asm!("mov {}, sp", out(reg) sp, options(nomem, nostack, preserves_flags));
        #[cfg(target_arch = "riscv32")]
        asm!("mv {}, sp", out(reg) sp, options(nomem, nostack, preserves_flags));
    }
    sp
}

/// Fills the free part of the stack with a pattern.
#[inline(never)]
pub fn paint_stack() {
    let mut word = &raw mut __euninit;
    let top = stack_pointer().wrapping_sub(MARGIN);
    while word < top {
        // SAFETY: below the stack pointer and above the last static nothing lives, and no interrupt is enabled.
        unsafe { word.write_volatile(PAINT) };
        word = word.wrapping_add(1);
    }
}

/// Bytes between the top of the stack and the lowest word that was written since it was painted.
#[inline(never)]
pub fn stack_used() -> usize {
    let mut word = &raw mut __euninit;
    let top = stack_pointer();
    // SAFETY: reads RAM between the statics and the stack pointer.
    while word < top && unsafe { word.read_volatile() } == PAINT {
        word = word.wrapping_add(1);
    }
    // Frames may skip words, so an overrun can leave some paint at the bottom: too little left is as bad as none.
    if word.addr() < (&raw mut __euninit).addr() + GUARD {
        abort_run("the stack ran into the statics\n");
    }
    (&raw mut _stack_start).addr() - word.addr()
}

/// The input block that the emulator placed at `_kinesic_frames`.
pub fn frames() -> Option<Frames<'static>> {
    let start = &raw const _kinesic_frames;
    // SAFETY: the layout reserves this address for the block; the header is read before its length is believed, and the
    // memory behind it is the board's external RAM, which nothing writes.
    unsafe {
        let header = core::slice::from_raw_parts(start, 16);
        let block = core::slice::from_raw_parts(start, Frames::block_len(header)?);
        Frames::open(block)
    }
}

/// One character to the host tool. Slow on silicon, free in an emulator, and it needs no buffer.
#[inline(never)]
pub fn put(character: u8) {
    arm_compat::sys_writec(character);
}

/// Leaves the emulator.
pub fn exit(code: i32) -> ! {
    process::exit(code)
}

/// Ends a run that cannot go on; the host tool shows the message.
pub fn abort_run(message: &str) -> ! {
    report::text("abort ");
    report::text(message);
    exit(2)
}

/// The name by which the symbol check finds any road to a panic, whatever the compiler inlined on the way.
#[unsafe(no_mangle)]
#[inline(never)]
extern "C" fn kinesic_panicked() -> ! {
    report::text("abort panicked\n");
    exit(101)
}

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    kinesic_panicked()
}

#[cfg(target_arch = "arm")]
#[cortex_m_rt::exception]
unsafe fn HardFault(_: &cortex_m_rt::ExceptionFrame) -> ! {
    abort_run("hard fault\n")
}

#[cfg(target_arch = "riscv32")]
#[unsafe(export_name = "ExceptionHandler")]
fn exception(_: &riscv_rt::TrapFrame) -> ! {
    abort_run("exception\n")
}
