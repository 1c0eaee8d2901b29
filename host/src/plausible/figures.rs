//! What motions do that a body or a robot may not do much more of.

use nalgebra::Vector3;

use crate::clip::{Canonical, Clip};
use crate::feet::{Feet, Foot};
use crate::rig::{Locals, Rig};

/// Mass of trunk and head, of an arm and of a leg, as shares of the body's (de Leva 1996, means of women and men).
const TRUNK: f64 = 0.50;
const ARM: f64 = 0.05;
const LEG: f64 = 0.20;
/// Share of the frames that may be farther: single frames of a recording are wrong.
const OUTLIERS: f64 = 0.02;

/// What some motions on one rig do.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Figures {
    /// Fastest joint, heading-local, m/s.
    pub speed_m_s: f64,
    /// Root mean square of the third derivative of the heading-local positions, m/s^3.
    pub jerk_m_s3: f64,
    /// Least and greatest value of every coordinate, rad or m; the travel of a root is left out.
    pub coordinates: Vec<[f64; 2]>,
    /// Of a body whose legs are known and that ever stands.
    pub stand: Option<Stand>,
}

/// How a body stands: means over the motions.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stand {
    /// How far the centre of mass is from the nearest foot that stands, on the ground, m: nearly the farthest.
    pub reach_m: f64,
    /// Mean speed of a foot that stands, cm/s.
    pub slide_cm_s: f64,
    /// Part of the time for which a foot stands, percent.
    pub standing_percent: f64,
}

impl Figures {
    /// Measures motions on a rig. Cost: forward kinematics of all frames, about four times.
    pub fn of<'a>(rig: &Rig, clips: impl Iterator<Item = &'a Clip>) -> Self {
        let mut all = Self { coordinates: vec![[f64::INFINITY, f64::NEG_INFINITY]; 3 * rig.rows()], ..Self::default() };
        let (mut squares, mut count, mut stands) = (0.0, 0usize, Vec::new());
        for clip in clips {
            let locals = rig.locals_of(clip);
            let fps = clip.fps();
            all.speed_m_s = all.speed_m_s.max(fps * top_speed(&locals));
            let (sum, terms) = jerk(&locals, fps);
            (squares, count) = (squares + sum, count + terms);
            for row in locals.coordinates.chunks_exact(all.coordinates.len().max(1)) {
                for ([low, high], x) in all.coordinates.iter_mut().zip(row) {
                    (*low, *high) = (low.min(*x), high.max(*x));
                }
            }
            stands.extend(Stand::of(rig, clip));
        }
        all.jerk_m_s3 = (squares / count.max(1) as f64).sqrt();
        all.stand = Stand::mean(&stands);
        all
    }

    /// The larger of what two sets of motions do.
    pub fn or(&self, other: &Self) -> Self {
        let both = |of: fn(&Self) -> f64| of(self).max(of(other));
        let ranges = self.coordinates.iter().zip(&other.coordinates);
        Self {
            speed_m_s: both(|f| f.speed_m_s),
            jerk_m_s3: both(|f| f.jerk_m_s3),
            coordinates: ranges.map(|(a, b)| [a[0].min(b[0]), a[1].max(b[1])]).collect(),
            stand: match (self.stand, other.stand) {
                (Some(a), Some(b)) => Some(Stand {
                    reach_m: a.reach_m.max(b.reach_m),
                    slide_cm_s: a.slide_cm_s.max(b.slide_cm_s),
                    standing_percent: a.standing_percent.min(b.standing_percent),
                }),
                (a, b) => a.or(b),
            },
        }
    }

    /// How far the joint that leaves these ranges most is outside, rad or m; 0 if none does.
    pub fn outside(&self, rig: &Rig, clip: &Clip) -> f64 {
        let coordinates = rig.locals_of(clip).coordinates;
        let frames = coordinates.chunks_exact(self.coordinates.len().max(1));
        let places: Vec<_> = rig.frames().places().collect();
        let joint = |row: &[f64], first: usize, count: usize| {
            let past = |at: usize| {
                let [low, high] = self.coordinates[at];
                (low - row[at]).max(row[at] - high).max(0.0).powi(2)
            };
            (first..first + count).map(past).sum::<f64>().sqrt()
        };
        let frame = |row: &[f64]| places.iter().map(|(kind, first)| joint(row, *first, kind.coordinates())).fold(0.0, f64::max);
        nearly_largest(frames.map(frame).collect())
    }
}

