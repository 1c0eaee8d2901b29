//! Plays a pack through the device's own code, frame by frame.

use kinesic::engine::Controls;
use kinesic::model::LoadError;
use kinesic::{Pack, Translator, TranslatorState};

use crate::clip::Clip;
use crate::rig::{MAX_ROWS, Rig};
use crate::strength::{Curve, Knobs};

/// Filter states that the host steps.
const MAX_STATES: usize = 16_384;

/// The device's translator at the host's capacity.
pub type HostTranslator<'a> = Translator<'a, MAX_ROWS, MAX_STATES>;

/// Strengths up to which the learned timing is carried on, either way: beyond, a clip could last for ever.
pub const TIMING_STRENGTH: f32 = 4.0;

/// Whether the style may change the clock.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Timing {
    /// Frame for frame, as on a live stream.
    #[default]
    Keep,
    /// Stretched and squeezed as learned from the training pairs; for whole clips only.
    Learned,
}

/// How a pack is played.
#[derive(Clone, Debug, Default)]
pub struct Settings {
    /// Strength and mask.
    pub controls: Controls<MAX_ROWS>,
    /// A strength that changes while the clip plays, instead of that of `controls`.
    pub curve: Option<Curve>,
    /// The clock.
    pub timing: Timing,
}

/// Translates a clip on the pack's rig and at its frame rate, from the state that holding the first frame leads to.
pub fn play(pack: &Pack, rig: &Rig, source: &Clip, settings: &Settings) -> Result<Clip, LoadError> {
    let (styled, clock) = play_on_clock(pack, rig, source, settings)?;
    Ok(match settings.timing {
        Timing::Keep => styled,
        Timing::Learned => styled.on_clock(&clock, styled.frame_time),
    })
}

/// The clip frame for frame, and when each frame is due by the learned timing, in frames, rising.
pub fn play_on_clock(
    pack: &Pack,
    rig: &Rig,
    source: &Clip,
    settings: &Settings,
) -> Result<(Clip, Vec<f64>), LoadError> {
    let translator = HostTranslator::load(pack)?;
    let mut state = Box::new(TranslatorState::new());
    state.controls = settings.controls;
    let mut clock = Vec::with_capacity(source.frames());
    let mut now = 0.0;
    let knobs = Knobs { controls: settings.controls, curve: settings.curve.clone() };
    let styled = rig.play(source, |frame| {
        state.controls.strength = knobs.strength(clock.len(), source.frame_time);
        if clock.is_empty() {
            translator.start(&mut state, frame);
        }
        let timing = translator.step(&mut state, frame);
        clock.push(now);
        // Strength acts on the clock as on the pose (up to `TIMING_STRENGTH`): 0 keeps it.
        let strength = state.controls.strength.clamp(-TIMING_STRENGTH, TIMING_STRENGTH);
        now += f64::from(timing.duration).powf(f64::from(strength));
    });
    Ok((styled, clock))
}
