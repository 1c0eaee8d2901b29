//! Everything that a body can have in a frame: body mechanics with half the expression, a whole-body translator, style components,
//! a walk at an emotion's strength, their mean, joint limits, through the very `Pipeline` of the product.

use kinesic::{Pack, Pipeline, PipelineState, Pose};

use crate::{Digest, Refused, Workload, pose};

/// Joints, network and window of `models/mechanics.kin`.
pub use crate::mechanics::{JOINTS, UNITS, WINDOW};
/// Components of a style, and of a keyframe.
pub const COUNT: usize = 30;
/// Filter states and drives of the translator.
pub const STATES: usize = 48;
/// Keyframes of the emotion.
pub const KEYS: usize = 13;

/// `Pipeline::step` with all engines.
#[derive(Clone, Copy, Debug)]
pub struct Whole;

/// RAM of the pipeline and its caller: the state, the pose that comes in and the pose that goes out.
#[derive(Clone, Debug)]
pub struct Running {
    state: PipelineState<JOINTS, STATES, WINDOW, KEYS>,
    source: Pose<JOINTS>,
    out: Pose<JOINTS>,
}

/// Takes an input frame as [`pose::load`] does.
impl Workload for Whole {
    type Model<'p> = Pipeline<'p, JOINTS, STATES, UNITS, WINDOW, COUNT, KEYS>;
    type State = Running;

    fn open(pack: &[u8]) -> Result<Self::Model<'_>, Refused> {
        let pack = Pack::load(pack).map_err(|_| Refused)?;
        Pipeline::load(&pack).map_err(|_| Refused)
    }

    fn power_on(model: &Self::Model<'_>) -> Self::State {
        let mut state = PipelineState::new();
        state.modulation.amount = 0.5;
        state.weights.emotion = 1.0;
        model.change_strength(&mut state);
        Running { state, source: Pose::identity(), out: Pose::identity() }
    }

    fn load(_: &Self::Model<'_>, running: &mut Self::State, input: &[u8]) {
        pose::load(&mut running.source, input);
    }

    #[inline(always)]
    fn step(model: &Self::Model<'_>, running: &mut Self::State) {
        model.step(&mut running.state, Some(&running.source), &mut running.out);
    }

    fn output(_: &Self::Model<'_>, running: &Self::State, digest: &mut Digest) {
        pose::output(&running.out, digest);
    }
}
