//! An emotion among other engines: it makes its own motion.

use nalgebra::Vector3;

use super::{Emotion, EmotionState, Place};
use crate::engine::{Engine, FromPack};
use crate::model::{LoadError, Pack};
use crate::rig::Frame;

/// The source's coordinates are not looked at: the motion begins where the source stands, at the pack's frame rate. Frames that
/// do not come stop nothing.
impl<const ROWS: usize, const KEYS: usize, const WIDTH: usize> Engine<ROWS> for Emotion<'_, ROWS, KEYS, WIDTH> {
    type State = EmotionState<ROWS, KEYS>;

    fn start(&self, state: &mut Self::State, frame: &Frame<ROWS>) {
        state.reset();
        if frame.is_sound() {
            let [x, z] = frame.ground;
            state.put(Place { ground: Vector3::new(x, 0.0, z), heading: frame.heading });
        }
        self.change(state);
    }

    fn step(&self, state: &mut Self::State, frame: &mut Frame<ROWS>) {
        if state.playing().is_none() {
            Engine::start(self, state, frame);
        }
        // Travel says where the body goes; the ground of a frame is the source's, and no place to stay near.
        let ground = frame.ground;
        frame.reach = f32::INFINITY;
        state.come_along();
        Emotion::step(self, state, self.dt, frame);
        frame.ground = ground;
    }

    fn idle(&self, state: &mut Self::State, frame: &mut Frame<ROWS>) {
        Engine::step(self, state, frame);
    }
}

impl<'a, const ROWS: usize, const KEYS: usize, const WIDTH: usize> FromPack<'a> for Emotion<'a, ROWS, KEYS, WIDTH> {
    fn from_pack(pack: &Pack<'a>) -> Result<Self, LoadError> {
        Self::load(pack)
    }
}
