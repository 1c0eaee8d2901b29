//! Joint limits of a pose: pose in, pose within the limits out, through the very `Limiter` of the product.

use kinesic::limit::{LimitState, Limiter};
use kinesic::{Pack, Pose};

use crate::{Digest, Refused, Workload, pose};

/// Joints of the made body without the ends of its toes.
pub const JOINTS: usize = 23;

/// `Limiter::step` with room for `JOINTS` joints.
#[derive(Clone, Copy, Debug)]
pub struct Limit;

/// RAM of the limiter and its caller: the state, the pose that comes in and the pose that goes out.
#[derive(Clone, Debug)]
pub struct Running {
    state: LimitState<JOINTS>,
    source: Pose<JOINTS>,
    limited: Pose<JOINTS>,
}

/// Takes an input frame as [`pose::load`] does.
impl Workload for Limit {
    type Model<'p> = Limiter<'p, JOINTS>;
    type State = Running;

    fn open(pack: &[u8]) -> Result<Self::Model<'_>, Refused> {
        let pack = Pack::load(pack).map_err(|_| Refused)?;
        Limiter::load(&pack).map_err(|_| Refused)
    }

    fn power_on(_: &Self::Model<'_>) -> Self::State {
        Running { state: LimitState::new(), source: Pose::identity(), limited: Pose::identity() }
    }

    fn load(_: &Self::Model<'_>, running: &mut Self::State, input: &[u8]) {
        pose::load(&mut running.source, input);
    }

    #[inline(always)]
    fn step(model: &Self::Model<'_>, running: &mut Self::State) {
        model.step(&mut running.state, Some(&running.source), &mut running.limited);
    }

    fn output(_: &Self::Model<'_>, running: &Self::State, digest: &mut Digest) {
        pose::output(&running.limited, digest);
    }
}
