//! What motions do that a body or a robot may not do much more of.

use kinesic::rig::JointKind;
use nalgebra::{UnitQuaternion, Vector3};

use crate::clip::{Canonical, Clip};
use crate::feet::Foot;
use crate::rig::Rig;

/// Mass of trunk and head, of an arm and of a leg, as shares of the body's (de Leva 1996).
const TRUNK: f64 = 0.50;
const ARM: f64 = 0.05;
const LEG: f64 = 0.20;
/// Share of the frames that may be farther: single frames of a recording are wrong.
const OUTLIERS: f64 = 0.02;
/// Frames that stand for a set of motions where joints are compared.
const FRAMES: usize = 150;
/// A joint may turn so much farther than in the training clips, rad.
const TURNS: f64 = 0.52;
/// A slider may go so much farther, as a share of its range there, and at least so far, m.
const SLIDES: f64 = 0.5;
const SHORTEST: f64 = 0.001;

/// What some motions on one rig do.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Figures {
    /// Fastest joint, heading-local, m/s.
    pub speed_m_s: f64,
    /// Third derivative of the joints' positions, root mean square over the joints, in the middle one of all frames, m/s^3. What single frames of
    /// a recording do is not in it.
    pub jerk_m_s3: f64,
    /// Of a body whose legs are known and that ever stands.
    pub stand: Option<Stand>,
    /// Frames of a body, `[frames x joints]`, evenly chosen.
    rotations: Vec<UnitQuaternion<f64>>,
    /// Of a machine: least and greatest value of every coordinate, rad or m.
    ranges: Vec<[f64; 2]>,
}

/// How a body stands.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stand {
    /// How far the centre of mass is from the nearest foot that stands, on the ground, m: nearly the farthest of all frames.
    pub reach_m: f64,
    /// Part of the time for which a foot stands, percent: the mean of the motions.
    pub standing_percent: f64,
    /// Length of a leg, m.
    pub leg_m: f64,
}

impl Figures {
    /// Measures motions on a rig. Cost: forward kinematics of all frames, twice.
    pub fn of<'a>(rig: &Rig, clips: impl Iterator<Item = &'a Clip>) -> Self {
        let clips: Vec<&Clip> = clips.collect();
        let body = rig.frames().travels();
        let mut all = Self::default();
        let (mut jerks, mut stands) = (Vec::new(), Vec::new());
        for clip in &clips {
            let locals = rig.locals_of(clip);
            all.speed_m_s = all.speed_m_s.max(clip.fps() * top_speed(&locals.positions, locals.channels()));
            if !body {
                jerks.extend(jerk(&locals.positions, locals.channels(), clip.fps()));
                all.ranges.resize(3 * rig.rows(), [f64::INFINITY, f64::NEG_INFINITY]);
                for row in locals.coordinates.chunks_exact(all.ranges.len().max(1)) {
                    all.ranges.iter_mut().zip(row).for_each(|(range, x)| *range = [range[0].min(*x), range[1].max(*x)]);
                }
                continue;
            }
            let positions = clip.all_positions();
            let flat: Vec<f64> = positions.iter().flat_map(|p| [p.x, p.y, p.z]).collect();
            jerks.extend(jerk(&flat, 3 * rig.joints(), clip.fps()));
            stands.extend(Stand::of(rig, clip, &positions));
        }
        if body {
            let frames: usize = clips.iter().map(|clip| clip.frames()).sum();
            let every = frames.div_ceil(FRAMES).max(1);
            let chosen = clips.iter().flat_map(|clip| (0..clip.frames()).map(move |frame| clip.pose(frame)));
            all.rotations = chosen.step_by(every).flatten().copied().collect();
        }
        all.jerk_m_s3 = at_share(jerks, 0.5);
        all.stand = Stand::of_all(&stands);
        all
    }

    /// The larger of what two sets of motions do.
    pub fn or(self, other: Self) -> Self {
        let ranges = self.ranges.iter().zip(&other.ranges).map(|(a, b)| [a[0].min(b[0]), a[1].max(b[1])]);
        Self {
            speed_m_s: self.speed_m_s.max(other.speed_m_s),
            jerk_m_s3: self.jerk_m_s3.max(other.jerk_m_s3),
            stand: self.stand.zip(other.stand).map_or(self.stand.or(other.stand), |(a, b)| {
                Some(Stand {
                    reach_m: a.reach_m.max(b.reach_m),
                    standing_percent: a.standing_percent.min(b.standing_percent),
                    leg_m: a.leg_m,
                })
            }),
            ranges: if self.ranges.is_empty() { other.ranges.clone() } else { ranges.collect() },
            rotations: [self.rotations, other.rotations].concat(),
        }
    }

    /// How far that joint is outside which leaves most what these motions do, as a share of what it may be. Of a body: the angle to the nearest
    /// rotation that the joint has in them; roots may face anywhere.
    pub fn outside(&self, rig: &Rig, played: &Self) -> f64 {
        if !rig.frames().travels() {
            return self.out_of_range(rig, &played.ranges);
        }
        let joints = rig.joints();
        let joint = |joint: usize| {
            let near = |turn: &UnitQuaternion<f64>| {
                let own = self.rotations.iter().skip(joint).step_by(joints);
                own.map(|seen| seen.coords.dot(&turn.coords).abs()).fold(0.0, f64::max)
            };
            let turns = played.rotations.iter().skip(joint).step_by(joints);
            at_share(turns.map(|turn| 2.0 * near(turn).min(1.0).acos()).collect(), 1.0 - OUTLIERS)
        };
        let turning = (0..joints).filter(|joint| rig.skeleton.joints[*joint].parent.is_some());
        turning.map(joint).fold(0.0, f64::max) / TURNS
    }

    fn out_of_range(&self, rig: &Rig, ranges: &[[f64; 2]]) -> f64 {
        let past = |kind: JointKind, at: usize| {
            let (Some([low, high]), Some(found)) = (self.ranges.get(at), ranges.get(at)) else { return 0.0 };
            let allowed = if kind == JointKind::Slider { (SLIDES * (high - low)).max(SHORTEST) } else { TURNS };
            (low - found[0]).max(found[1] - high).max(0.0) / allowed
        };
        let coordinates = rig.frames().places().flat_map(|(kind, first)| {
            (first..first + kind.coordinates()).map(move |at| (kind, at)).collect::<Vec<_>>()
        });
        coordinates.map(|(kind, at)| past(kind, at)).fold(0.0, f64::max)
    }
}

