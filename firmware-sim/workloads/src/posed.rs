//! Engines between pose and pose, through the very `Pipeline` of the product.

use core::marker::PhantomData;

use kinesic::engine::{Engine, FromPack, Mix};
use kinesic::mechanics::Expression;
use kinesic::model::{AnyNumbers, Floats, Integers, Numbers};
use kinesic::{Components, Emotion, Limiter, Pack, Pipeline, PipelineState, Pose, Translator};

use crate::mechanics::{self, UNITS, WINDOW};
use crate::{Digest, Refused, Workload, pose};

/// What stands between pose and pose.
pub trait Composition<const ROWS: usize> {
    /// What the engines remember.
    type State: Default + 'static;
    /// The engines, borrowed from a pack.
    type Engine<'p>: Engine<ROWS, State = Self::State> + FromPack<'p>;
    /// Sets the controls at power-on, and does what would otherwise be the first frame's.
    fn set(_: &Self::Engine<'_>, _: &mut Self::State) {}
}

/// A composition on poses of `JOINTS` joints.
#[derive(Clone, Copy, Debug)]
pub struct Posed<C, const JOINTS: usize, const ROWS: usize>(PhantomData<C>);

/// RAM of a pipeline and its caller: the state, the pose that comes in and the pose that goes out.
#[derive(Clone, Debug)]
pub struct Running<S, const JOINTS: usize, const ROWS: usize> {
    state: PipelineState<S, ROWS>,
    pub(crate) source: Pose<JOINTS>,
    pub(crate) out: Pose<JOINTS>,
}

/// Takes an input frame as [`pose::load`] does.
impl<C: Composition<ROWS>, const JOINTS: usize, const ROWS: usize> Workload for Posed<C, JOINTS, ROWS> {
    type Model<'p> = Pipeline<'p, C::Engine<'p>, ROWS>;
    type State = Running<C::State, JOINTS, ROWS>;

    fn open(pack: &[u8]) -> Result<Self::Model<'_>, Refused> {
        let pack = Pack::load(pack).map_err(|_| Refused)?;
        Pipeline::load(&pack).map_err(|_| Refused)
    }

    fn power_on(model: &Self::Model<'_>) -> Self::State {
        let mut running = Running { state: PipelineState::new(), source: Pose::identity(), out: Pose::identity() };
        C::set(&model.engine, &mut running.state.engine);
        running
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

/// Style translation with room for `STATES` filter states, in the number types `N`.
#[derive(Clone, Copy, Debug)]
pub struct Translating<const STATES: usize, N>(PhantomData<N>);

impl<const ROWS: usize, const STATES: usize, N: Numbers> Composition<ROWS> for Translating<STATES, N> {
    type State = kinesic::TranslatorState<ROWS, STATES>;
    type Engine<'p> = Translator<'p, ROWS, STATES, N>;
}

/// Style components.
#[derive(Clone, Copy, Debug)]
pub struct Restyling<const COUNT: usize>;

impl<const ROWS: usize, const COUNT: usize> Composition<ROWS> for Restyling<COUNT> {
    type State = kinesic::ComponentsState<ROWS>;
    type Engine<'p> = Components<'p, ROWS, COUNT>;
}

/// Limits alone.
#[derive(Clone, Copy, Debug)]
pub struct Limiting;

impl<const ROWS: usize> Composition<ROWS> for Limiting {
    type State = kinesic::LimitState<ROWS>;
    type Engine<'p> = Limiter<'p, ROWS>;
}

/// Style translation, then limits.
#[derive(Clone, Copy, Debug)]
pub struct Limited<const STATES: usize, N>(PhantomData<N>);

impl<const ROWS: usize, const STATES: usize, N: Numbers> Composition<ROWS> for Limited<STATES, N> {
    type State = (kinesic::TranslatorState<ROWS, STATES>, kinesic::LimitState<ROWS>);
    type Engine<'p> = (Translator<'p, ROWS, STATES, N>, Limiter<'p, ROWS>);
}

/// Everything that a body can have in a frame: the mean of body mechanics with half the expression, a whole-body translator, style
/// components and a walk at an emotion's strength; then limits.
#[derive(Clone, Copy, Debug)]
pub struct Everything;

/// Components of a style, and of a keyframe.
pub const COUNT: usize = 30;
/// Filter states and drives of a whole-body translator of order 40.
pub const STATES: usize = 48;
/// Keyframes of the emotion.
pub const KEYS: usize = 13;

type All<'p, const ROWS: usize> = (
    Mix<(
        Expression<'p, { mechanics::JOINTS }, UNITS, WINDOW>,
        Translator<'p, ROWS, STATES, AnyNumbers>,
        Components<'p, ROWS, COUNT>,
        Emotion<'p, ROWS, KEYS, COUNT>,
    )>,
    Limiter<'p, ROWS>,
);

impl<const ROWS: usize> Composition<ROWS> for Everything {
    type State = <All<'static, ROWS> as Engine<ROWS>>::State;
    type Engine<'p> = All<'p, ROWS>;

    fn set((Mix((.., emotion)), _): &Self::Engine<'_>, (mix, _): &mut Self::State) {
        let (expression, .., moods) = &mut mix.engines;
        expression.modulation.amount = 0.5;
        emotion.change(moods);
    }
}

/// Joints of the made body, and rows of its coordinates: a ball per joint, and the root's.
pub const JOINTS: usize = 25;
/// Joints of the made body without the ends of its toes.
pub const SHORT_JOINTS: usize = 23;
/// Joints of the made gait.
pub const GAIT_JOINTS: usize = 19;
/// Joints of the recorded body.
pub const RECORDED_JOINTS: usize = 31;

/// The paper's form: one model of order 40 per joint.
pub type PerJoint = Posed<Translating<{ (JOINTS + 1) * 40 }, Floats>, JOINTS, { JOINTS + 1 }>;
/// The same in fixed point.
pub type PerJointFixed = Posed<Translating<{ (JOINTS + 1) * 40 }, Integers>, JOINTS, { JOINTS + 1 }>;
/// One model of order 40 for the whole body, behind 8 principal coordinates.
pub type WholeBody = Posed<Translating<STATES, Floats>, JOINTS, { JOINTS + 1 }>;
/// The same in fixed point.
pub type WholeBodyFixed = Posed<Translating<STATES, Integers>, JOINTS, { JOINTS + 1 }>;
/// Either form as training makes it from recorded clips, up to order 40 per joint.
pub type Recorded =
    Posed<Translating<{ (RECORDED_JOINTS + 1) * 40 }, Floats>, RECORDED_JOINTS, { RECORDED_JOINTS + 1 }>;
/// Thirty components.
pub type Restyle = Posed<Restyling<COUNT>, SHORT_JOINTS, { SHORT_JOINTS + 1 }>;
/// Limits alone.
pub type Limit = Posed<Limiting, SHORT_JOINTS, { SHORT_JOINTS + 1 }>;
/// A whole-body translator of order 40 and limits, 19 joints.
pub type Styled = Posed<Limited<STATES, Floats>, GAIT_JOINTS, { GAIT_JOINTS + 1 }>;
/// The same with the translator in fixed point.
pub type StyledFixed = Posed<Limited<STATES, Integers>, GAIT_JOINTS, { GAIT_JOINTS + 1 }>;
/// Everything, on the skeleton of `models/mechanics.kin`.
pub type Whole = Posed<Everything, { mechanics::JOINTS }, { mechanics::JOINTS + 1 }>;
