//! What `styled` does, by hand: rig, translator and limiter called one after the other, without `Pipeline`, guard and tuple. A test
//! compares the size of the images.

use kinesic::model::Floats;
use kinesic::rig::{Drift, Rig};
use kinesic::{Frame, LimitState, Limiter, Pack, Pose, Translator, TranslatorState};

use crate::posed::{GAIT_JOINTS, STATES};
use crate::{Digest, Refused, Workload, pose};

const ROWS: usize = GAIT_JOINTS + 1;

/// The engines, borrowed from a pack.
#[derive(Clone, Copy, Debug)]
pub struct Model<'p> {
    rig: Rig<'p>,
    translator: Translator<'p, ROWS, STATES, Floats>,
    limiter: Limiter<'p, ROWS>,
}

/// Their states, and the caller's poses.
#[derive(Debug)]
pub struct State {
    translator: TranslatorState<ROWS, STATES>,
    limiter: LimitState<ROWS>,
    source: Frame<ROWS>,
    drift: Drift,
    from: Pose<GAIT_JOINTS>,
    out: Pose<GAIT_JOINTS>,
}

/// Takes an input frame as [`pose::load`] does.
#[derive(Clone, Copy, Debug)]
pub struct ByHand;

impl Workload for ByHand {
    type Model<'p> = Model<'p>;
    type State = State;

    fn open(pack: &[u8]) -> Result<Self::Model<'_>, Refused> {
        let pack = Pack::load(pack).map_err(|_| Refused)?;
        Ok(Model {
            rig: Rig::load(&pack).map_err(|_| Refused)?,
            translator: Translator::load_numbers(&pack).map_err(|_| Refused)?,
            limiter: Limiter::load(&pack).map_err(|_| Refused)?,
        })
    }

    fn power_on(_: &Self::Model<'_>) -> Self::State {
        State {
            translator: TranslatorState::new(),
            limiter: LimitState::new(),
            source: Frame::new(),
            drift: Drift::new(),
            from: Pose::identity(),
            out: Pose::identity(),
        }
    }

    fn load(_: &Self::Model<'_>, state: &mut Self::State, input: &[u8]) {
        pose::load(&mut state.from, input);
    }

    #[inline(always)]
    fn step(model: &Self::Model<'_>, state: &mut Self::State) {
        model.rig.read(&state.from, &mut state.source);
        let mut styled = state.source;
        model.translator.step(&mut state.translator, &mut styled);
        model.limiter.step(&mut state.limiter, &mut styled);
        model.rig.write(&state.source, &styled, &mut state.drift, &state.from, &mut state.out);
    }

    fn output(_: &Self::Model<'_>, state: &Self::State, digest: &mut Digest) {
        pose::output(&state.out, digest);
    }
}
