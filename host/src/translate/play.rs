//! Plays a pack through the device's own code, frame by frame.

use kinesic::engine::Controls;
use kinesic::model::LoadError;
use kinesic::{Pack, Translator, TranslatorState};

use crate::clip::Clip;
use crate::rig::{HostFrame, MAX_ROWS, Rig};
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
#[derive(Clone, Debug)]
pub struct Settings {
    /// Strength and mask.
    pub controls: Controls<MAX_ROWS>,
    /// A strength that changes while the clip plays, instead of that of `controls`.
    pub curve: Option<Curve>,
    /// The clock.
    pub timing: Timing,
    /// Whether the style fades where the motion is unlike the training.
    pub fade: bool,
    /// Whether the clip begins as a live stream does, as if the body had stood before. Else it did before what it does at its beginning.
    pub live: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self { controls: Controls::default(), curve: None, timing: Timing::default(), fade: true, live: false }
    }
}

/// A clip played frame for frame.
#[derive(Clone, Debug)]
pub struct Played {
    /// The result.
    pub clip: Clip,
    /// When each frame is due by the learned timing, in frames, rising.
    pub clock: Vec<f64>,
    /// How familiar each frame is, 0 to 1; `None` for a pack that does not know.
    pub familiar: Option<Vec<f32>>,
}

impl Played {
    /// [`unfamiliar_percent`] of this clip; `None` for a pack that does not know.
    pub fn unfamiliar_percent(&self) -> Option<f64> {
        self.familiar.as_deref().map(unfamiliar_percent)
    }
}

/// Percent of the frames of which less than half of the style counts, by how familiar each is.
pub fn unfamiliar_percent(familiar: &[f32]) -> f64 {
    let strange = familiar.iter().filter(|familiar| **familiar < 0.5).count();
    100.0 * strange as f64 / familiar.len().max(1) as f64
}

/// Translates a clip on the pack's rig and at its frame rate, from the state that holding the first frame leads to.
pub fn play(pack: &Pack, rig: &Rig, source: &Clip, settings: &Settings) -> Result<Clip, LoadError> {
    let Played { clip, clock, .. } = play_on_clock(pack, rig, source, settings)?;
    Ok(match settings.timing {
        Timing::Keep => clip,
        Timing::Learned => clip.on_clock(&clock, clip.frame_time),
    })
}

/// Time of a clip by which a gate sees how it moves before it begins, s.
const BEGINNING: f64 = 2.0;

/// The frames of a clip's beginning, the last of them first.
fn beginning(rig: &Rig, source: &Clip) -> Vec<HostFrame> {
    let frames = source.frames().min((BEGINNING / source.frame_time) as usize);
    let mut frames = rig.read(&rig.poses(&source.slice(0..frames)));
    frames.reverse();
    // The first frame has no travel.
    frames.pop();
    frames
}

/// The same frame for frame, with what the learned timing and the gate say of each.
pub fn play_on_clock(pack: &Pack, rig: &Rig, source: &Clip, settings: &Settings) -> Result<Played, LoadError> {
    let translator = HostTranslator::load(pack)?;
    let mut state = Box::new(TranslatorState::new());
    (state.controls, state.fade) = (settings.controls, settings.fade);
    let mut familiar = Vec::with_capacity(source.frames());
    let mut clock = Vec::with_capacity(source.frames());
    let mut now = 0.0;
    let knobs = Knobs { controls: settings.controls, curve: settings.curve.clone() };
    let knows = translator.is_gated() && !settings.live;
    let before = if knows { beginning(rig, source) } else { Vec::new() };
    let styled = rig.play(source, |frame| {
        state.controls.strength = knobs.strength(clock.len(), source.frame_time);
        if clock.is_empty() {
            translator.start(&mut state, frame);
            before.iter().for_each(|frame| translator.watch(&mut state, frame));
        }
        let timing = translator.step(&mut state, frame);
        familiar.push(state.familiar());
        clock.push(now);
        // Strength acts on the clock as on the pose (up to `TIMING_STRENGTH`): 0 keeps it.
        let strength = state.controls.strength.clamp(-TIMING_STRENGTH, TIMING_STRENGTH);
        now += f64::from(timing.duration).powf(f64::from(strength));
    });
    Ok(Played { clip: styled, clock, familiar: translator.is_gated().then_some(familiar) })
}
