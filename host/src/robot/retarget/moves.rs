//! What came of a motion on a robot: values of its joints, and how far its limbs are from the person's.

use std::fmt::Write;

use nalgebra::Vector3;
use serde::Serialize;

use super::map::Limb;
use super::reach::Reach;
use crate::robot::{Motion, Robot};

/// A joint that is at a bound in more than this part of the frames is told.
const OFTEN: f64 = 0.1;
/// This near to a bound is at it, rad.
const AT: f64 = 1e-9;

/// How well one limb follows, degrees over all frames.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LimbFigures {
    /// Its name in the map.
    pub limb: String,
    /// Joints of the robot that turn it; where there are none it stays as it is.
    pub joints: usize,
    /// Half of the frames are this near to the person's direction, or nearer.
    pub median: f64,
    /// 95 of 100 frames are.
    pub percentile_95: f64,
    /// The median of the robot that stands at its zero.
    pub zero_median: f64,
}

/// A motion of a robot: one row of values a frame.
#[derive(Clone, Debug)]
pub struct Moves {
    /// Names of the movable joints that follow no other, in the order of [`Robot::depth_first`].
    pub joints: Vec<String>,
    /// Whether each is a slider, in metres; the others are in radians.
    pub sliders: Vec<bool>,
    /// Row-major `[frames x joints]`, rad or m.
    pub values: Vec<f64>,
    /// Seconds between frames.
    pub frame_time: f64,
    /// Every limb that was compared, in the map's order.
    pub limbs: Vec<LimbFigures>,
    /// Joints at a bound in more than a tenth of the frames, with that part of them.
    pub at_bounds: Vec<(String, f64)>,
    /// Values beyond the description's bounds, which there are not.
    pub exceeded: usize,
    /// What was assumed or left out, one sentence each.
    pub notes: Vec<String>,
}

impl Moves {
    /// Number of frames.
    pub fn frames(&self) -> usize {
        self.values.len() / self.joints.len().max(1)
    }

    /// The table: `time_s,JOINT_rad,...` (sliders `JOINT_m`), one line a frame. Values are written whole: none rounds beyond a bound.
    pub fn to_csv(&self) -> String {
        let mut text = String::from("time_s");
        for (name, slider) in self.joints.iter().zip(&self.sliders) {
            let column = format!("{name}_{}", if *slider { "m" } else { "rad" });
            let plain = !column.contains([',', '"', '\n', '\r']);
            text.push(',');
            text.push_str(&if plain { column } else { format!("\"{}\"", column.replace('"', "\"\"")) });
        }
        for (frame, row) in self.values.chunks(self.joints.len().max(1)).enumerate() {
            // Writing to a String cannot fail.
            let _ = write!(text, "\n{:.6}", frame as f64 * self.frame_time);
            row.iter().for_each(|value| {
                // No negative zero.
                let _ = write!(text, ",{}", value + 0.0);
            });
        }
        text.push('\n');
        text
    }
}

/// Gathers frames.
pub(super) struct Tally {
    limbs: Vec<Limb>,
    /// By limb: degrees, as it moves and as it stands.
    errors: Vec<[Vec<f64>; 2]>,
    standing: Vec<Option<Vector3<f64>>>,
    /// By column: frames at a bound.
    at: Vec<usize>,
    rows: Vec<Vec<f64>>,
}

impl Tally {
    pub fn new(reach: &Reach, limbs: &[Limb]) -> Self {
        Self {
            limbs: limbs.to_vec(),
            errors: vec![[Vec::new(), Vec::new()]; limbs.len()],
            standing: reach.directions(&reach.start()),
            at: vec![0; reach.columns.len()],
            rows: Vec::new(),
        }
    }

    pub fn add(&mut self, reach: &Reach, goals: &[Option<Vector3<f64>>], columns: &[f64]) {
        let ways = reach.directions(columns);
        for (limb, errors) in self.errors.iter_mut().enumerate() {
            for (way, errors) in [ways[limb], self.standing[limb]].into_iter().zip(errors) {
                if let (Some(way), Some(goal)) = (way, goals[limb]) {
                    errors.push(way.cross(&goal).norm().atan2(way.dot(&goal)).to_degrees());
                }
            }
        }
        for ((count, value), [lower, upper]) in self.at.iter_mut().zip(columns).zip(&reach.bounds) {
            *count += usize::from(*value <= lower + AT || *value >= upper - AT);
        }
        self.rows.push(columns.to_vec());
    }

    pub fn finish(self, robot: &Robot, reach: &Reach, frame_time: f64, mut notes: Vec<String>) -> Moves {
        let order: Vec<usize> = robot.depth_first().into_iter().filter(|at| robot.leads(*at)).collect();
        let mut column = vec![None; robot.joints.len()];
        for (at, joint) in reach.columns.iter().enumerate() {
            column[*joint] = Some(at);
        }
        let value = |row: &[f64], joint: usize| column[joint].map_or(reach.rest[joint], |at| row[at]);
        let values: Vec<f64> = self.rows.iter().flat_map(|row| order.iter().map(|at| value(row, *at))).collect();
        let sliders: Vec<bool> = order.iter().map(|at| robot.joints[*at].motion == Motion::Prismatic).collect();
        let still: Vec<&str> =
            order.iter().filter(|at| column[**at].is_none()).map(|at| robot.joints[*at].name.as_str()).collect();
        if !still.is_empty() {
            notes.push(format!("stay where they are, as they turn no mapped limb or slide: {}", still.join(", ")));
        }
        let beyond = |(at, value): (&usize, &f64)| {
            let joint = &robot.joints[*at];
            joint.motion != Motion::Continuous
                && (joint.lower.is_some_and(|lower| *value < lower) || joint.upper.is_some_and(|upper| *value > upper))
        };
        let exceeded = order.iter().cycle().zip(&values).filter(|pair| beyond(*pair)).count();
        let frames = self.rows.len().max(1) as f64;
        let often = |(at, count): (usize, &usize)| {
            let part = *count as f64 / frames;
            (part > OFTEN).then(|| (robot.joints[reach.columns[at]].name.clone(), part))
        };
        let mut limbs = Vec::new();
        for (at, (limb, [mut moved, mut stood])) in self.limbs.iter().zip(self.errors).enumerate() {
            limbs.push(LimbFigures {
                limb: limb.name().to_owned(),
                joints: reach.joints_of(at),
                median: part_of(&mut moved, 0.5),
                percentile_95: part_of(&mut moved, 0.95),
                zero_median: part_of(&mut stood, 0.5),
            });
        }
        Moves {
            joints: order.iter().map(|at| robot.joints[*at].name.clone()).collect(),
            sliders,
            values,
            frame_time,
            limbs,
            at_bounds: self.at.iter().enumerate().filter_map(often).collect(),
            exceeded,
            notes,
        }
    }
}

/// The value that this part of all values does not exceed; 0 of none.
fn part_of(values: &mut [f64], part: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    let at = (part * values.len() as f64).ceil() as usize;
    values.get(at.saturating_sub(1)).copied().unwrap_or(0.0)
}
