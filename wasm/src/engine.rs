//! The engines behind one interface. A new engine of core is a variant here, and a row in `host/src/view/assets/engine.js`.

use kinesic::engine::{Controls, Engine as Core};
use kinesic::mechanics::{BodyMechanics, Decoupled, MechanicsState, Modulation, mix, modulate};
use kinesic::{Components, Frame, LoadError, Pack, Pipeline, PipelineState, Pose, Rig, Skeleton, Translator};

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
    Translator(Playing<Translator<'static, ROWS, 16_384>>),
    Components(Playing<Components<'static, ROWS, 256>>),
    Mechanics { model: BodyMechanics<'static, JOINTS, 2048, 120>, states: [MechanicsState<JOINTS, 120>; 2] },
}

/// An engine between pose and pose.
struct Playing<E: Core<ROWS>> {
    pipeline: Pipeline<'static, FromFirst<E>, ROWS>,
    state: PipelineState<(E::State, bool), ROWS>,
}

impl<E: Core<ROWS>> Playing<E> {
    fn new(pack: &Pack<'static>, engine: E) -> Result<Self, LoadError> {
        Ok(Self { pipeline: Pipeline::new(Rig::load(pack)?, FromFirst(engine))?, state: PipelineState::new() })
    }

    fn reset(&mut self) {
        self.state = PipelineState::new();
    }

    fn step(
        &mut self,
        source: &HostPose,
        controls: impl Fn(&mut E::State) -> &mut Controls<ROWS>,
        strength: f32,
        mask: &Mask,
    ) -> HostPose {
        let (engine, _) = &mut self.state.engine;
        let to = controls(engine);
        to.strength = strength;
        for (joint, weight) in mask.iter().enumerate() {
            self.pipeline.rig().weigh(joint, *weight, &mut to.mask);
        }
        let mut out = Pose::identity();
        self.pipeline.step(&mut self.state, Some(source), &mut out);
        out
    }
}

/// An engine that starts from the first frame that it sees, as the host plays a clip.
struct FromFirst<E>(E);

impl<E: Core<ROWS>> Core<ROWS> for FromFirst<E> {
    type State = (E::State, bool);

    fn start(&self, (state, started): &mut Self::State, frame: &Frame<ROWS>) {
        self.0.start(state, frame);
        *started = true;
    }

    fn step(&self, state: &mut Self::State, frame: &mut Frame<ROWS>) {
        if !state.1 {
            self.start(state, frame);
        }
        self.0.step(&mut state.0, frame);
    }
}

impl Engine {
    /// The first engine of a pack that can be played.
    pub fn load(pack: &Pack<'static>) -> Result<Self, LoadError> {
        let translator = Translator::load(pack);
        let components = Components::load(pack);
        let model = match (translator, components) {
            (Ok(model), _) => Model::Translator(Playing::new(pack, model)?),
            (_, Ok(model)) => Model::Components(Playing::new(pack, model)?),
            (Err(absent @ LoadError::NoModel { .. }), Err(LoadError::NoModel { .. })) => {
                let model = BodyMechanics::load(pack).map_err(|error| match error {
                    LoadError::NoModel { .. } => absent,
                    error => error,
                })?;
                Model::Mechanics { model, states: [MechanicsState::new(); 2] }
            }
            (Err(LoadError::NoModel { .. }), Err(error)) | (Err(error), _) => return Err(error),
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
            Model::Translator(playing) => playing.reset(),
            Model::Components(playing) => playing.reset(),
            Model::Mechanics { states, .. } => *states = [MechanicsState::new(); 2],
        }
    }

    /// One frame.
    pub fn step(&mut self, source: &HostPose, strength: f32, mask: &Mask) -> HostPose {
        match &mut self.model {
            Model::Translator(playing) => playing.step(source, |state| &mut state.controls, strength, mask),
            Model::Components(playing) => playing.step(source, |state| &mut state.controls, strength, mask),
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
