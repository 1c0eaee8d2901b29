//! What a running pipeline remembers, and what its user may turn.

use nalgebra::Vector3;

use super::Weights;
use crate::components::ComponentsState;
use crate::emotion::EmotionState;
use crate::limit::{LimitReport, LimitState};
use crate::mechanics::{MechanicsState, Modulation};
use crate::translate::TranslatorState;

/// The states of all stages. Controls may change at any frame.
#[derive(Clone, Debug)]
pub struct PipelineState<const JOINTS: usize, const STATES: usize, const WINDOW: usize, const KEYS: usize> {
    /// Style translation; its `controls` are the user's.
    pub translate: TranslatorState<JOINTS, STATES>,
    pub(super) mechanics: MechanicsState<JOINTS, WINDOW>,
    /// How much expression body mechanics leave or add.
    pub modulation: Modulation<JOINTS>,
    /// Style components; their `controls` are the user's.
    pub components: ComponentsState<JOINTS>,
    /// The motion that plays at an emotion's strength; its `strength` is the user's.
    pub emotion: EmotionState<JOINTS, KEYS>,
    /// How much each stream counts.
    pub weights: Weights,
    pub(super) limit: LimitState<JOINTS>,
    pub(super) engine_faults: u32,
    /// Root of the last sound source frame.
    pub(super) last_root: Vector3<f32>,
}

impl<const JOINTS: usize, const STATES: usize, const WINDOW: usize, const KEYS: usize>
    PipelineState<JOINTS, STATES, WINDOW, KEYS>
{
    /// Everything at rest, full strength, expression as observed.
    pub fn new() -> Self {
        Self {
            translate: TranslatorState::new(),
            mechanics: MechanicsState::new(),
            modulation: Modulation::default(),
            components: ComponentsState::new(),
            emotion: EmotionState::new(),
            weights: Weights::default(),
            limit: LimitState::new(),
            engine_faults: 0,
            last_root: Vector3::zeros(),
        }
    }

    /// To be called before the first step with another pipeline of the same skeleton: engines forget, the limiter goes on from
    /// where the joints are and how fast they move.
    pub fn change_model(&mut self) {
        self.translate.reset();
        self.mechanics = MechanicsState::new();
        self.components.reset();
        self.emotion.reset();
    }

    /// The last stage: pose, servo angles, report.
    pub fn limit(&self) -> &LimitState<JOINTS> {
        &self.limit
    }

    /// What happened to the last frame, and to all of them.
    pub fn report(&self) -> &LimitReport {
        self.limit.report()
    }

    /// How often an engine gave a pose that was not sound and was reset.
    pub fn engine_faults(&self) -> u32 {
        self.engine_faults
    }
}

impl<const JOINTS: usize, const STATES: usize, const WINDOW: usize, const KEYS: usize> Default
    for PipelineState<JOINTS, STATES, WINDOW, KEYS>
{
    fn default() -> Self {
        Self::new()
    }
}
