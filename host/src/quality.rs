//! What the eye sees first in a motion: sliding feet, its rhythm, and jitter.

use serde::Serialize;

use crate::clip::{Clip, JointMap};
use crate::feet::Feet;

/// Quality of one motion, by numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Quality {
    /// Mean horizontal speed of a foot while it stands, cm/s; 0 if no foot ever does.
    pub foot_slide_cm_s: f64,
    /// Part of the time for which a foot stands, percent.
    pub standing_percent: f64,
    /// How often a foot begins to stand.
    pub steps_a_minute: f64,
    /// Root mean square of the third derivative of all joint positions, m/s^3.
    pub jerk_m_s3: f64,
}

/// Measures a clip. Cost: forward kinematics of all frames.
pub fn measure(clip: &Clip, map: &JointMap) -> Quality {
    let joints = clip.skeleton.len();
    let positions = clip.all_positions();
    let fps = clip.fps();
    let (mut square, mut count) = (0.0, 0);
    for t in 3..clip.frames() {
        for joint in 0..joints {
            let at = |back: usize| positions[(t - back) * joints + joint];
            square += ((at(0) - at(3)) - (at(1) - at(2)) * 3.0).norm_squared() * fps.powi(6);
            count += 1;
        }
    }
    let feet = Feet::of(clip, map);
    Quality {
        foot_slide_cm_s: feet.slide_cm_s,
        standing_percent: feet.standing_percent,
        steps_a_minute: feet.steps_a_minute,
        jerk_m_s3: (square / f64::from(count.max(1))).sqrt(),
    }
}
