//! Bare matrix x vector, 120 x 300, in f32 and in int8: what other libraries publish, and all that a network's layer does.

use kinesic::Pack;
use kinesic::kernel::{Activations, LARGEST_ACTIVATION, Quantised, Tiled};

use crate::{Digest, Refused, Workload};

/// Rows of the matrix.
pub const ROWS: usize = 120;
/// Columns of the matrix.
pub const COLUMNS: usize = 300;

/// `y += W x` in f32.
#[derive(Clone, Copy, Debug)]
pub struct F32;

/// `y = W x + b` with int8 weights and int16 activations, brought back to a fixed-point result.
#[derive(Clone, Copy, Debug)]
pub struct I8;

/// Vectors of [`F32`].
#[derive(Clone, Copy, Debug)]
pub struct Floats {
    x: [f32; COLUMNS],
    y: [f32; ROWS],
}

/// Vectors of [`I8`].
#[derive(Clone, Copy, Debug)]
pub struct Integers {
    x: Activations<COLUMNS>,
    y: [i32; ROWS],
}

/// The numbers of a frame.
fn numbers(input: &[u8]) -> impl Iterator<Item = f32> {
    input.as_chunks::<4>().0.iter().map(|bytes| f32::from_le_bytes(*bytes))
}

impl Workload for F32 {
    type Model<'p> = Tiled<'p>;
    type State = Floats;

    fn open(pack: &[u8]) -> Result<Self::Model<'_>, Refused> {
        let pack = Pack::load(pack).map_err(|_| Refused)?;
        Tiled::load(&pack, "kernel/weights", ROWS, COLUMNS).map_err(|_| Refused)
    }

    fn power_on(_: &Self::Model<'_>) -> Self::State {
        Floats { x: [0.0; COLUMNS], y: [0.0; ROWS] }
    }

    fn load(_: &Self::Model<'_>, state: &mut Self::State, input: &[u8]) {
        state.y = [0.0; ROWS];
        state.x.iter_mut().zip(numbers(input)).for_each(|(x, value)| *x = value);
    }

    #[inline(always)]
    fn step(model: &Self::Model<'_>, state: &mut Self::State) {
        model.multiply_add(&state.x, &mut state.y);
    }

    fn output(_: &Self::Model<'_>, state: &Self::State, digest: &mut Digest) {
        state.y.iter().for_each(|value| digest.float(*value));
    }
}

impl Workload for I8 {
    type Model<'p> = Quantised<'p>;
    type State = Integers;

    fn open(pack: &[u8]) -> Result<Self::Model<'_>, Refused> {
        let pack = Pack::load(pack).map_err(|_| Refused)?;
        Quantised::load(&pack, ["kernel/weights", "kernel/scale", "kernel/bias"], ROWS, COLUMNS).map_err(|_| Refused)
    }

    fn power_on(_: &Self::Model<'_>) -> Self::State {
        Integers { x: Activations::zero(), y: [0; ROWS] }
    }

    fn load(_: &Self::Model<'_>, state: &mut Self::State, input: &[u8]) {
        let scaled = numbers(input).map(|value| (value * f32::from(LARGEST_ACTIVATION)) as i16);
        state.x.values().iter_mut().zip(scaled).for_each(|(x, value)| *x = value);
    }

    #[inline(always)]
    fn step(model: &Self::Model<'_>, state: &mut Self::State) {
        model.apply(state.x.values(), &mut state.y, |z| z);
    }

    fn output(_: &Self::Model<'_>, state: &Self::State, digest: &mut Digest) {
        state.y.iter().for_each(|value| digest.word(*value as u32));
    }
}