impl Stand {
    fn of(rig: &Rig, clip: &Clip, positions: &[Vector3<f64>]) -> Option<Self> {
        let legs = Foot::of(&clip.skeleton, &rig.map);
        let foot = |foot: &Foot| {
            let path = foot.path(clip);
            let stands = Foot::stands(&path, clip.fps(), foot.size(&clip.skeleton));
            (path, stands)
        };
        let feet: Vec<(Vec<Vector3<f64>>, Vec<bool>)> = legs.iter().map(foot).collect();
        let reach = |(frame, positions): (usize, &[Vector3<f64>])| {
            let centre = centre_of_mass(rig, positions)?;
            let standing = feet.iter().filter(|(_, stands)| stands[frame]);
            standing.map(|(path, _)| (path[frame] - centre).xz().norm()).min_by(f64::total_cmp)
        };
        let reaches: Vec<f64> = positions.chunks_exact(rig.joints().max(1)).enumerate().filter_map(reach).collect();
        let standing = feet.iter().flat_map(|(_, stands)| stands).filter(|stands| **stands).count();
        let leg_m = legs.first()?.length(&clip.skeleton);
        Some(Self {
            reach_m: at_share(reaches, 1.0 - OUTLIERS),
            standing_percent: 100.0 * standing as f64 / (feet.len() * clip.frames()).max(1) as f64,
            leg_m,
        })
    }

    fn of_all(all: &[Self]) -> Option<Self> {
        let first = all.first()?;
        Some(Self {
            reach_m: all.iter().map(|stand| stand.reach_m).fold(0.0, f64::max),
            standing_percent: all.iter().map(|stand| stand.standing_percent).sum::<f64>() / all.len() as f64,
            leg_m: first.leg_m,
        })
    }
}

/// Where the mass is: trunk and head between hips and shoulders, an arm at its elbow, a leg at its knee.
fn centre_of_mass(rig: &Rig, positions: &[Vector3<f64>]) -> Option<Vector3<f64>> {
    use Canonical::*;
    let at = |joint: Canonical| rig.map.joint(joint).map(|joint| positions[joint]);
    let trunk = (at(LHip)? + at(RHip)? + at(LShoulder)? + at(RShoulder)?) / 4.0;
    Some(trunk * TRUNK + (at(LElbow)? + at(RElbow)?) * ARM + (at(LKnee)? + at(RKnee)?) * LEG)
}

/// The value below which so large a share of all is; 0 of none.
fn at_share(mut values: Vec<f64>, share: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    let last = values.len().saturating_sub(1) as f64;
    values.get((share * last).round() as usize).copied().unwrap_or(0.0)
}

/// Fastest joint of positions `[frames x channels]`, m a frame.
fn top_speed(positions: &[f64], channels: usize) -> f64 {
    let frames = positions.chunks_exact(channels.max(1));
    let steps = frames.clone().zip(frames.skip(1)).flat_map(|(a, b)| {
        let joints = a.as_chunks::<3>().0.iter().zip(b.as_chunks::<3>().0);
        joints.map(|(a, b)| a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>())
    });
    steps.fold(0.0, f64::max).sqrt()
}

/// Root mean square of the joints' third derivatives, frame by frame, of positions `[frames x channels]`.
fn jerk(positions: &[f64], channels: usize, fps: f64) -> Vec<f64> {
    let frames: Vec<&[f64]> = positions.chunks_exact(channels.max(1)).collect();
    let frame = |window: &[&[f64]]| {
        let third = |at: usize| window[3][at] - 3.0 * window[2][at] + 3.0 * window[1][at] - window[0][at];
        let sum: f64 = (0..channels).map(|at| third(at).powi(2)).sum();
        fps.powi(3) * (3.0 * sum / channels.max(1) as f64).sqrt()
    };
    frames.windows(4).map(frame).collect()
}
