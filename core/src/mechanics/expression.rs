//! Body mechanics as an engine: more or less expression, frame by frame.

use super::{BodyMechanics, Decoupled, MechanicsState, Modulation, modulate};
use crate::engine::{Engine, FromPack};
use crate::model::{AnyNumbers, LoadError, Numbers, Pack};
use crate::pose::Pose;
use crate::rig::{Drift, Frame, Rig};

/// Body mechanics between frames: scales what a motion adds to what the body must do.
///
/// The network speaks of rotations and contacts of positions, so the frame becomes a pose on the way in and coordinates again on the way
/// out. Put it before engines that work on coordinates alone.
#[derive(Clone, Copy, Debug)]
pub struct Expression<'a, const JOINTS: usize, const UNITS: usize, const WINDOW: usize, N = AnyNumbers> {
    rig: Rig<'a>,
    /// The network.
    pub mechanics: BodyMechanics<'a, JOINTS, UNITS, WINDOW, N>,
}

/// What a running [`Expression`] remembers, and what its user may turn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExpressionState<const JOINTS: usize, const WINDOW: usize> {
    mechanics: MechanicsState<JOINTS, WINDOW>,
    /// How much expression is left or added; it may change at any frame.
    pub modulation: Modulation<JOINTS>,
}

impl<const JOINTS: usize, const WINDOW: usize> ExpressionState<JOINTS, WINDOW> {
    /// Nothing seen yet, expression as observed.
    pub fn new() -> Self {
        Self { mechanics: MechanicsState::new(), modulation: Modulation::default() }
    }
}

impl<const JOINTS: usize, const WINDOW: usize> Default for ExpressionState<JOINTS, WINDOW> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const ROWS: usize, const JOINTS: usize, const UNITS: usize, const WINDOW: usize, N: Numbers> Engine<ROWS>
    for Expression<'_, JOINTS, UNITS, WINDOW, N>
{
    type State = ExpressionState<JOINTS, WINDOW>;

    fn start(&self, state: &mut Self::State, _: &Frame<ROWS>) {
        state.mechanics = MechanicsState::new();
    }

    /// Cost: the network, and about 200 multiply-adds per joint.
    fn step(&self, state: &mut Self::State, frame: &mut Frame<ROWS>) {
        if !frame.is_sound() {
            return;
        }
        let (mut observed, mut out) = (Pose::<JOINTS>::identity(), Pose::identity());
        self.rig.show(frame, frame, &mut Drift::new(), &mut observed);
        let mut parts = Decoupled::identity();
        self.mechanics.step(&mut state.mechanics, &observed, &mut parts);
        modulate(&observed, &parts, &state.modulation, &mut out);
        let mut styled = *frame;
        self.rig.read(&out, &mut styled);
        if !styled.is_sound() {
            state.mechanics = MechanicsState::new();
            return;
        }
        // Root and hips are the observed ones.
        let root = if self.rig.travels() { 6 } else { 0 };
        let coordinates = frame.coordinates_mut().iter_mut().zip(styled.coordinates());
        coordinates.skip(root).for_each(|(to, from)| *to = *from);
    }
}

impl<'a, const JOINTS: usize, const UNITS: usize, const WINDOW: usize, N: Numbers> FromPack<'a>
    for Expression<'a, JOINTS, UNITS, WINDOW, N>
{
    fn from_pack(pack: &Pack<'a>) -> Result<Self, LoadError> {
        Ok(Self { rig: Rig::load(pack)?, mechanics: BodyMechanics::load_numbers(pack)? })
    }
}
