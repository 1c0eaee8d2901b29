//! Body mechanics of a pose: features, network, decoupling, through the very `BodyMechanics` of the product.

use core::marker::PhantomData;

use kinesic::mechanics::{BodyMechanics, Decoupled, MechanicsState};
use kinesic::model::Numbers;
use kinesic::{Pack, Pose};

use crate::{Digest, Refused, Workload, pose};

/// Joints of the repository's own model.
pub const JOINTS: usize = 31;
/// Units of its hidden layer and its code: 100 and 50, rounded up to 4 each.
pub const UNITS: usize = 152;
/// Units of the network 100-300 of the paper.
pub const PAPER_UNITS: usize = 400;
/// A third of a second at 60 frames a second.
pub const WINDOW: usize = 20;

/// `BodyMechanics::step` with the capacities of `models/mechanics.kin`, in the number types `N`.
#[derive(Clone, Copy, Debug)]
pub struct Mechanics<N>(PhantomData<N>);

/// Features and network alone, without decoupling, at the size of Boehs 2017: 100 units, then a code of 300.
#[derive(Clone, Copy, Debug)]
pub struct Network<N>(PhantomData<N>);

/// RAM of body mechanics and its caller: the state, the pose that comes in and the parts that go out.
#[derive(Clone, Debug)]
pub struct Running {
    state: MechanicsState<JOINTS, WINDOW>,
    observed: Pose<JOINTS>,
    parts: Decoupled<JOINTS>,
}

/// Takes an input frame as [`pose::load`] does.
impl<N: Numbers> Workload for Mechanics<N> {
    type Model<'p> = BodyMechanics<'p, JOINTS, UNITS, WINDOW, N>;
    type State = Running;

    fn open(pack: &[u8]) -> Result<Self::Model<'_>, Refused> {
        let pack = Pack::load(pack).map_err(|_| Refused)?;
        BodyMechanics::load_numbers(&pack).map_err(|_| Refused)
    }

    fn power_on(_: &Self::Model<'_>) -> Self::State {
        Running { state: MechanicsState::new(), observed: Pose::identity(), parts: Decoupled::identity() }
    }

    fn load(_: &Self::Model<'_>, running: &mut Self::State, input: &[u8]) {
        pose::load(&mut running.observed, input);
    }

    #[inline(always)]
    fn step(model: &Self::Model<'_>, running: &mut Self::State) {
        model.step(&mut running.state, &running.observed, &mut running.parts);
    }

    fn output(_: &Self::Model<'_>, running: &Self::State, digest: &mut Digest) {
        running.state.features().iter().for_each(|value| digest.float(*value));
        pose::output(&running.parts.mechanics, digest);
        for rotation in &running.parts.expressive {
            rotation.coords.iter().for_each(|value| digest.float(*value));
        }
        running.parts.activity.iter().for_each(|value| digest.float(*value));
    }
}

impl<N: Numbers> Workload for Network<N> {
    type Model<'p> = BodyMechanics<'p, JOINTS, PAPER_UNITS, WINDOW, N>;
    type State = Running;

    fn open(pack: &[u8]) -> Result<Self::Model<'_>, Refused> {
        let pack = Pack::load(pack).map_err(|_| Refused)?;
        BodyMechanics::load_numbers(&pack).map_err(|_| Refused)
    }

    fn power_on(_: &Self::Model<'_>) -> Self::State {
        Running { state: MechanicsState::new(), observed: Pose::identity(), parts: Decoupled::identity() }
    }

    fn load(_: &Self::Model<'_>, running: &mut Self::State, input: &[u8]) {
        pose::load(&mut running.observed, input);
    }

    #[inline(always)]
    fn step(model: &Self::Model<'_>, running: &mut Self::State) {
        model.features().step(&mut running.state, &running.observed);
        model.predict(running.state.features(), running.state.pose(), &mut running.parts.mechanics);
    }

    fn output(_: &Self::Model<'_>, running: &Self::State, digest: &mut Digest) {
        running.state.features().iter().for_each(|value| digest.float(*value));
        pose::output(&running.parts.mechanics, digest);
    }
}
