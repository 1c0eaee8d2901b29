//! What the eye sees of feet, by numbers.

use nalgebra::Vector3;
use serde::Serialize;

use super::contacts::{Foot, runs, velocity};
use crate::clip::{Canonical, Clip, JointMap};

/// Correlation of a foot with its source from which it keeps step.
pub const IN_STEP: f64 = 0.9;
/// Correlation under which a foot does something else than its source: holding it where that one stands would break the walk.
pub const OUT_OF_STEP: f64 = 0.5;
/// A foot that swings less has no step to keep, m of root mean square.
const STILL: f64 = 0.03;

/// What the feet of a motion do.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Feet {
    /// Mean horizontal speed of a foot while it stands, cm/s; 0 if no foot ever does.
    pub slide_cm_s: f64,
    /// Part of the time for which a foot stands, percent.
    pub standing_percent: f64,
    /// Steps a minute: how often a foot begins to stand.
    pub steps_a_minute: f64,
}

impl Feet {
    /// Measures a motion. Cost: forward kinematics of all frames.
    pub fn of(clip: &Clip, map: &JointMap) -> Feet {
        let fps = clip.fps();
        let (mut slide, mut standing, mut frames, mut steps) = (0.0, 0, 0, 0);
        for foot in Foot::of(&clip.skeleton, map) {
            let path = foot.path(clip);
            let stands = Foot::stands(&path, fps, foot.size(&clip.skeleton));
            // The first and the last frame of a contact belong to the step.
            for run in runs(&stands) {
                steps += usize::from(run.start > 0);
                slide += run.clone().map(|frame| 100.0 * velocity(&path, frame, fps).xz().norm()).sum::<f64>();
                standing += run.len();
            }
            frames += stands.len();
        }
        Feet {
            slide_cm_s: slide / standing.max(1) as f64,
            standing_percent: 100.0 * standing as f64 / frames.max(1) as f64,
            steps_a_minute: 60.0 * steps as f64 / clip.duration().max(clip.frame_time),
        }
    }
}

/// Correlation of each foot of a result with that of its source, left and right: how far it is before the hips. 1 keeps step, -1 answers
/// left with right. `None` where the source's foot hardly swings. The clips have the same frames; skeletons may differ.
pub fn kept_step(source: (&Clip, &JointMap), result: (&Clip, &JointMap)) -> [Option<f64>; 2] {
    use Canonical::*;
    let [from, to] = [source, result].map(|(clip, map)| {
        let joints = [LHip, RHip, LAnkle, RAnkle].map(|joint| map.joint(joint));
        let [Some(left_hip), Some(right_hip), Some(left), Some(right)] = joints else { return None };
        let reach = |frame: usize| {
            let at = clip.positions(frame);
            let across = at[left_hip] - at[right_hip];
            let forward = Vector3::new(-across.z, 0.0, across.x).try_normalize(1e-9).unwrap_or_else(Vector3::z);
            let middle = (at[left_hip] + at[right_hip]) / 2.0;
            [left, right].map(|ankle| (at[ankle] - middle).dot(&forward))
        };
        Some((0..clip.frames()).map(reach).collect::<Vec<_>>())
    });
    let (Some(from), Some(to)) = (from, to) else { return [None; 2] };
    [0, 1].map(|side| correlation(from.iter().zip(&to).map(|(a, b)| [a[side], b[side]])))
}

fn correlation(pairs: impl Iterator<Item = [f64; 2]> + Clone) -> Option<f64> {
    let count = pairs.clone().count() as f64;
    let mean = [0, 1].map(|of| pairs.clone().map(|pair| pair[of]).sum::<f64>() / count);
    let (mut aa, mut bb, mut ab) = (0.0, 0.0, 0.0);
    for [a, b] in pairs.map(|[a, b]| [a - mean[0], b - mean[1]]) {
        (aa, bb, ab) = (aa + a * a, bb + b * b, ab + a * b);
    }
    let swings = (aa / count).sqrt() > STILL;
    swings.then(|| ab / (aa * bb).sqrt().max(1e-12))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gait::{Manner, walk};

    fn map(clip: &Clip) -> JointMap {
        JointMap::choose(&clip.skeleton, None).unwrap().unwrap()
    }

    #[test]
    fn a_made_walk_does_not_slide_and_has_its_cadence() {
        let clip = walk(&Manner::NEUTRAL, 8.0, 60.0, 0.0, 5);
        let feet = Feet::of(&clip, &map(&clip));
        // .9 strides a second are 108 steps a minute.
        assert!((feet.steps_a_minute - 108.0).abs() < 12.0, "{feet:?}");
        let mut carried = clip.clone();
        carried.root.iter_mut().enumerate().for_each(|(frame, root)| root.z += 0.005 * frame as f64);
        let sliding = Feet::of(&carried, &map(&carried));
        assert!(sliding.slide_cm_s > feet.slide_cm_s + 15.0, "{feet:?}, carried on at 30 cm/s: {sliding:?}");
    }

    #[test]
    fn half_a_stride_later_is_out_of_step() {
        let [now, later] = [0.0, 0.5].map(|phase| walk(&Manner::NEUTRAL, 4.0, 60.0, phase, 5));
        let map = map(&now);
        assert!(kept_step((&now, &map), (&now, &map)).iter().all(|c| c.is_some_and(|c| c > 0.999)));
        assert!(kept_step((&now, &map), (&later, &map)).iter().all(|c| c.is_some_and(|c| c < -0.7)));
        let mut still = now.clone();
        let first = now.pose(0).to_vec();
        still.rotations = first.iter().cycle().take(still.rotations.len()).copied().collect();
        assert_eq!(kept_step((&still, &map), (&now, &map)), [None; 2]);
    }
}
