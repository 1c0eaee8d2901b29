//! A clip as points over time: what a skeleton looks like when nobody reads its names.

use nalgebra::Vector3;

use crate::clip::Clip;
use crate::clip::units::longest_path;

/// Frames that are looked at, evenly spread.
const SAMPLES: usize = 60;
/// Bones of a limb, with all that may lie between them; deeper is not searched.
pub(super) const DEPTH: usize = 16;
/// A bone shorter than this, as a share of the longest path through the skeleton, joins two joints in one place.
const NOTHING: f64 = 1e-3;

/// How far two joints of one chain are apart.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Chord {
    /// Mean distance over the frames.
    pub mean: f64,
    /// Standard deviation of the distance.
    pub spread: f64,
    /// Length along the bones.
    pub path: f64,
}

/// The points of a clip.
pub(super) struct Seen<'a> {
    pub clip: &'a Clip,
    /// Positions `[frames][joints]`.
    pub frames: Vec<Vec<Vector3<f64>>>,
    /// Tips of leaves, `[frames][joints]`; the joint itself where there is none.
    pub tips: Vec<Vec<Vector3<f64>>>,
    /// Seconds between the frames that were taken.
    pub step: f64,
    pub children: Vec<Vec<usize>>,
    /// Longest path from each joint outwards.
    pub reach: Vec<f64>,
    /// Longest path through the skeleton: fingertip to toe.
    pub whole: f64,
    /// To each joint's parent, grandparent, ...
    chords: Vec<Vec<Chord>>,
}

impl<'a> Seen<'a> {
    pub fn new(clip: &'a Clip) -> Self {
        let joints = &clip.skeleton.joints;
        let every = clip.frames().div_ceil(SAMPLES).max(1);
        let taken: Vec<usize> = (0..clip.frames()).step_by(every).collect();
        let frames: Vec<_> = taken.iter().map(|&f| clip.positions(f)).collect();
        let tip = |f: usize, points: &[Vector3<f64>]| {
            let turns = clip.skeleton.world_rotations(clip.pose(f));
            let ends = joints.iter().zip(points).zip(turns);
            ends.map(|((joint, at), turn)| joint.end.map_or(*at, |end| at + turn * end)).collect()
        };
        let tips = taken.iter().zip(&frames).map(|(&f, points)| tip(f, points)).collect();
        let mut children = vec![Vec::new(); joints.len()];
        let mut reach: Vec<f64> = joints.iter().map(|j| j.end.map_or(0.0, |e| e.norm())).collect();
        for (at, joint) in joints.iter().enumerate().rev() {
            if let Some(parent) = joint.parent {
                reach[parent] = reach[parent].max(reach[at] + joint.offset.norm());
                children[parent].insert(0, at);
            }
        }
        let mut seen = Self {
            clip,
            frames,
            tips,
            step: every as f64 * clip.frame_time,
            children,
            reach,
            whole: longest_path(&clip.skeleton),
            chords: Vec::new(),
        };
        seen.chords = (0..joints.len()).map(|joint| seen.chords_of(joint)).collect();
        seen
    }

    fn chords_of(&self, joint: usize) -> Vec<Chord> {
        let (mut path, mut below) = (0.0, joint);
        let above = self.above(joint).skip(1).take(DEPTH);
        let chord = |at: usize| {
            path += self.bone(below);
            below = at;
            let all = || self.frames.iter().map(|p| (p[joint] - p[at]).norm());
            let count = self.frames.len().max(1) as f64;
            let mean = all().sum::<f64>() / count;
            let spread = (all().map(|d| (d - mean).powi(2)).sum::<f64>() / count).sqrt();
            Chord { mean, spread, path }
        };
        above.map(chord).collect()
    }

    /// The joint, its parent, and so on up.
    pub fn above(&self, joint: usize) -> impl Iterator<Item = usize> + '_ {
        std::iter::successors(Some(joint), |&at| self.clip.skeleton.joints[at].parent)
    }

    /// Length of the bone from the parent.
    pub fn bone(&self, joint: usize) -> f64 {
        self.clip.skeleton.joints[joint].offset.norm()
    }

    /// Whether a joint lies where its parent does.
    pub fn is_doubled(&self, joint: usize) -> bool {
        self.bone(joint) < NOTHING * self.whole
    }

    /// Between a joint and the one so many steps up.
    pub fn chord(&self, joint: usize, steps: usize) -> Option<Chord> {
        self.chords[joint].get(steps.checked_sub(1)?).copied()
    }

    /// Where two chains meet.
    pub fn meet(&self, a: usize, b: usize) -> Option<usize> {
        self.above(a).find(|&j| self.above(b).any(|k| k == j))
    }

    /// Whether a joint is another or hangs on it.
    pub fn hangs_on(&self, joint: usize, on: usize) -> bool {
        self.above(joint).any(|j| j == on)
    }

    /// Mean over the frames of a number, of those frames that have one.
    pub fn mean(&self, of: impl Fn(&[Vector3<f64>]) -> Option<f64>) -> Option<f64> {
        let all: Vec<f64> = self.frames.iter().filter_map(|p| of(p)).collect();
        (!all.is_empty()).then(|| all.iter().sum::<f64>() / all.len() as f64)
    }

    /// Whether a joint ever turns, rad over 0.01 off its first frame.
    pub fn turns(&self, joint: usize) -> bool {
        let n = self.clip.skeleton.len();
        let mut all = self.clip.rotations.iter().skip(joint).step_by(n);
        let Some(first) = all.next() else { return false };
        all.any(|r| r.angle_to(first) > 0.01)
    }
}
