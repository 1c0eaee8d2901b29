//! One model of order 40, 3 inputs and 3 outputs: the modal recursion in f32 and in fixed point, and what a user of nalgebra would
//! write instead, the dense step of the same size.

use kinesic::Pack;
use kinesic::kernel::{FixedBlock, JointBlock, advance_joint, advance_joint_fixed};
use nalgebra::{SMatrixView, SVector};

use crate::{Digest, Refused, Workload};

/// States.
pub const ORDER: usize = 40;
/// Inputs, and outputs.
pub const SIDES: usize = 3;

/// `advance_joint`.
#[derive(Clone, Copy, Debug)]
pub struct Modal;

/// `advance_joint_fixed`.
#[derive(Clone, Copy, Debug)]
pub struct ModalFixed;

/// The peer: `y = C x`, `x' = A x + B u` with nalgebra's static matrices over weights in flash.
#[derive(Clone, Copy, Debug)]
pub struct Nalgebra;

/// Matrices of [`Nalgebra`], column-major, borrowed.
#[derive(Clone, Copy, Debug)]
pub struct Dense<'p> {
    a: SMatrixView<'p, f32, ORDER, ORDER>,
    b: SMatrixView<'p, f32, ORDER, SIDES>,
    c: SMatrixView<'p, f32, SIDES, ORDER>,
}

/// Input, states and output.
#[derive(Clone, Copy, Debug)]
pub struct Running<X, Y> {
    u: Y,
    x: X,
    y: Y,
}

fn numbers(input: &[u8]) -> impl Iterator<Item = f32> {
    input.as_chunks::<4>().0.iter().map(|bytes| f32::from_le_bytes(*bytes))
}

impl Workload for Modal {
    type Model<'p> = &'p [JointBlock];
    type State = Running<[[f32; 2]; ORDER / 2], [f32; SIDES]>;

    fn open(pack: &[u8]) -> Result<Self::Model<'_>, Refused> {
        Pack::load(pack).map_err(|_| Refused)?.slice("modal/blocks", ORDER / 2).map_err(|_| Refused)
    }

    fn power_on(_: &Self::Model<'_>) -> Self::State {
        Running { u: [0.0; SIDES], x: [[0.0; 2]; ORDER / 2], y: [0.0; SIDES] }
    }

    fn load(_: &Self::Model<'_>, state: &mut Self::State, input: &[u8]) {
        state.y = [0.0; SIDES];
        state.u.iter_mut().zip(numbers(input)).for_each(|(u, value)| *u = value);
    }

    #[inline(always)]
    fn step(model: &Self::Model<'_>, state: &mut Self::State) {
        advance_joint(model, state.u, &mut state.x, &mut state.y);
    }

    fn output(_: &Self::Model<'_>, state: &Self::State, digest: &mut Digest) {
        state.y.iter().chain(state.x.as_flattened()).for_each(|value| digest.float(*value));
    }
}

impl Workload for ModalFixed {
    type Model<'p> = &'p [FixedBlock];
    type State = Running<[[i32; 2]; ORDER / 2], [i32; SIDES]>;

    fn open(pack: &[u8]) -> Result<Self::Model<'_>, Refused> {
        Pack::load(pack).map_err(|_| Refused)?.slice("modal/fixed", ORDER / 2).map_err(|_| Refused)
    }

    fn power_on(_: &Self::Model<'_>) -> Self::State {
        Running { u: [0; SIDES], x: [[0; 2]; ORDER / 2], y: [0; SIDES] }
    }

    fn load(_: &Self::Model<'_>, state: &mut Self::State, input: &[u8]) {
        state.y = [0; SIDES];
        state.u.iter_mut().zip(numbers(input)).for_each(|(u, value)| *u = (value * 2_048.0) as i32);
    }

    #[inline(always)]
    fn step(model: &Self::Model<'_>, state: &mut Self::State) {
        advance_joint_fixed(model, state.u, &mut state.x, &mut state.y);
    }

    fn output(_: &Self::Model<'_>, state: &Self::State, digest: &mut Digest) {
        state.y.iter().chain(state.x.as_flattened()).for_each(|value| digest.word(*value as u32));
    }
}

impl Workload for Nalgebra {
    type Model<'p> = Dense<'p>;
    type State = Running<SVector<f32, ORDER>, SVector<f32, SIDES>>;

    fn open(pack: &[u8]) -> Result<Self::Model<'_>, Refused> {
        let pack = Pack::load(pack).map_err(|_| Refused)?;
        Ok(Dense {
            a: SMatrixView::from_slice(pack.slice("dense/a", ORDER * ORDER).map_err(|_| Refused)?),
            b: SMatrixView::from_slice(pack.slice("dense/b", ORDER * SIDES).map_err(|_| Refused)?),
            c: SMatrixView::from_slice(pack.slice("dense/c", SIDES * ORDER).map_err(|_| Refused)?),
        })
    }

    fn power_on(_: &Self::Model<'_>) -> Self::State {
        Running { u: SVector::zeros(), x: SVector::zeros(), y: SVector::zeros() }
    }

    fn load(_: &Self::Model<'_>, state: &mut Self::State, input: &[u8]) {
        state.u.iter_mut().zip(numbers(input)).for_each(|(u, value)| *u = value);
    }

    #[inline(always)]
    fn step(model: &Self::Model<'_>, state: &mut Self::State) {
        state.y = model.c * state.x;
        state.x = model.a * state.x + model.b * state.u;
    }

    fn output(_: &Self::Model<'_>, state: &Self::State, digest: &mut Digest) {
        state.y.iter().chain(state.x.iter()).for_each(|value| digest.float(*value));
    }
}
