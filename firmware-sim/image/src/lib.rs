//! Runs one workload on a bare core: vector table and start-up from `cortex-m-rt` / `riscv-rt`, input frames from memory,
//! a hash per frame and the stack's high-water mark over semihosting.
//!
//! A binary is one line: `kinesic_image::image!(Workload, "pack file name")`.
#![no_std]

mod board;
mod report;

pub use board::{abort_run, take_state};
use core::mem::MaybeUninit;
pub use kinesic_workloads as workloads;
use kinesic_workloads::{Digest, Workload};

/// Keeps a pack on the boundary that block loads and typed views need.
#[repr(C, align(16))]
#[derive(Debug)]
pub struct Aligned<T: ?Sized>(pub T);

/// The whole life of an image. Symbols `kinesic_frame_begin` and `kinesic_frame_end` bracket what is counted.
pub fn run<W: Workload>(pack: &'static [u8], state: &'static mut MaybeUninit<W::State>) -> ! {
    board::paint_stack();
    let Ok(model) = W::open(pack) else { abort_run("the pack was refused\n") };
    let state = power_on::<W>(&model, state);
    let Some(frames) = board::frames() else { abort_run("no block of frames at _kinesic_frames\n") };
    let start_up = board::stack_used();

    // Painted again, so that the frames' own high-water mark can be told from start-up's.
    board::paint_stack();
    for frame in frames.iter() {
        W::load(&model, state, frame);
        board::frame_begin();
        step::<W>(&model, state);
        board::frame_end();
        let mut digest = Digest::default();
        W::output(&model, state, &mut digest);
        report::line("frame ", digest.value());
    }
    report::line("stack-start-up ", start_up as u64);
    report::line("stack-frames ", board::stack_used() as u64);
    report::text("done\n");
    board::exit(0)
}

/// Apart from `run`, so that whatever the stack holds while a state is made is gone when the frames start.
#[inline(never)]
fn power_on<'s, W: Workload>(model: &W::Model<'_>, state: &'s mut MaybeUninit<W::State>) -> &'s mut W::State {
    state.write(W::power_on(model))
}

/// A function of its own, as in a product: its stack is its own, not the test bench's.
#[inline(never)]
fn step<W: Workload>(model: &W::Model<'_>, state: &mut W::State) {
    W::step(model, state);
}

/// Makes a binary of a workload and its pack (a file in the folder `KINESIC_PACKS`).
#[macro_export]
macro_rules! image {
    ($workload:ty, $pack:literal) => {
        // The symbol's size is how the host tool tells the pack from the code.
        #[unsafe(no_mangle)]
        static KINESIC_PACK: $crate::Aligned<[u8; include_bytes!(concat!(env!("KINESIC_PACKS"), "/", $pack)).len()]> =
            $crate::Aligned(*include_bytes!(concat!(env!("KINESIC_PACKS"), "/", $pack)));

        static mut STATE: core::mem::MaybeUninit<<$workload as $crate::workloads::Workload>::State> =
            core::mem::MaybeUninit::uninit();

        /// Called by the runtime crate once, after memory is set up.
        #[unsafe(no_mangle)]
        extern "C" fn main() -> ! {
            // SAFETY: the runtime calls `main` once, and nothing else names STATE.
            let state = unsafe { $crate::take_state(&raw mut STATE) };
            $crate::run::<$workload>(&KINESIC_PACK.0, state)
        }
    };
}
