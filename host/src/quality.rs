//! What the eye sees first in a motion: sliding feet and jitter.

use serde::Serialize;

use crate::clip::{Canonical, Clip, JointMap};

/// Quality of one motion, by numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Quality {
    /// Mean horizontal speed of a foot while it is on the ground, cm/s; 0 if no foot ever is.
    pub foot_slide_cm_s: f64,
    /// Root mean square of the third derivative of all joint positions, m/s^3.
    pub jerk_m_s3: f64,
}

/// A foot this near to its lowest height is on the ground, m.
const CONTACT_HEIGHT: f64 = 0.03;
/// ... if it moves up or down slower than this, m/s.
const CONTACT_SPEED: f64 = 0.2;

/// Measures a clip. Cost: forward kinematics of all frames.
pub fn measure(clip: &Clip, map: &JointMap) -> Quality {
    let joints = clip.skeleton.len();
    let positions = clip.all_positions();
    let fps = clip.fps();
    let foot = |toe, ankle| map.joint(toe).or(map.joint(ankle));
    let feet = [foot(Canonical::LToe, Canonical::LAnkle), foot(Canonical::RToe, Canonical::RAnkle)];
    let (mut slide, mut contacts) = (0.0, 0);
    for foot in feet.into_iter().flatten() {
        let path: Vec<_> = positions.chunks_exact(joints).map(|frame| frame[foot]).collect();
        let mut heights: Vec<f64> = path.iter().map(|p| p.y).collect();
        heights.sort_by(f64::total_cmp);
        let ground = heights.get(heights.len() / 20).copied().unwrap_or(0.0);
        for pair in path.windows(2) {
            let step = (pair[1] - pair[0]) * fps;
            if pair[0].y < ground + CONTACT_HEIGHT && step.y.abs() < CONTACT_SPEED {
                slide += 100.0 * step.x.hypot(step.z);
                contacts += 1;
            }
        }
    }
    let (mut square, mut count) = (0.0, 0);
    for t in 3..clip.frames() {
        for joint in 0..joints {
            let at = |back: usize| positions[(t - back) * joints + joint];
            square += ((at(0) - at(3)) - (at(1) - at(2)) * 3.0).norm_squared() * fps.powi(6);
            count += 1;
        }
    }
    Quality {
        foot_slide_cm_s: slide / f64::from(contacts.max(1)),
        jerk_m_s3: (square / f64::from(count.max(1))).sqrt(),
    }
}
