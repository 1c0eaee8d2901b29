//! Plays a pack through the device's own code, frame by frame.

use kinesic::engine::Controls;
use kinesic::model::LoadError;
use kinesic::{Pack, Pose, Translator, TranslatorState};
use nalgebra::UnitQuaternion;

use crate::clip::Clip;
use crate::rig::{MAX_JOINTS, MAX_ROWS, Rig};
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
        Timing::Learned => retime(rig, &styled, &clock),
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

/// The motion at whole frames of `clock`, which says when each frame is due, in frames, rising.
pub fn retime(rig: &Rig, clip: &Clip, clock: &[f64]) -> Clip {
    let Some(end) = clock.last().filter(|_| clip.frames() > 1) else { return clip.clone() };
    let mut next = 1;
    let due = (0..=end.floor() as usize).map(|frame| {
        let due = frame as f64;
        while next + 1 < clock.len() && clock[next] < due {
            next += 1;
        }
        (next, ((due - clock[next - 1]) / (clock[next] - clock[next - 1])).clamp(0.0, 1.0) as f32)
    });
    if clip.coordinates.is_none() {
        let poses = rig.poses(clip);
        let made: Vec<_> = due.map(|(next, weight)| between(&poses[next - 1], &poses[next], weight)).collect();
        return rig.clip(&made, clip.frame_time);
    }
    let frames = rig.frames_of(clip);
    let made = due.map(|(next, weight)| {
        let mut frame = frames[next - 1];
        let ends = frame.coordinates_mut().iter_mut().zip(frames[next].coordinates());
        ends.for_each(|(x, to)| *x += weight * (to - *x));
        frame
    });
    rig.clip_of(&made.collect::<Vec<_>>(), clip.frame_time)
}

/// Linear interpolation of two poses.
pub(crate) fn between(a: &Pose<MAX_JOINTS>, b: &Pose<MAX_JOINTS>, weight: f32) -> Pose<MAX_JOINTS> {
    let mut pose = Pose::identity();
    pose.root = a.root.lerp(&b.root, weight);
    for (out, (a, b)) in pose.rotations.iter_mut().zip(a.rotations.iter().zip(&b.rotations)) {
        *out = UnitQuaternion::new_normalize(kinesic::pose::nlerp(a, b, weight).into_inner());
    }
    pose
}
