//! One frame through all stages.

use super::{Mix, Pipeline, PipelineState};
use crate::mechanics::{Decoupled, MechanicsState, modulate};
use crate::pose::Pose;

impl<
    const JOINTS: usize,
    const STATES: usize,
    const UNITS: usize,
    const WINDOW: usize,
    const COUNT: usize,
    const KEYS: usize,
> Pipeline<'_, JOINTS, STATES, UNITS, WINDOW, COUNT, KEYS>
{
    /// Puts the state where the robot is, see [`Limiter::start`](crate::Limiter::start), and the translator's filters where they
    /// would be had it always stood there; the emotion gets its strength. A pose that is not sound is ignored.
    pub fn start(&self, state: &mut PipelineState<JOINTS, STATES, WINDOW, KEYS>, pose: &Pose<JOINTS>) {
        state.change_model();
        self.limit.start(&mut state.limit, pose);
        self.change_strength(state);
        if let (Some(engine), true) = (&self.translate, pose.is_sound(self.limit.joints())) {
            engine.start(&mut state.translate, pose);
        }
    }

    /// Brings the emotion to `state.emotion.strength`, so that no frame has to: see [`Emotion::change`](crate::Emotion::change).
    pub fn change_strength(&self, state: &mut PipelineState<JOINTS, STATES, WINDOW, KEYS>) {
        if let Some(engine) = &self.emotion {
            engine.change(&mut state.emotion);
        }
    }

    /// One frame: `frame` in, or `None` where none came; a pose within the limits out. Infallible. Cost: the stages'.
    pub fn step(
        &self,
        state: &mut PipelineState<JOINTS, STATES, WINDOW, KEYS>,
        frame: Option<&Pose<JOINTS>>,
        out: &mut Pose<JOINTS>,
    ) {
        match self.limit.check(&mut state.limit, frame) {
            Ok(source) => {
                // What the root did while no frame came, or in a leap, would be a kick to the filters.
                let travel = source.root - state.last_root;
                if state.report().gap > 0 || travel.dot(&travel) > self.leap * self.leap {
                    state.translate.rebase(source.root);
                }
                state.last_root = source.root;
                let mixed = self.mix(state, source);
                self.limit.advance(&mut state.limit, Ok(&mixed), out);
            }
            Err(fault) => {
                if let Some(engine) = &self.emotion {
                    // It needs no frame, and its clock runs on.
                    engine.advance(&mut state.emotion, self.limit.frame_time());
                }
                self.limit.advance(&mut state.limit, Err(fault), out);
            }
        }
    }

    /// What the engines make of a sound frame.
    fn mix(&self, state: &mut PipelineState<JOINTS, STATES, WINDOW, KEYS>, source: &Pose<JOINTS>) -> Pose<JOINTS> {
        let mut mix = Mix::new(source, state.weights.source);
        let mut pose = *source;
        if let Some(engine) = &self.mechanics {
            let mut parts = Decoupled::identity();
            engine.step(&mut state.mechanics, source, &mut parts);
            modulate(source, &parts, &state.modulation, &mut pose);
            if self.sound(&pose, &mut state.engine_faults) {
                mix.add(&pose, state.weights.mechanics);
            } else {
                state.mechanics = MechanicsState::new();
            }
        }
        if let Some(engine) = &self.translate {
            engine.step(&mut state.translate, source, &mut pose);
            if self.sound(&pose, &mut state.engine_faults) {
                mix.add(&pose, state.weights.translate);
            } else {
                state.translate.reset();
            }
        }
        if let Some(engine) = &self.components {
            engine.step(&mut state.components, source, &mut pose);
            if self.sound(&pose, &mut state.engine_faults) {
                mix.add(&pose, state.weights.components);
            } else {
                state.components.reset();
            }
        }
        if let Some(engine) = &self.emotion {
            engine.step(&mut state.emotion, self.limit.frame_time(), &mut pose);
            if self.sound(&pose, &mut state.engine_faults) {
                mix.add(&pose, state.weights.emotion);
            } else {
                state.emotion.reset();
            }
        }
        *mix.pose()
    }

    fn sound(&self, pose: &Pose<JOINTS>, faults: &mut u32) -> bool {
        let sound = pose.is_sound(self.limit.joints());
        *faults = faults.saturating_add(u32::from(!sound));
        sound
    }
}
