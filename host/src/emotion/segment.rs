//! Motions to learn from: whole clips, or the gait cycles of a clip.
//!
//! A regression averages motions, so they must be in phase: walks that start on other feet would average to mush. A cycle goes
//! from one furthest reach of the left foot to the next, measured forward from the pelvis: heel strike on level ground (Zeni,
//! Richards, Higginson 2008). It needs no threshold of speed or height, so limps, runs and feet without toes are cut alike.

use nalgebra::{UnitQuaternion, Vector3};

use crate::clip::{Canonical, Clip};
use crate::rig::Rig;

/// Frames per second of the motions.
pub const FRAME_RATE: f64 = 60.0;
/// The reach must fall by this share of its range before the next strike is looked for.
const SWING: f64 = 0.35;
/// Shortest and longest cycle, s.
const CYCLE: [f64; 2] = [0.25, 4.0];
/// A cycle this many times longer than the clip's median holds a stop or a turn on the spot.
const STOP: f64 = 1.5;
/// Distance on the ground that a cycle of a gait covers at least, m.
const TRAVEL: f64 = 0.3;
/// Share of the clips that must hold a cycle for them to be gaits.
const GAITS: f64 = 0.8;

/// What of a clip is a motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cut {
    /// All of it.
    Whole,
    /// Every cycle of a gait by itself.
    Cycles,
}

impl Cut {
    /// Cycles, if nearly all of the clips are gaits.
    pub fn suggested<'a>(rig: &Rig, clips: impl Iterator<Item = &'a Clip>) -> Self {
        let (mut all, mut gaits) = (0.0, 0.0);
        for clip in clips {
            all += 1.0;
            gaits += if cut(rig, clip, Self::Cycles).is_empty() { 0.0 } else { 1.0 };
        }
        if gaits > 0.0 && gaits >= GAITS * all { Self::Cycles } else { Self::Whole }
    }
}

/// A motion: the positions of all joints, ground position and heading of its first frame taken out.
#[derive(Clone, Debug)]
pub struct Segment {
    /// First frame in the clip.
    pub start: usize,
    /// Seconds between frames.
    pub frame_time: f64,
    /// Position of every joint, m, `[frames x 3 joints]`.
    pub positions: Vec<f64>,
    /// The same seen from the root, along each frame's own heading: the posture.
    pub postures: Vec<f64>,
    /// Local rotations, the root's without the heading of its frame, `[frames x joints]`.
    pub rotations: Vec<UnitQuaternion<f64>>,
    channels: usize,
}

impl Segment {
    /// A motion of a clip on the rig.
    pub fn new(rig: &Rig, clip: &Clip, frames: std::ops::Range<usize>) -> Self {
        if clip.coordinates.is_some() {
            return Self::of_machine(rig, &clip.slice(frames.clone()), frames.start);
        }
        let hips = [Canonical::LHip, Canonical::RHip].map(|hip| rig.map.joint(hip).unwrap_or_default());
        let mut motion = Self {
            start: frames.start,
            frame_time: clip.frame_time,
            positions: Vec::new(),
            postures: Vec::new(),
            rotations: Vec::new(),
            channels: 3 * rig.joints(),
        };
        let mut heading = Heading { sin: 0.0, cos: 1.0 };
        let mut first = None;
        for frame in frames {
            let positions = clip.positions(frame);
            heading = heading.follow(positions[hips[0]] - positions[hips[1]]);
            let below = |p: Vector3<f64>| Vector3::new(p.x, 0.0, p.z);
            let (start, origin) = *first.get_or_insert((heading, below(positions[0])));
            for position in &positions {
                motion.positions.extend(start.local(position - origin).iter());
                motion.postures.extend(heading.local(position - positions[0]).iter());
            }
            let turn = heading.rotation().inverse();
            let locals = clip.pose(frame).iter().enumerate();
            motion.rotations.extend(locals.map(|(joint, q)| if joint == 0 { turn * q } else { *q }));
        }
        motion
    }

