//! Style components of a live pose: pose in, styled pose out, through the very `Components` of the product.

use kinesic::components::{Components, ComponentsState};
use kinesic::{Pack, Pose};

use crate::{Digest, Refused, Workload, pose};

/// Joints of the made body without the ends of its toes.
pub const JOINTS: usize = 23;
/// Components.
pub const COUNT: usize = 30;

/// `Components::step` with room for `JOINTS` joints and `COUNT` components.
#[derive(Clone, Copy, Debug)]
pub struct Restyle;

/// RAM of components and their caller: the state, the pose that comes in and the pose that goes out.
#[derive(Clone, Debug)]
pub struct Running {
    state: ComponentsState<JOINTS>,
    source: Pose<JOINTS>,
    styled: Pose<JOINTS>,
}

/// Takes an input frame as [`pose::load`] does.
impl Workload for Restyle {
    type Model<'p> = Components<'p, JOINTS, COUNT>;
    type State = Running;

    fn open(pack: &[u8]) -> Result<Self::Model<'_>, Refused> {
        let pack = Pack::load(pack).map_err(|_| Refused)?;
        Components::load(&pack).map_err(|_| Refused)
    }

    fn power_on(_: &Self::Model<'_>) -> Self::State {
        Running { state: ComponentsState::new(), source: Pose::identity(), styled: Pose::identity() }
    }

    fn load(_: &Self::Model<'_>, running: &mut Self::State, input: &[u8]) {
        pose::load(&mut running.source, input);
    }

    #[inline(always)]
    fn step(model: &Self::Model<'_>, running: &mut Self::State) {
        model.step(&mut running.state, &running.source, &mut running.styled);
    }

    fn output(_: &Self::Model<'_>, running: &Self::State, digest: &mut Digest) {
        pose::output(&running.styled, digest);
    }
}
