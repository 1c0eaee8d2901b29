//! Negative control: a workload with a scratch buffer of 16 KiB on the stack. The painted stack must show it.
#![no_std]
#![no_main]

use kinesic_image::workloads::{Digest, Refused, Workload};

struct Deep;

impl Workload for Deep {
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
        // black_box: the buffer must really be there.
        let mut scratch = core::hint::black_box([1u32; 4096]);
        scratch[0] = *state;
        *state += core::hint::black_box(&scratch).iter().fold(0, |sum, value| sum ^ value);
    }

    fn output((): &(), state: &u32, digest: &mut Digest) {
        digest.word(*state);
    }
}

kinesic_image::image!(Deep, "empty.bin");
