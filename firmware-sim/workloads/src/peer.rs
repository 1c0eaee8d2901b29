//! Inference crates from the registry that a user would take instead, on a network of the same shape: 23-100-300-120.

use embedded_nn::fully_connected::fully_connected_s8;
use embedded_nn::types::{Activation, Dims, FcParams, PerTensorQuantParams};
use kinesic::Pack;

use crate::{Digest, Refused, Workload};

/// Units of the input, the two hidden layers and the output.
pub const SHAPE: [usize; 4] = [23, 100, 300, 120];

/// Three fully connected layers of embedded-nn, int8 in and out; no tanh, which is in its favour.
#[derive(Clone, Copy, Debug)]
pub struct EmbeddedNn;

/// Weights row-major, int8, in the pack's flash.
#[derive(Clone, Copy, Debug)]
pub struct Weights<'p>([&'p [i8]; 3]);

/// Activations of every layer.
#[derive(Clone, Copy, Debug)]
pub struct Running {
    input: [i8; SHAPE[0]],
    hidden: [i8; SHAPE[1]],
    code: [i8; SHAPE[2]],
    output: [i8; SHAPE[3]],
}

impl Workload for EmbeddedNn {
    type Model<'p> = Weights<'p>;
    type State = Running;

    fn open(pack: &[u8]) -> Result<Self::Model<'_>, Refused> {
        let pack = Pack::load(pack).map_err(|_| Refused)?;
        let named = |name| {
            let tensor = pack.metadata().tensors.iter().find(|tensor| tensor.name == name).ok_or(Refused)?;
            Ok::<_, Refused>(bytemuck::cast_slice(pack.bytes(&tensor).ok_or(Refused)?))
        };
        Ok(Weights([named("peer/hidden")?, named("peer/code")?, named("peer/decoder")?]))
    }

    fn power_on(_: &Self::Model<'_>) -> Self::State {
        Running { input: [0; SHAPE[0]], hidden: [0; SHAPE[1]], code: [0; SHAPE[2]], output: [0; SHAPE[3]] }
    }

    fn load(_: &Self::Model<'_>, state: &mut Self::State, input: &[u8]) {
        let numbers = input.as_chunks::<4>().0.iter().map(|bytes| f32::from_le_bytes(*bytes));
        state.input.iter_mut().zip(numbers).for_each(|(x, value)| *x = (value * 127.0) as i8);
    }

    #[inline(always)]
    fn step(Weights([hidden, code, decoder]): &Self::Model<'_>, state: &mut Self::State) {
        layer(&state.input, hidden, &mut state.hidden);
        layer(&state.hidden, code, &mut state.code);
        layer(&state.code, decoder, &mut state.output);
    }

    fn output(_: &Self::Model<'_>, state: &Self::State, digest: &mut Digest) {
        state.output.iter().for_each(|value| digest.word(*value as u32));
    }
}

#[inline(always)]
fn layer(x: &[i8], weights: &[i8], y: &mut [i8]) {
    let (columns, rows) = (x.len() as i32, y.len() as i32);
    let params = FcParams {
        input_offset: 0,
        filter_offset: 0,
        output_offset: 0,
        activation: Activation { min: -128, max: 127 },
    };
    let scale = PerTensorQuantParams { multiplier: 1 << 30, shift: -8 };
    let dims = |n, c| Dims { n, h: 1, w: 1, c };
    // Refuses nothing here: the slices have the shapes that the dimensions say.
    let _ = fully_connected_s8(
        &params,
        &scale,
        &dims(1, columns),
        x,
        &dims(columns, rows),
        weights,
        None,
        &dims(1, rows),
        y,
    );
}
