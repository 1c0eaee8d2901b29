//! The stages: checked, immutable views.

use crate::components::Components;
use crate::emotion::Emotion;
use crate::limit::Limiter;
use crate::mechanics::BodyMechanics;
use crate::model::{LoadError, Pack};
use crate::translate::Translator;

/// Roots that go this many times as far in a frame as the limits let them have leapt.
const LEAP: f32 = 4.0;

/// Engines, mix and limits. Capacities of an engine that is not used may be 0.
///
/// `STATES` is the translator's, `UNITS` and `WINDOW` those of body mechanics, `COUNT` the components of style components and of
/// a keyframe (the emotion's `WIDTH`), `KEYS` the emotion's.
#[derive(Clone, Copy, Debug)]
pub struct Pipeline<
    'a,
    const JOINTS: usize,
    const STATES: usize,
    const UNITS: usize,
    const WINDOW: usize,
    const COUNT: usize,
    const KEYS: usize,
> {
    pub(super) translate: Option<Translator<'a, JOINTS, STATES>>,
    pub(super) mechanics: Option<BodyMechanics<'a, JOINTS, UNITS, WINDOW>>,
    pub(super) components: Option<Components<'a, JOINTS, COUNT>>,
    pub(super) emotion: Option<Emotion<'a, JOINTS, KEYS, COUNT>>,
    pub(super) limit: Limiter<'a, JOINTS>,
    /// Travel of the root in a frame, m, that is no motion.
    pub(super) leap: f32,
}

impl<
    'a,
    const JOINTS: usize,
    const STATES: usize,
    const UNITS: usize,
    const WINDOW: usize,
    const COUNT: usize,
    const KEYS: usize,
> Pipeline<'a, JOINTS, STATES, UNITS, WINDOW, COUNT, KEYS>
{
    /// Limits alone: the source passes as far as they allow.
    pub fn new(limit: Limiter<'a, JOINTS>) -> Self {
        let leap = LEAP * limit.root_step();
        Self { translate: None, mechanics: None, components: None, emotion: None, limit, leap }
    }

    /// Adds style translation. An engine for another number of joints than the limits have is refused.
    pub fn with_translator(mut self, engine: Translator<'a, JOINTS, STATES>) -> Result<Self, LoadError> {
        self.same_joints(engine.skeleton().joints())?;
        self.translate = Some(engine);
        Ok(self)
    }

    /// Adds body mechanics, whose expression the state's `modulation` scales.
    pub fn with_mechanics(mut self, engine: BodyMechanics<'a, JOINTS, UNITS, WINDOW>) -> Result<Self, LoadError> {
        self.same_joints(engine.features().skeleton().joints())?;
        self.mechanics = Some(engine);
        Ok(self)
    }

    /// Adds style components.
    pub fn with_components(mut self, engine: Components<'a, JOINTS, COUNT>) -> Result<Self, LoadError> {
        self.same_joints(engine.skeleton().joints())?;
        self.components = Some(engine);
        Ok(self)
    }

    /// Adds a motion that plays at an emotion's strength; its weight is 0 until somebody gives it one.
    pub fn with_emotion(mut self, engine: Emotion<'a, JOINTS, KEYS, COUNT>) -> Result<Self, LoadError> {
        self.same_joints(engine.skeleton().joints())?;
        self.emotion = Some(engine);
        Ok(self)
    }

    /// Everything that a style pack holds. The limits must be there; an engine that is there must fit.
    pub fn load(pack: &Pack<'a>) -> Result<Self, LoadError> {
        let mut pipeline = Self::new(Limiter::load(pack)?);
        let models = pack.metadata().models;
        if models.iter().any(|model| model.translator().is_some()) {
            pipeline = pipeline.with_translator(Translator::load(pack)?)?;
        }
        if models.iter().any(|model| model.mechanics().is_some()) {
            pipeline = pipeline.with_mechanics(BodyMechanics::load(pack)?)?;
        }
        if models.iter().any(|model| model.components().is_some()) {
            pipeline = pipeline.with_components(Components::load(pack)?)?;
        }
        if models.iter().any(|model| model.emotion().is_some()) {
            pipeline = pipeline.with_emotion(Emotion::load(pack)?)?;
        }
        Ok(pipeline)
    }

    /// The last stage.
    pub fn limiter(&self) -> &Limiter<'a, JOINTS> {
        &self.limit
    }

    fn same_joints(&self, found: usize) -> Result<(), LoadError> {
        let expected = self.limit.joints();
        let shape = LoadError::Shape { tensor: "skeleton/parents", found, expected };
        if found == expected { Ok(()) } else { Err(shape) }
    }
}
