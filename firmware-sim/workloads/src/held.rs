//! Engines between pose and pose, and feet held where they stand.

use core::marker::PhantomData;

use kinesic::{Feet, FeetState, Pack, Pipeline, Pose};

use crate::posed::{Composition, GAIT_JOINTS, Limited, Posed, Running, STATES};
use crate::{Digest, Floats, Refused, Workload, pose};

/// A composition on poses of `JOINTS` joints, then feet.
#[derive(Clone, Copy, Debug)]
pub struct Held<C, const JOINTS: usize, const ROWS: usize>(PhantomData<C>);

impl<C: Composition<ROWS>, const JOINTS: usize, const ROWS: usize> Workload for Held<C, JOINTS, ROWS> {
    type Model<'p> = (Pipeline<'p, C::Engine<'p>, ROWS>, Feet<'p>);
    type State = (Running<C::State, JOINTS, ROWS>, FeetState, Pose<JOINTS>);

    fn open(pack: &[u8]) -> Result<Self::Model<'_>, Refused> {
        let pipeline = Posed::<C, JOINTS, ROWS>::open(pack)?;
        let feet = Pack::load(pack).and_then(|pack| Feet::load(&pack)).map_err(|_| Refused)?;
        Ok((pipeline, feet))
    }

    fn power_on((pipeline, _): &Self::Model<'_>) -> Self::State {
        (Posed::<C, JOINTS, ROWS>::power_on(pipeline), FeetState::new(), Pose::identity())
    }

    fn load((pipeline, _): &Self::Model<'_>, (running, ..): &mut Self::State, input: &[u8]) {
        Posed::<C, JOINTS, ROWS>::load(pipeline, running, input);
    }

    #[inline(always)]
    fn step((pipeline, feet): &Self::Model<'_>, (running, state, out): &mut Self::State) {
        Posed::<C, JOINTS, ROWS>::step(pipeline, running);
        *out = running.out;
        feet.step(state, Some(&running.source), out);
    }

    fn output(_: &Self::Model<'_>, (_, _, out): &Self::State, digest: &mut Digest) {
        pose::output(out, digest);
    }
}

/// A whole-body translator of order 40 and limits, 19 joints, and feet.
pub type StyledFeet = Held<Limited<STATES, Floats>, GAIT_JOINTS, { GAIT_JOINTS + 1 }>;
