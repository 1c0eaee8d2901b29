//! The engines behind one interface. A new engine of core is a variant here, and a row in `host/src/view/assets/engine.js`.

use kinesic::components::{Components, ComponentsState};
use kinesic::mechanics::{BodyMechanics, Decoupled, MechanicsState, Modulation, mix, modulate};
use kinesic::pose::Controls;
use kinesic::{LoadError, Pack, Pose, Skeleton, Translator, TranslatorState};

use crate::JOINTS;

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
    Translator { model: Translator<'static, JOINTS, 16_384>, state: TranslatorState<JOINTS, 16_384>, started: bool },
    Components { model: Components<'static, JOINTS, 256>, state: ComponentsState<JOINTS> },
    Mechanics { model: BodyMechanics<'static, JOINTS, 2048, 120>, states: [MechanicsState<JOINTS, 120>; 2] },
}

impl Engine {
    /// The first engine of a pack that can be played.
    pub fn load(pack: &Pack<'static>) -> Result<Self, LoadError> {
        let translator = Translator::load(pack);
        let components = Components::load(pack);
        let model = match (translator, components) {
            (Ok(model), _) => Model::Translator { model, state: TranslatorState::new(), started: false },
            (_, Ok(model)) => Model::Components { model, state: ComponentsState::new() },
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
            Model::Translator { state, started, .. } => {
                *started = false;
                state.reset();
            }
            Model::Components { state, .. } => *state = ComponentsState::new(),
            Model::Mechanics { states, .. } => *states = [MechanicsState::new(); 2],
        }
    }

    /// One frame.
    pub fn step(&mut self, source: &HostPose, strength: f32, mask: &Mask) -> HostPose {
        let mut out = Pose::identity();
        match &mut self.model {
            Model::Translator { model, state, started } => {
                state.controls = Controls { strength, mask: *mask };
                if !*started {
                    model.start(state, source);
                    *started = true;
                }
                model.step(state, source, &mut out);
            }
            Model::Components { model, state } => {
                state.controls = Controls { strength, mask: *mask };
                model.step(state, source, &mut out);
            }
            Model::Mechanics { model, states: [state, _] } => {
                let mut parts = Decoupled::identity();
                model.step(state, source, &mut parts);
                modulate(source, &parts, &Modulation { amount: strength, mask: *mask }, &mut out);
            }
        }
        out
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