    /// A machine's motion: it stands, so what is seen from the root is what there is.
    fn of_machine(rig: &Rig, clip: &Clip, start: usize) -> Self {
        let positions = rig.locals_of(clip).positions;
        Self {
            start,
            frame_time: clip.frame_time,
            postures: positions.clone(),
            positions,
            rotations: clip.rotations.clone(),
            channels: 3 * rig.joints(),
        }
    }

    /// Number of frames.
    pub fn frames(&self) -> usize {
        self.positions.len() / self.channels
    }

    /// Three a joint.
    pub fn channels(&self) -> usize {
        self.channels
    }

    /// Length, s.
    pub fn duration(&self) -> f64 {
        self.frame_time * self.frames().saturating_sub(1) as f64
    }

    /// Positions of a frame.
    pub fn frame(&self, frame: usize) -> &[f64] {
        &self.positions[frame * self.channels..][..self.channels]
    }

    /// Posture of a frame.
    pub fn posture(&self, frame: usize) -> &[f64] {
        &self.postures[frame * self.channels..][..self.channels]
    }

    /// Local rotations of a frame.
    pub fn pose(&self, frame: usize) -> &[UnitQuaternion<f64>] {
        let joints = self.channels / 3;
        &self.rotations[frame * joints..][..joints]
    }
}

/// The motions of a clip on the rig; none if it holds no whole cycle.
pub fn cut(rig: &Rig, clip: &Clip, how: Cut) -> Vec<Segment> {
    match how {
        Cut::Whole => vec![Segment::new(rig, clip, 0..clip.frames())],
        Cut::Cycles => {
            let whole = Segment::new(rig, clip, 0..clip.frames());
            cycles(rig, &whole).into_iter().map(|[from, to]| Segment::new(rig, clip, from..to + 1)).collect()
        }
    }
}

/// First and last frame of every cycle.
fn cycles(rig: &Rig, motion: &Segment) -> Vec<[usize; 2]> {
    let Some(foot) = rig.map.joint(Canonical::LAnkle) else { return Vec::new() };
    let reach: Vec<f64> = (0..motion.frames()).map(|frame| motion.posture(frame)[3 * foot + 2]).collect();
    let strikes = peaks(&smoothed(&reach, (0.05 / motion.frame_time).round() as usize));
    let travel = |[from, to]: [usize; 2]| {
        let (a, b) = (motion.frame(from), motion.frame(to));
        (b[0] - a[0]).hypot(b[2] - a[2])
    };
    let seconds = |[from, to]: [usize; 2]| (to - from) as f64 * motion.frame_time;
    let sound = |cycle: &[usize; 2]| (CYCLE[0]..CYCLE[1]).contains(&seconds(*cycle)) && travel(*cycle) > TRAVEL;
    let mut found: Vec<[usize; 2]> = strikes.windows(2).map(|pair| [pair[0], pair[1]]).filter(sound).collect();
    let mut lengths: Vec<usize> = found.iter().map(|[from, to]| to - from).collect();
    lengths.sort_unstable();
    if let Some(median) = lengths.get(lengths.len() / 2) {
        found.retain(|[from, to]| ((to - from) as f64) < STOP * *median as f64);
    }
    found
}

/// Mean over `radius` neighbours on either side.
fn smoothed(values: &[f64], radius: usize) -> Vec<f64> {
    let mean = |at: usize| {
        let near = &values[at.saturating_sub(radius)..(at + radius + 1).min(values.len())];
        near.iter().sum::<f64>() / near.len() as f64
    };
    (0..values.len()).map(mean).collect()
}

