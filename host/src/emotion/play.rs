//! Plays an emotion model through the device's own code, frame by frame.

use kinesic::emotion::EmotionState;
use kinesic::model::ATTRIBUTES;
use kinesic::rig::Drift;
use kinesic::{Pack, Pose, Rig as DeviceRig};

use super::model::{HostEmotion, MAX_KEYS};
use crate::clip::Clip;
use crate::rig::{HostFrame, MAX_JOINTS, MAX_ROWS, Rig, RigError};

/// Rounds of a cycle that are played where nobody says how long.
const ROUNDS: f32 = 3.0;
/// Frames that are played at most, a day at 60 frames a second.
const MOST_FRAMES: f64 = 24.0 * 3600.0 * 60.0;

/// Strengths of all attributes.
pub type Strengths = [f32; ATTRIBUTES];

/// What a playing motion remembers, at the host's capacity.
pub type HostState = EmotionState<MAX_ROWS, MAX_KEYS>;

/// How a motion is played.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Strengths at the start.
    pub from: Strengths,
    /// Strengths at the end: they move evenly from frame to frame.
    pub to: Strengths,
    /// Frames a second.
    pub fps: f64,
    /// How long; `None` for the motion once, or three rounds of a cycle, at the first strengths.
    pub seconds: Option<f64>,
}

/// What was played.
#[derive(Clone, Debug)]
pub struct Played {
    /// The motion.
    pub clip: Clip,
    /// Strengths that played at the first and at the last frame: what was asked for, held inside the pack's range.
    pub strength: [Strengths; 2],
    /// Length of the motion, or of a round, at the first and at the last strengths, s.
    pub round: [f32; 2],
}

/// The frame now as a pose; then `dt` seconds pass.
pub fn pose(emotion: &HostEmotion, rig: &DeviceRig, state: &mut HostState, dt: f32) -> Pose<MAX_JOINTS> {
    let (mut frame, mut pose) = (HostFrame::new(), rig.rest());
    emotion.step(state, dt, &mut frame);
    rig.show(&frame, &frame, &mut Drift::new(), &mut pose);
    pose
}

/// Plays from the origin, facing +Z.
pub fn play(pack: &Pack, settings: &Settings) -> Result<Played, RigError> {
    let between = |frame: usize, last: usize| {
        let part = frame as f32 / last as f32;
        std::array::from_fn(|at| settings.from[at] + part * (settings.to[at] - settings.from[at]))
    };
    play_at(pack, settings.fps, settings.seconds, &between)
}

/// The same with the strengths that a function of the frame and the last one says.
pub fn play_at(
    pack: &Pack,
    fps: f64,
    seconds: Option<f64>,
    strengths: &dyn Fn(usize, usize) -> Strengths,
) -> Result<Played, RigError> {
    let (emotion, rig) = (HostEmotion::load(pack)?, Rig::from_pack(pack)?);
    let mut state = Box::new(HostState::new());
    state.strength = strengths(0, 1);
    emotion.change(&mut state);
    let first = (state.playing().unwrap_or_default(), state.seconds());
    let rounds = if emotion.meta().cycle { ROUNDS } else { 1.0 };
    let seconds = seconds.unwrap_or_else(|| f64::from(rounds * first.1));
    let last = (seconds * fps).round().clamp(1.0, MOST_FRAMES) as usize;
    let mut frames = Vec::with_capacity(last + 1);
    for frame in 0..=last {
        state.strength = strengths(frame, last);
        let mut next = HostFrame::new();
        emotion.step(&mut state, (1.0 / fps) as f32, &mut next);
        frames.push(next);
    }
    let strength = [first.0, state.playing().unwrap_or_default()];
    let clip = rig.clip_of(&frames, 1.0 / fps);
    Ok(Played { clip, strength, round: [first.1, state.seconds()] })
}

/// How long the motion, or a round of a cycle, takes at strengths, s.
pub fn seconds(emotion: &HostEmotion, strength: &Strengths) -> f32 {
    let mut state = Box::new(HostState::new());
    state.strength = *strength;
    emotion.change(&mut state);
    state.seconds()
}
