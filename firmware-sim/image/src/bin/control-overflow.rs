//! Negative control: a recursion of about 3 MiB, through the statics and out of RAM. The run must fail, not pass: by a fault
//! where nothing lies below RAM, by the painted stack where something does.
#![no_std]
#![no_main]

use kinesic_image::workloads::{Digest, Refused, Workload};

struct Bottomless;

impl Workload for Bottomless {
    type Model<'p> = ();
    type State = u32;

    fn open(_: &[u8]) -> Result<(), Refused> {
        Ok(())
    }

    fn power_on((): &()) -> u32 {
        0
    }

    fn load((): &(), _: &mut u32, _: &[u8]) {}

    fn step((): &(), state: &mut u32) {
        *state = descend(40_000);
    }

    fn output((): &(), state: &u32, digest: &mut Digest) {
        digest.word(*state);
    }
}

#[inline(never)]
fn descend(depth: u32) -> u32 {
    let frame = core::hint::black_box([depth; 16]);
    if depth == 0 {
        0
    } else {
        core::hint::black_box(descend(depth - 1)).wrapping_add(frame.iter().fold(0, |a, b| a ^ b))
    }
}

kinesic_image::image!(Bottomless, "empty.bin");