/// Maxima between which the values fall by a good part of their range; not those at the ends, where the motion is cut off.
fn peaks(values: &[f64]) -> Vec<usize> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let quantile = |share: f64| sorted.get((share * sorted.len() as f64) as usize).copied().unwrap_or_default();
    let swing = SWING * (quantile(0.95) - quantile(0.05));
    let (mut peaks, mut rising) = (Vec::new(), true);
    let mut extreme = 0;
    for (at, value) in values.iter().enumerate() {
        let beyond = value - values[extreme];
        if (rising && beyond > 0.0) || (!rising && beyond < 0.0) {
            extreme = at;
        } else if beyond.abs() > swing {
            if rising && extreme > 0 {
                peaks.push(extreme);
            }
            (rising, extreme) = (!rising, at);
        }
    }
    peaks
}

/// [`kinesic::pose::Heading`] in f64.
#[derive(Clone, Copy)]
struct Heading {
    sin: f64,
    cos: f64,
}

impl Heading {
    fn follow(self, across: Vector3<f64>) -> Self {
        let norm = across.x.hypot(across.z);
        if norm > 1e-3 { Self { sin: -across.z / norm, cos: across.x / norm } } else { self }
    }

    fn local(self, v: Vector3<f64>) -> Vector3<f64> {
        Vector3::new(self.cos * v.x - self.sin * v.z, v.y, self.sin * v.x + self.cos * v.z)
    }

    fn rotation(self) -> UnitQuaternion<f64> {
        UnitQuaternion::from_axis_angle(&Vector3::y_axis(), self.sin.atan2(self.cos))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clip::JointMap;
    use crate::gait::{Manner, skeleton, walk};

    fn rig() -> Rig {
        let skeleton = skeleton();
        Rig::new(&skeleton, &JointMap::detect(&skeleton).unwrap()).unwrap()
    }

    #[test]
    fn a_walk_is_cut_once_a_stride_at_one_phase() {
        let rig = rig();
        for (manner, phase) in [(Manner::NEUTRAL, 0.1), (Manner::WEARY, 0.7)] {
            let clip = walk(&manner, 9.0, FRAME_RATE, phase, 3);
            let cycles = cut(&rig, &clip, Cut::Cycles);
            let strides = 9.0 * manner.cadence;
            assert!((strides - 2.5..=strides).contains(&(cycles.len() as f64)), "{} {strides}", cycles.len());
            for cycle in &cycles {
                assert!((cycle.duration() * manner.cadence - 1.0).abs() < 0.1, "{}", cycle.duration());
                // It starts at the origin, facing +Z, and ends as it began.
                assert!(cycle.frame(0)[0].abs() + cycle.frame(0)[2].abs() < 1e-12);
                assert!(cycle.frame(cycle.frames() - 1)[2] > 0.3);
                let ends = cycle.posture(0).iter().zip(cycle.posture(cycle.frames() - 1));
                assert!(ends.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) < 0.1);
            }
        }
    }

    #[test]
    fn standing_holds_no_cycle_and_gaits_are_recognised() {
        let rig = rig();
        let walking = walk(&Manner::NEUTRAL, 6.0, FRAME_RATE, 0.0, 1);
        let standing = rig.clip(&vec![rig.poses(&walking)[0]; 200], 1.0 / FRAME_RATE);
        assert!(cut(&rig, &standing, Cut::Cycles).is_empty());
        assert_eq!(cut(&rig, &standing, Cut::Whole).len(), 1);
        assert_eq!(Cut::suggested(&rig, [&walking, &walking].into_iter()), Cut::Cycles);
        assert_eq!(Cut::suggested(&rig, [&walking, &standing].into_iter()), Cut::Whole);
    }

    #[test]
    fn the_heading_is_the_devices() {
        let rig = rig();
        let clip = walk(&Manner::NEUTRAL, 3.0, FRAME_RATE, 0.3, 5);
        let whole = Segment::new(&rig, &clip, 0..clip.frames());
        let device = rig.locals(&rig.poses(&clip));
        let height = |at: usize| if at % 3 == 1 { clip.root[at / whole.channels()].y } else { 0.0 };
        let both = whole.postures.iter().zip(&device.positions).enumerate();
        assert!(both.map(|(at, (a, b))| (a + height(at) - b).abs()).fold(0.0, f64::max) < 1e-5);
    }
}
