//! Negative control: a workload that can panic, and does in frame 2. The symbol check and the run must both catch it.
#![no_std]
#![no_main]

use kinesic_image::workloads::{Digest, Refused, Workload};

struct Panics;

impl Workload for Panics {
    type Model<'p> = ();
    type State = [usize; 2];

    fn open(_: &[u8]) -> Result<(), Refused> {
        Ok(())
    }

    fn power_on((): &()) -> [usize; 2] {
        [0; 2]
    }

    fn load((): &(), _: &mut [usize; 2], _: &[u8]) {}

    fn step((): &(), state: &mut [usize; 2]) {
        // An index that the compiler cannot prove, the commonest road to a panic: 0, 1, then out of bounds.
        let index = core::hint::black_box(state[0]);
        state[index] += 1;
        state[0] = index + 1;
    }

    fn output((): &(), state: &[usize; 2], digest: &mut Digest) {
        digest.word(state[0] as u32);
    }
}

kinesic_image::image!(Panics, "empty.bin");
