//! A clip in a few numbers, for `kinesic inspect`.

use rayon::prelude::*;

use super::units::{chain, longest_path};
use super::{Canonical, Clip, JointMap, Skeleton};

/// A clip in a few numbers.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Summary {
    /// Number of joints.
    pub joints: usize,
    /// Number of frames.
    pub frames: usize,
    /// Frames per second.
    pub fps: f64,
    /// Seconds from the first frame to the last.
    pub duration_s: f64,
    /// Known layout of the joint names, if any.
    pub layout: Option<String>,
    /// Estimated body height, m; see [`Skeleton::height`].
    pub height_m: f64,
    /// Lowest and highest joint over all frames, m.
    pub vertical_m: [f64; 2],
    /// What the reader changed or assumed.
    pub notes: Vec<String>,
}

impl Clip {
    /// The clip in a few numbers. Cost: forward kinematics of all frames.
    pub fn summary(&self) -> Summary {
        let map = JointMap::detect(&self.skeleton);
        let none = || [f64::INFINITY, f64::NEG_INFINITY];
        let joined = |a: [f64; 2], b: [f64; 2]| [a[0].min(b[0]), a[1].max(b[1])];
        let heights = |worlds: &mut Vec<_>, frame| {
            self.skeleton.pose_worlds(&self.root[frame], self.pose(frame), worlds);
            worlds.iter().map(|(place, _)| [place.y; 2]).fold(none(), joined)
        };
        let vertical_m = (0..self.frames()).into_par_iter().map_init(Vec::new, heights).reduce(none, joined);
        Summary {
            joints: self.skeleton.len(),
            frames: self.frames(),
            fps: self.fps(),
            duration_s: self.duration(),
            height_m: self.skeleton.height(map.as_ref()),
            layout: map.map(|m| m.layout().to_owned()),
            vertical_m,
            notes: self.notes.clone(),
        }
    }
}

impl Skeleton {
    /// Estimated body height, m, from bone lengths alone, so that it does not depend on the pose: pelvis to the tip of the
    /// head plus the mean of the legs, hip to ankle. An ankle stands some 8 cm high and the hip joints some 8 cm below the
    /// pelvis; these 16 cm of an adult are not in it. Without known names: three quarters of the longest path.
    pub fn height(&self, map: Option<&JointMap>) -> f64 {
        map.and_then(|m| self.bone_height(m)).unwrap_or_else(|| 0.75 * longest_path(self))
    }

    fn bone_height(&self, map: &JointMap) -> Option<f64> {
        let between = |from, to| chain(self, map.joint(from)?, map.joint(to)?);
        let head = map.joint(Canonical::Head)?;
        let tip = self.joints.get(head)?.end.map_or(0.0, |e| e.norm());
        let legs = between(Canonical::LAnkle, Canonical::LHip)? + between(Canonical::RAnkle, Canonical::RHip)?;
        Some(between(Canonical::Head, Canonical::Pelvis)? + tip + legs / 2.0)
    }
}
