//! Loops that can be counted by hand, for the test of the cycle model: `firmware-sim/tests/calibrate.rs` has the counts.
//! Every loop is a function of its own, called once a frame.
#![no_std]
#![no_main]

use kinesic_image::workloads::{Digest, Refused, Workload};

#[cfg(target_arch = "arm")]
core::arch::global_asm!(include_str!("calibrate_arm.s"), options(raw));
#[cfg(all(target_arch = "arm", target_abi = "eabihf"))]
core::arch::global_asm!(include_str!("calibrate_vfp.s"), options(raw));
#[cfg(target_arch = "riscv32")]
core::arch::global_asm!(include_str!("calibrate_riscv.s"), options(raw));

unsafe extern "C" {
    safe fn loop_adds();
    safe fn loop_multiplies();
    safe fn loop_loads();
    safe fn loop_calls();
    #[cfg(target_abi = "eabihf")]
    safe fn loop_floats();
}

struct Loops;

impl Workload for Loops {
    type Model<'p> = ();
    type State = ();

    fn open(_: &[u8]) -> Result<(), Refused> {
        Ok(())
    }

    fn power_on((): &()) {}

    fn load((): &(), (): &mut (), _: &[u8]) {}

    fn step((): &(), (): &mut ()) {
        loop_adds();
        loop_multiplies();
        loop_loads();
        loop_calls();
        #[cfg(target_abi = "eabihf")]
        loop_floats();
    }

    fn output((): &(), (): &(), _: &mut Digest) {}
}

kinesic_image::image!(Loops, "empty.bin");
