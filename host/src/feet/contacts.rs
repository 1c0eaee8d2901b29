//! When a foot stands.

use nalgebra::Vector3;

use crate::clip::{Canonical, Clip, JointMap, Skeleton};

/// Height over its lowest one under which a foot begins to stand, and under which it goes on standing, m of an adult.
const HEIGHT: [f64; 2] = [0.04, 0.07];
/// Horizontal speed under which a foot begins to stand, and under which it goes on standing, m/s of an adult.
const SPEED: [f64; 2] = [0.5, 0.8];
/// Standing for less is an accident of the threshold, s.
const SHORTEST: f64 = 0.08;
/// Half the time over which a speed is measured, s.
const HALF_WINDOW: f64 = 0.017;
/// Length of an adult's leg, m.
const LEG: f64 = 0.85;

/// The joints of a leg, and where its foot touches the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Foot {
    /// Hip, knee, ankle.
    pub leg: [usize; 3],
    /// The joint that touches the ground: the toe, or the ankle.
    pub joint: usize,
    /// Where on it, m: the tip of an ankle without a toe.
    pub tip: Vector3<f64>,
}

impl Foot {
    /// The feet of a skeleton, left and right; a side whose leg is not known is left out.
    pub fn of(skeleton: &Skeleton, map: &JointMap) -> Vec<Foot> {
        use Canonical::*;
        let side = |[hip, knee, ankle, toe]: [Canonical; 4]| {
            let leg = [map.joint(hip)?, map.joint(knee)?, map.joint(ankle)?];
            let joint = map.joint(toe).unwrap_or(leg[2]);
            let tip = skeleton.joints[joint].end.filter(|_| joint == leg[2]).unwrap_or_else(Vector3::zeros);
            Some(Foot { leg, joint, tip })
        };
        [[LHip, LKnee, LAnkle, LToe], [RHip, RKnee, RAnkle, RToe]].into_iter().filter_map(side).collect()
    }

    /// Where it touches the ground, world, m, per frame.
    pub fn path(&self, clip: &Clip) -> Vec<Vector3<f64>> {
        let at = |frame: usize| {
            let position = clip.positions(frame)[self.joint];
            if self.tip == Vector3::zeros() {
                return position;
            }
            position + clip.skeleton.world_rotations(clip.pose(frame))[self.joint] * self.tip
        };
        (0..clip.frames()).map(at).collect()
    }

    /// Length of the leg, m.
    pub fn length(&self, skeleton: &Skeleton) -> f64 {
        let rest = skeleton.rest_positions();
        let [hip, knee, ankle] = self.leg.map(|joint| rest[joint]);
        (knee - hip).norm() + (ankle - knee).norm()
    }

    /// Length of the leg over that of an adult: thresholds are so many times as large.
    pub fn size(&self, skeleton: &Skeleton) -> f64 {
        self.length(skeleton) / LEG
    }

    /// Whether it stands, per frame of its path: low and slow, with hysteresis. `size` is that of the body, 1 = an adult.
    pub fn stands(path: &[Vector3<f64>], fps: f64, size: f64) -> Vec<bool> {
        let ground = ground(path);
        let (mut stands, mut last) = (Vec::with_capacity(path.len()), false);
        for frame in 0..path.len() {
            let [height, speed] = if last { [HEIGHT[1], SPEED[1]] } else { [HEIGHT[0], SPEED[0]] };
            last = path[frame].y < ground + height * size && velocity(path, frame, fps).xz().norm() < speed * size;
            stands.push(last);
        }
        drop_short(&mut stands, (SHORTEST * fps).ceil() as usize);
        stands
    }
}

/// The height of the ground under a foot: that below which it hardly ever is, m.
pub(super) fn ground(path: &[Vector3<f64>]) -> f64 {
    let mut heights: Vec<f64> = path.iter().map(|p| p.y).collect();
    heights.sort_by(f64::total_cmp);
    heights.get(heights.len() / 20).copied().unwrap_or(0.0)
}

/// Velocity over a short window, m/s.
pub(super) fn velocity(path: &[Vector3<f64>], frame: usize, fps: f64) -> Vector3<f64> {
    let half = (HALF_WINDOW * fps).round().max(1.0) as usize;
    let (before, after) = (frame.saturating_sub(half), (frame + half).min(path.len() - 1));
    (path[after] - path[before]) * (fps / (after - before).max(1) as f64)
}

/// The runs of frames in which a foot stands.
pub(super) fn runs(stands: &[bool]) -> Vec<std::ops::Range<usize>> {
    let mut runs: Vec<std::ops::Range<usize>> = Vec::new();
    for (frame, _) in stands.iter().enumerate().filter(|(_, stands)| **stands) {
        match runs.last_mut() {
            Some(run) if run.end == frame => run.end += 1,
            _ => runs.push(frame..frame + 1),
        }
    }
    runs
}

fn drop_short(stands: &mut [bool], shortest: usize) {
    for run in runs(stands).into_iter().filter(|run| run.len() < shortest) {
        stands[run].fill(false);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gait::{Manner, walk};

    #[test]
    fn a_made_walk_stands_on_one_foot_or_both() {
        let clip = walk(&Manner::NEUTRAL, 4.0, 60.0, 0.0, 2);
        let map = JointMap::choose(&clip.skeleton, None).unwrap().unwrap();
        let feet = Foot::of(&clip.skeleton, &map);
        let stands: Vec<Vec<bool>> =
            feet.iter().map(|f| Foot::stands(&f.path(&clip), 60.0, f.size(&clip.skeleton))).collect();
        let (none, both) = (0..clip.frames()).fold((0, 0), |(none, both), frame| {
            let count = stands.iter().filter(|foot| foot[frame]).count();
            (none + usize::from(count == 0), both + usize::from(count == 2))
        });
        assert!(none * 10 < clip.frames(), "{none} of {} frames in the air", clip.frames());
        assert!(both * 2 < clip.frames(), "{both} of {} frames on both feet", clip.frames());
        // .9 strides a second for 4 s.
        assert!(stands.iter().all(|foot| (3..=5).contains(&runs(foot).len())), "{stands:?}");
    }

    #[test]
    fn a_foot_that_swings_low_does_not_stand() {
        let path: Vec<Vector3<f64>> = (0..60).map(|t| Vector3::new(0.0, 0.0, 0.02 * f64::from(t))).collect();
        assert!(Foot::stands(&path, 60.0, 1.0).iter().all(|stands| !stands), "1.2 m/s");
        assert!(Foot::stands(&path, 10.0, 1.0).iter().all(|stands| *stands), ".2 m/s");
    }
}
