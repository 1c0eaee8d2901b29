//! Emotion strength: a motion that needs no source.

use kinesic::emotion::{Emotion, EmotionState};
use kinesic::model::ATTRIBUTES;
use kinesic::rig::Drift;
use kinesic::{Frame, LoadError, Pack, Rig, Skeleton};

use crate::ROWS;
use crate::engine::HostPose;
use crate::memory::{PoseFloats, Write as _};

/// Strengths of all attributes.
pub type Strengths = [f32; ATTRIBUTES];

const KEYS: usize = 64;

type State = EmotionState<ROWS, KEYS>;

/// The emotion model at the host's capacity, what it remembers, and what it remembered at a frame that may come again.
pub struct Player {
    skeleton: Skeleton<'static>,
    rig: Rig<'static>,
    model: Emotion<'static, ROWS, KEYS, 256>,
    state: State,
    kept: State,
}

impl Player {
    /// At the first keyframe.
    pub fn load(pack: &Pack<'static>) -> Result<Self, LoadError> {
        let model = Emotion::load(pack)?;
        let (skeleton, rig) = (Skeleton::load(pack)?, Rig::load(pack)?);
        Ok(Self { skeleton, rig, model, state: State::new(), kept: State::new() })
    }

    /// The skeleton that poses have.
    pub fn skeleton(&self) -> &Skeleton<'static> {
        &self.skeleton
    }

    /// Forgets the past.
    pub fn reset(&mut self) {
        self.state.reset();
    }

    /// Remembers this frame.
    pub fn keep(&mut self) {
        self.kept = self.state;
    }

    /// Goes back to the frame that was kept.
    pub fn back(&mut self) {
        self.state = self.kept;
    }

    /// The pose of a body, or the coordinates of a machine, and the strengths that it plays; then `dt` seconds pass.
    pub fn step(&mut self, strength: &Strengths, dt: f32, to: &mut PoseFloats) -> Strengths {
        let mut frame = Frame::new();
        self.state.strength = *strength;
        self.model.step(&mut self.state, dt, &mut frame);
        if self.rig.travels() {
            let mut out: HostPose = self.rig.rest();
            self.rig.show(&frame, &frame, &mut Drift::new(), &mut out);
            out.write(to);
        } else {
            to.iter_mut().zip(frame.coordinates()).for_each(|(to, x)| *to = *x);
        }
        self.state.playing().unwrap_or_default()
    }
}
