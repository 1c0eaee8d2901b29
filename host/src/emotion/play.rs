//! Plays an emotion model through the device's own code, frame by frame.

use kinesic::emotion::EmotionState;
use kinesic::model::{ATTRIBUTES, LoadError};
use kinesic::{Pack, Pose};

use super::model::{HostEmotion, MAX_KEYS};
use crate::rig::MAX_JOINTS;

/// Rounds of a cycle that are played where nobody says how long.
const ROUNDS: f32 = 3.0;
/// Frames that are played at most, a day at 60 frames a second.
const MOST_FRAMES: f64 = 24.0 * 3600.0 * 60.0;

/// Strengths of all attributes.
pub type Strengths = [f32; ATTRIBUTES];

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
#[derive(Clone, Debug, PartialEq)]
pub struct Played {
    /// The poses.
    pub poses: Vec<Pose<MAX_JOINTS>>,
    /// Strengths that played at the first and at the last frame: what was asked for, held inside the pack's range.
    pub strength: [Strengths; 2],
    /// Length of the motion, or of a round, at the first and at the last strengths, s.
    pub round: [f32; 2],
}

/// Plays from the origin, facing +Z.
pub fn play(pack: &Pack, settings: &Settings) -> Result<Played, LoadError> {
    let emotion = HostEmotion::load(pack)?;
    let mut state = Box::new(EmotionState::<MAX_JOINTS, MAX_KEYS>::new());
    state.strength = settings.from;
    emotion.change(&mut state);
    let first = (state.playing().unwrap_or_default(), state.seconds());
    let rounds = if emotion.meta().cycle { ROUNDS } else { 1.0 };
    let seconds = settings.seconds.unwrap_or_else(|| f64::from(rounds * first.1));
    let last = (seconds * settings.fps).round().clamp(1.0, MOST_FRAMES) as usize;
    let mut poses = Vec::with_capacity(last + 1);
    for frame in 0..=last {
        let part = frame as f32 / last as f32;
        for ((now, from), to) in state.strength.iter_mut().zip(settings.from).zip(settings.to) {
            *now = from + part * (to - from);
        }
        let mut pose = Pose::identity();
        emotion.step(&mut state, (1.0 / settings.fps) as f32, &mut pose);
        poses.push(pose);
    }
    let strength = [first.0, state.playing().unwrap_or_default()];
    Ok(Played { poses, strength, round: [first.1, state.seconds()] })
}

/// What the ranking functions say of the keyframes at these strengths, held inside the pack's range.
pub fn score(pack: &Pack, strengths: &Strengths) -> Result<Strengths, LoadError> {
    let emotion = HostEmotion::load(pack)?;
    let meta = emotion.meta();
    let mut motion = vec![0.0; meta.keyframes as usize * meta.components as usize];
    emotion.motion(strengths, &mut motion);
    Ok(emotion.score(&motion))
}
