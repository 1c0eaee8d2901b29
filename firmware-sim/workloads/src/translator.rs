//! Style translation of a body: pose in, styled pose out, through the very `Translator` of the product.

use core::marker::PhantomData;

use kinesic::model::{Floats, Integers, Numbers};
use kinesic::{Pack, Pose, Translator, TranslatorState};

use crate::{Digest, Refused, Workload, pose};

/// Joints of the made body.
pub const JOINTS: usize = 25;
/// Joints of the recorded body.
pub const RECORDED_JOINTS: usize = 31;

/// The paper's form: one model of order 40 a joint.
pub type PerJoint = Translate<JOINTS, { JOINTS * 40 }, Floats>;
/// The same in fixed point.
pub type PerJointFixed = Translate<JOINTS, { JOINTS * 40 }, Integers>;
/// One model of order 40 for the whole body, behind up to 8 principal coordinates.
pub type WholeBody = Translate<JOINTS, 48, Floats>;
/// The same in fixed point.
pub type WholeBodyFixed = Translate<JOINTS, 48, Integers>;
/// Either form as training makes it from recorded clips, up to order 40 a joint.
pub type Recorded = Translate<RECORDED_JOINTS, { RECORDED_JOINTS * 40 }, Floats>;

/// A translator with room for `JOINTS` joints and `STATES` filter states, in the number types `N`.
#[derive(Clone, Copy, Debug)]
pub struct Translate<const JOINTS: usize, const STATES: usize, N>(PhantomData<N>);

/// RAM of a translator and its caller: the state, the pose that comes in and the pose that goes out.
#[derive(Clone, Debug)]
pub struct Running<const JOINTS: usize, const STATES: usize> {
    state: TranslatorState<JOINTS, STATES>,
    source: Pose<JOINTS>,
    styled: Pose<JOINTS>,
    duration: f32,
}

/// Takes an input frame as [`pose::load`] does.
impl<const JOINTS: usize, const STATES: usize, N: Numbers> Workload for Translate<JOINTS, STATES, N> {
    type Model<'p> = Translator<'p, JOINTS, STATES, N>;
    type State = Running<JOINTS, STATES>;

    fn open(pack: &[u8]) -> Result<Self::Model<'_>, Refused> {
        let pack = Pack::load(pack).map_err(|_| Refused)?;
        Translator::load_numbers(&pack).map_err(|_| Refused)
    }

    fn power_on(_: &Self::Model<'_>) -> Self::State {
        Running { state: TranslatorState::new(), source: Pose::identity(), styled: Pose::identity(), duration: 1.0 }
    }

    fn load(_: &Self::Model<'_>, running: &mut Self::State, input: &[u8]) {
        pose::load(&mut running.source, input);
    }

    #[inline(always)]
    fn step(model: &Self::Model<'_>, running: &mut Self::State) {
        let timing = model.step(&mut running.state, &running.source, &mut running.styled);
        running.duration = timing.duration;
    }

    fn output(_: &Self::Model<'_>, running: &Self::State, digest: &mut Digest) {
        pose::output(&running.styled, digest);
        digest.float(running.duration);
    }
}
