//! An emotion of a strength: a change of it, and a frame of playback, through the very `Emotion` of the product.

use kinesic::emotion::{Emotion, EmotionState};
use kinesic::{Frame, Pack};

use crate::{Digest, Refused, Workload};

/// Rows of the made gait's coordinates: 19 joints and the root.
pub const ROWS: usize = 20;
/// Keyframes, the paper's.
pub const KEYS: usize = 13;
/// Components of a keyframe, the paper's.
pub const COMPONENTS: usize = 40;

/// `Emotion::change`: the network, the back-projection, the times between keyframes, what fades out.
#[derive(Clone, Copy, Debug)]
pub struct Change;

/// `Emotion::step` at a strength that stays.
#[derive(Clone, Copy, Debug)]
pub struct Play;

type Model<'p> = Emotion<'p, ROWS, KEYS, COMPONENTS>;

/// RAM of a motion and its caller: the state, the time that passes and the frame that goes out.
#[derive(Clone, Debug)]
pub struct Running {
    state: EmotionState<ROWS, KEYS>,
    dt: f32,
    frame: Frame<ROWS>,
}

fn open(pack: &[u8]) -> Result<Model<'_>, Refused> {
    let pack = Pack::load(pack).map_err(|_| Refused)?;
    Emotion::load(&pack).map_err(|_| Refused)
}

fn power_on(model: &Model) -> Running {
    let mut state = EmotionState::new();
    model.change(&mut state);
    Running { state, dt: 0.0, frame: Frame::new() }
}

/// An input frame is a strength and the time that passes, s.
fn numbers(input: &[u8]) -> [f32; 2] {
    let mut numbers = input.as_chunks::<4>().0.iter().map(|bytes| f32::from_le_bytes(*bytes));
    [numbers.next().unwrap_or(0.0), numbers.next().unwrap_or(0.0)]
}

fn output(frame: &Frame<ROWS>, digest: &mut Digest) {
    frame.coordinates().iter().chain(&frame.ground).for_each(|x| digest.float(*x));
    frame.heading.forward().iter().for_each(|x| digest.float(*x));
}

/// A frame is played before each change, so that its coordinates show every bit of the change before.
impl Workload for Change {
    type Model<'p> = Model<'p>;
    type State = Running;

    fn open(pack: &[u8]) -> Result<Self::Model<'_>, Refused> {
        open(pack)
    }

    fn power_on(model: &Self::Model<'_>) -> Self::State {
        power_on(model)
    }

    fn load(model: &Self::Model<'_>, running: &mut Self::State, input: &[u8]) {
        let [strength, dt] = numbers(input);
        model.step(&mut running.state, dt, &mut running.frame);
        if let Some(first) = running.state.strength.first_mut() {
            *first = strength;
        }
    }

    #[inline(always)]
    fn step(model: &Self::Model<'_>, running: &mut Self::State) {
        model.change(&mut running.state);
    }

    fn output(_: &Self::Model<'_>, running: &Self::State, digest: &mut Digest) {
        output(&running.frame, digest);
        digest.float(running.state.seconds());
    }
}

impl Workload for Play {
    type Model<'p> = Model<'p>;
    type State = Running;

    fn open(pack: &[u8]) -> Result<Self::Model<'_>, Refused> {
        open(pack)
    }

    fn power_on(model: &Self::Model<'_>) -> Self::State {
        power_on(model)
    }

    fn load(_: &Self::Model<'_>, running: &mut Self::State, input: &[u8]) {
        let [_, dt] = numbers(input);
        running.dt = dt;
    }

    #[inline(always)]
    fn step(model: &Self::Model<'_>, running: &mut Self::State) {
        model.step(&mut running.state, running.dt, &mut running.frame);
    }

    fn output(_: &Self::Model<'_>, running: &Self::State, digest: &mut Digest) {
        output(&running.frame, digest);
        let (key, part) = running.state.phase();
        digest.word(key as u32);
        digest.float(part);
    }
}
