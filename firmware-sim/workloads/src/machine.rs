//! What the firmware of a servo machine does in a frame: angles in; style, limits, and what every servo is told out.

use kinesic::model::{Floats, Ungated};
use kinesic::{LimitState, Limiter, Pack, Pipeline, PipelineState, Servos, Translator, TranslatorState};

use crate::{Digest, Refused, Workload};

/// A machine of `SERVOS`, of its pack's capacities: those that `kinesic inspect` prints.
#[derive(Clone, Copy, Debug)]
pub struct Machine<const SERVOS: usize, const ROWS: usize, const STATES: usize>;

/// A pan-tilt head.
pub type Head = Machine<2, 1, 12>;
/// A lamp of five servos.
pub type Lamp = Machine<5, 2, 29>;
/// A head with two antennas.
pub type Antennas = Machine<4, 2, 28>;

/// RAM of the pipeline and its caller: the state, the angles that come in, the numbers that go out.
#[derive(Clone, Debug)]
pub struct Running<const SERVOS: usize, const ROWS: usize, const STATES: usize> {
    state: PipelineState<(TranslatorState<ROWS, STATES>, LimitState<ROWS>), ROWS>,
    angles: [f32; SERVOS],
    told: [i32; SERVOS],
}

/// An input frame is an angle per servo, rad.
impl<const SERVOS: usize, const ROWS: usize, const STATES: usize> Workload for Machine<SERVOS, ROWS, STATES> {
    type Model<'p> =
        (Pipeline<'p, (Translator<'p, ROWS, STATES, Ungated<Floats>>, Limiter<'p, ROWS>), ROWS>, Servos<'p>);
    type State = Running<SERVOS, ROWS, STATES>;

    fn open(pack: &[u8]) -> Result<Self::Model<'_>, Refused> {
        let pack = Pack::load(pack).map_err(|_| Refused)?;
        Ok((Pipeline::load(&pack).map_err(|_| Refused)?, Servos::load(&pack).map_err(|_| Refused)?))
    }

    fn power_on(_: &Self::Model<'_>) -> Self::State {
        Running { state: PipelineState::new(), angles: [0.0; SERVOS], told: [0; SERVOS] }
    }

    fn load(_: &Self::Model<'_>, running: &mut Self::State, input: &[u8]) {
        let numbers = input.as_chunks::<4>().0.iter().map(|bytes| f32::from_le_bytes(*bytes));
        running.angles.iter_mut().zip(numbers).for_each(|(angle, number)| *angle = number);
    }

    #[inline(always)]
    fn step((pipeline, servos): &Self::Model<'_>, running: &mut Self::State) {
        let mut out = [0.0; SERVOS];
        pipeline.step_coordinates(&mut running.state, Some(&running.angles), &mut out);
        running.told.iter_mut().zip(servos.commands(&out)).for_each(|(told, command)| *told = command.whole());
    }

    fn output(_: &Self::Model<'_>, running: &Self::State, digest: &mut Digest) {
        // A pulse of microseconds is exact in f32.
        running.told.iter().for_each(|told| digest.float(*told as f32));
    }
}
