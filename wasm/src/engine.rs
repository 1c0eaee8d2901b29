//! The engines behind one interface: what restyles frames, and body mechanics.

use kinesic::engine::live::{self, Live, LiveState};
use kinesic::engine::{Engine as Core, FromPack};
use kinesic::mechanics::{BodyMechanics, Decoupled, MechanicsState, Modulation, mix, modulate};
use kinesic::{Frame, LoadError, Pack, Pipeline, PipelineState, Pose, Rig, Skeleton};

use crate::{JOINTS, ROWS};

/// A pose at the page's capacity.
pub type HostPose = Pose<JOINTS>;

type Mask = [f32; JOINTS];

/// A model with what it remembers.
pub struct Engine {
    skeleton: Skeleton<'static>,
    model: Model,
}

#[allow(clippy::large_enum_variant, reason = "there is one, in static memory")]
enum Model {
    Live { pipeline: Pipeline<'static, FromFirst, ROWS>, state: PipelineState<RestylingState, ROWS> },
    Mechanics { model: BodyMechanics<'static, JOINTS, 2048, 120>, states: [MechanicsState<JOINTS, 120>; 2] },
}

type RestylingState = (LiveState<ROWS, 16_384>, bool);

/// An engine that starts from the first frame that it sees, as the host plays a clip.
struct FromFirst(Live<'static, ROWS, 16_384, 256>);

impl Core<ROWS> for FromFirst {
    type State = RestylingState;

    fn start(&self, (state, started): &mut Self::State, frame: &Frame<ROWS>) {
        live::start_each(&self.0, state, frame);
        *started = true;
    }

    fn step(&self, state: &mut Self::State, frame: &mut Frame<ROWS>) {
        let is_first = !state.1;
        if is_first {
            self.start(state, frame);
        }
        let (translator, components, limiter) = &self.0;
        let (translator_state, components_state, limiter_state) = &mut state.0;
        translator.step(translator_state, frame);
        components.step(components_state, frame);
        // Limits begin where the styled motion does, as `kinesic apply` has it.
        if is_first {
            limiter.start(limiter_state, frame);
        }
        limiter.step(limiter_state, frame);
    }
}

impl Engine {
    /// The first engine of a pack that can be played; of a machine with its limits behind it.
    pub fn load(pack: &Pack<'static>) -> Result<Self, LoadError> {
        let (mut engine, rig) = (Live::from_pack(pack)?, Rig::load(pack)?);
        let limiter = engine.2.take().filter(|_| !rig.travels());
        let model = if live::keep_first(&mut engine) {
            engine.2 = limiter;
            Model::Live { pipeline: Pipeline::new(rig, FromFirst(engine))?, state: PipelineState::new() }
        } else {
            Model::Mechanics { model: BodyMechanics::load(pack)?, states: [MechanicsState::new(); 2] }
        };
        Ok(Self { skeleton: Skeleton::load(pack)?, model })
    }

    /// The skeleton that poses have.
    pub fn skeleton(&self) -> &Skeleton<'static> {
        &self.skeleton
    }

    /// Forgets the past.
    pub fn reset(&mut self) {
        match &mut self.model {
            Model::Live { state, .. } => *state = PipelineState::new(),
            Model::Mechanics { states, .. } => *states = [MechanicsState::new(); 2],
        }
    }

    /// True for a machine that stands: its frames are coordinates, not poses.
    pub fn stands(&self) -> bool {
        matches!(&self.model, Model::Live { pipeline, .. } if !pipeline.rig().travels())
    }

    /// One frame of a machine: coordinates in, coordinates out.
    pub fn step_coordinates(&mut self, source: &[f32], strength: f32, mask: &Mask, out: &mut [f32]) {
        if let Model::Live { pipeline, state } = &mut self.model {
            control(pipeline.rig(), state, strength, mask);
            pipeline.step_coordinates(state, Some(source), out);
        }
    }

    /// One frame.
    pub fn step(&mut self, source: &HostPose, strength: f32, mask: &Mask) -> HostPose {
        match &mut self.model {
            Model::Live { pipeline, state } => {
                control(pipeline.rig(), state, strength, mask);
                let mut out = Pose::identity();
                pipeline.step(state, Some(source), &mut out);
                out
            }
            Model::Mechanics { model, states: [state, _] } => {
                let (mut parts, mut out) = (Decoupled::identity(), Pose::identity());
                model.step(state, source, &mut parts);
                modulate(source, &parts, &Modulation { amount: strength, mask: *mask }, &mut out);
                out
            }
        }
    }

    /// One frame of body mechanics with another's expression.
    pub fn mix(&mut self, source: &HostPose, other: &HostPose, amount: f32, mask: &Mask) -> HostPose {
        let Model::Mechanics { model, states: [state, state_of_other] } = &mut self.model else {
            return self.step(source, amount, mask);
        };
        let (mut parts, mut expressive, mut out) = (Decoupled::identity(), Decoupled::identity(), Pose::identity());
        model.step(state, source, &mut parts);
        model.step(state_of_other, other, &mut expressive);
        mix(&parts, &expressive, &Modulation { amount, mask: *mask }, &mut out);
        out
    }
}

/// Strength and mask of whatever restyles.
fn control(rig: &Rig, state: &mut PipelineState<RestylingState, ROWS>, strength: f32, mask: &Mask) {
    for controls in live::controls(&mut state.engine.0) {
        controls.strength = strength;
        mask.iter().enumerate().for_each(|(joint, weight)| rig.weigh(joint, *weight, &mut controls.mask));
    }
}