impl Stand {
    fn of(rig: &Rig, clip: &Clip) -> Option<Self> {
        let legs = rig.frames().travels().then(|| Foot::of(&clip.skeleton, &rig.map)).unwrap_or_default();
        let feet: Vec<(Vec<Vector3<f64>>, Vec<bool>)> = legs
            .iter()
            .map(|foot| {
                let path = foot.path(clip);
                let stands = Foot::stands(&path, clip.fps(), foot.size(&clip.skeleton));
                (path, stands)
            })
            .collect();
        let reach = |frame: usize| {
            let centre = centre_of_mass(rig, &clip.positions(frame))?;
            let standing = feet.iter().filter(|(_, stands)| stands[frame]);
            standing.map(|(path, _)| (path[frame] - centre).xz().norm()).min_by(f64::total_cmp)
        };
        let reaches: Vec<f64> = (0..clip.frames()).filter_map(reach).collect();
        let Feet { slide_cm_s, standing_percent, .. } = Feet::of(clip, &rig.map);
        (!reaches.is_empty()).then(|| Self { reach_m: nearly_largest(reaches), slide_cm_s, standing_percent })
    }

    fn mean(all: &[Self]) -> Option<Self> {
        let mean = |of: fn(&Self) -> f64| all.iter().map(of).sum::<f64>() / all.len() as f64;
        (!all.is_empty()).then(|| Self {
            reach_m: all.iter().map(|stand| stand.reach_m).fold(0.0, f64::max),
            slide_cm_s: mean(|s| s.slide_cm_s),
            standing_percent: mean(|s| s.standing_percent),
        })
    }
}

/// Where the mass is: trunk and head between hips and shoulders, an arm at its elbow, a leg at its knee.
fn centre_of_mass(rig: &Rig, positions: &[Vector3<f64>]) -> Option<Vector3<f64>> {
    use Canonical::*;
    let at = |joint: Canonical| rig.map.joint(joint).map(|joint| positions[joint]);
    let trunk = (at(LHip)? + at(RHip)? + at(LShoulder)? + at(RShoulder)?) / 4.0;
    let limbs = (at(LElbow)? + at(RElbow)?) * ARM + (at(LKnee)? + at(RKnee)?) * LEG;
    Some(trunk * TRUNK + limbs)
}

fn nearly_largest(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let last = values.len().saturating_sub(1) as f64;
    values.get(((1.0 - OUTLIERS) * last).round() as usize).copied().unwrap_or(0.0)
}

/// Fastest joint, m a frame.
fn top_speed(locals: &Locals) -> f64 {
    let frames = locals.positions.chunks_exact(locals.channels().max(1));
    let steps = frames.clone().zip(frames.skip(1)).flat_map(|(a, b)| {
        let joints = a.as_chunks::<3>().0.iter().zip(b.as_chunks::<3>().0);
        joints.map(|(a, b)| a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>())
    });
    steps.fold(0.0, f64::max).sqrt()
}

/// Sum of the squared third derivatives of all joints, and how many joints and frames that is.
fn jerk(locals: &Locals, fps: f64) -> (f64, usize) {
    let frames: Vec<&[f64]> = locals.positions.chunks_exact(locals.channels().max(1)).collect();
    let square = |window: &[&[f64]]| {
        let third = |at: usize| window[3][at] - 3.0 * window[2][at] + 3.0 * window[1][at] - window[0][at];
        (0..locals.channels()).map(|at| third(at).powi(2)).sum::<f64>()
    };
    let sum = frames.windows(4).map(square).sum::<f64>() * fps.powi(6);
    (sum, frames.len().saturating_sub(3) * locals.channels() / 3)
}
