//! A machine of eight servos: angles in, styled angles within their limits out. No rotation stands between.

use core::marker::PhantomData;

use kinesic::model::{Floats, Integers, Numbers, Ungated};
use kinesic::{LimitState, Limiter, Pack, Pipeline, PipelineState, Translator, TranslatorState};

use crate::{Digest, Refused, Workload};

/// Servos.
pub const SERVOS: usize = 8;
/// Rows of their coordinates.
pub const ROWS: usize = 3;
/// Filter states of a shared model of order 40, and its 6 drives.
pub const STATES: usize = 46;

/// Style translation and limits in the number types `N`.
#[derive(Clone, Copy, Debug)]
pub struct Servos<N>(PhantomData<N>);

/// In f32.
pub type ServosFloat = Servos<Floats>;
/// The translator in fixed point.
pub type ServosFixed = Servos<Integers>;

/// RAM of the pipeline and its caller: the state, the angles that come in and those that go out.
#[derive(Clone, Debug)]
pub struct Running {
    state: PipelineState<(TranslatorState<ROWS, STATES>, LimitState<ROWS>), ROWS>,
    angles: [f32; SERVOS],
    out: [f32; SERVOS],
}

/// An input frame is an angle per servo, rad.
impl<N: Numbers> Workload for Servos<N> {
    type Model<'p> = Pipeline<'p, (Translator<'p, ROWS, STATES, Ungated<N>>, Limiter<'p, ROWS>), ROWS>;
    type State = Running;

    fn open(pack: &[u8]) -> Result<Self::Model<'_>, Refused> {
        let pack = Pack::load(pack).map_err(|_| Refused)?;
        Pipeline::load(&pack).map_err(|_| Refused)
    }

    fn power_on(_: &Self::Model<'_>) -> Self::State {
        Running { state: PipelineState::new(), angles: [0.0; SERVOS], out: [0.0; SERVOS] }
    }

    fn load(_: &Self::Model<'_>, running: &mut Self::State, input: &[u8]) {
        let numbers = input.as_chunks::<4>().0.iter().map(|bytes| f32::from_le_bytes(*bytes));
        running.angles.iter_mut().zip(numbers).for_each(|(angle, number)| *angle = number);
    }

    #[inline(always)]
    fn step(model: &Self::Model<'_>, running: &mut Self::State) {
        model.step_coordinates(&mut running.state, Some(&running.angles), &mut running.out);
    }

    fn output(_: &Self::Model<'_>, running: &Self::State, digest: &mut Digest) {
        running.out.iter().for_each(|angle| digest.float(*angle));
    }
}
