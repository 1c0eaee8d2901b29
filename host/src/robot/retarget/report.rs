//! How near a robot comes to a person, and the table of its values.

use std::fmt::Write;

use nalgebra::Vector3;
use serde::Serialize;

use super::path::Targets;
use super::solve::Solver;
use super::{Aim, Retargeted};
use crate::clip::Clip;
use crate::robot::{Motion, Robot};

/// Angle between a limb of the robot and the person's, degrees.
#[derive(Clone, Debug, Serialize)]
pub struct LimbReport {
    /// Name of the limb; `torso_facing` and `head_top` are the second arrows of torso and head.
    pub limb: String,
    /// Median over the frames.
    pub median: f64,
    /// 95th percentile.
    pub p95: f64,
    /// The same before speed limits: what the joints can reach.
    pub reachable_median: f64,
    /// See `reachable_median`.
    pub reachable_p95: f64,
    /// Median of the robot that stays at zero.
    pub zero_median: f64,
    /// 95th percentile of the same.
    pub zero_p95: f64,
}

/// A joint at a limit.
#[derive(Clone, Debug, Serialize)]
pub struct AtLimit {
    /// Its name.
    pub joint: String,
    /// Which limit.
    pub limit: &'static str,
    /// Share of the frames, 0 to 1.
    pub share: f64,
}

/// How near the robot comes to the person.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Number of frames.
    pub frames: usize,
    /// Limbs in the order of [`Limb::ALL`](super::Limb::ALL), those that the clip has.
    pub limbs: Vec<LimbReport>,
    /// Values beyond a limit: none.
    pub limits_exceeded: usize,
    /// Joints that are at a limit in more than a fifth of the frames.
    pub at_limit: Vec<AtLimit>,
    /// What the robot cannot do and what was assumed, one sentence each.
    pub notes: Vec<String>,
}

/// Share of frames from which a joint at its limit is named.
const OFTEN: f64 = 0.2;

#[allow(clippy::too_many_arguments)]
pub(super) fn make(
    solver: &Solver,
    aims: &[Aim],
    targets: &Targets,
    zero: &[f64],
    reachable: &[Vec<f64>],
    path: &[Vec<f64>],
    hurried: &[(usize, usize)],
    clip: &Clip,
) -> Report {
    let (body, robot) = (solver.body, solver.body.robot);
    let errors = |values: &dyn Fn(usize) -> Vec<f64>| {
        let mut all: Vec<Vec<f64>> = vec![Vec::new(); aims.len()];
        for (frame, targets) in targets.iter().enumerate() {
            let frames = body.placed(&values(frame));
            for ((all, term), target) in all.iter_mut().zip(&solver.terms).zip(targets) {
                all.extend(target.map(|target| angle(&body.arrow(&frames, term.arrow), &target)));
            }
        }
        all.iter_mut().for_each(|all| all.sort_by(f64::total_cmp));
        all
    };
    let (played, could, still) =
        (errors(&|frame| path[frame].clone()), errors(&|frame| reachable[frame].clone()), errors(&|_| zero.to_vec()));
    let mut notes = Vec::new();
    let mut limbs = Vec::new();
    for (at, aim) in aims.iter().enumerate() {
        if played[at].is_empty() {
            notes.push(format!("{}: the clip does not say where it points, left out", aim.name));
            continue;
        }
        if solver.terms[at].movers.is_empty() {
            notes.push(format!("{}: no joint of the robot moves it", aim.name));
        }
        limbs.push(LimbReport {
            limb: aim.name.clone(),
            median: share(&played[at], 0.5),
            p95: share(&played[at], 0.95),
            reachable_median: share(&could[at], 0.5),
            reachable_p95: share(&could[at], 0.95),
            zero_median: share(&still[at], 0.5),
            zero_p95: share(&still[at], 0.95),
        });
    }
    let (mut at_limit, mut exceeded) = (Vec::new(), 0);
    let share_of = |count: usize| count as f64 / path.len().max(1) as f64;
    for (at, variable) in body.variables.iter().enumerate() {
        let values = || path.iter().map(|values| values[at]);
        exceeded += values().filter(|value| !(variable.lower..=variable.upper).contains(value)).count();
        if !solver.active.contains(&at) {
            continue;
        }
        for (limit, count) in [
            ("lower", values().filter(|value| *value <= variable.lower + 1e-6).count()),
            ("upper", values().filter(|value| *value >= variable.upper - 1e-6).count()),
        ] {
            if share_of(count) > OFTEN {
                at_limit.push(AtLimit {
                    joint: robot.joints[variable.joint].name.clone(),
                    limit,
                    share: share_of(count),
                });
            }
        }
    }
    exceeded += followers_beyond(solver, path);
    for (joint, count) in hurried {
        let what = "it would have to be quicker than its speed limit; it sets out early and arrives late";
        notes.push(format!(
            "{}: {what} (in {:.0} % of the frames)",
            robot.joints[*joint].name,
            100.0 * share_of(*count)
        ));
    }
    let idle: Vec<&str> = (0..body.variables.len())
        .filter(|at| !solver.active.contains(at))
        .map(|at| robot.joints[body.variables[at].joint].name.as_str())
        .collect();
    if !idle.is_empty() {
        notes.push(format!("no limb of the map asks for {}: at zero, or held", idle.join(", ")));
    }
    if body.variables.iter().any(|variable| variable.velocity.is_infinite()) {
        notes.push("joints without a speed in the description are as quick as the person".to_owned());
    }
    if path.len() != clip.frames() {
        notes.push("frames are missing".to_owned());
    }
    notes.extend(robot.notes.iter().chain(robot.joints.iter().flat_map(|joint| &joint.notes)).cloned());
    Report { frames: path.len(), limbs, limits_exceeded: exceeded, at_limit, notes }
}

/// Followers' values beyond their own limits.
fn followers_beyond(solver: &Solver, path: &[Vec<f64>]) -> usize {
    let joints = solver.body.robot.joints.iter().enumerate();
    let followers = joints.filter(|(_, joint)| joint.mimic.is_some() && joint.motion != Motion::Continuous);
    let beyond = |(at, joint): (usize, &crate::robot::RobotJoint)| {
        let bounds = joint.lower.unwrap_or(f64::NEG_INFINITY)..=joint.upper.unwrap_or(f64::INFINITY);
        path.iter().filter(|values| !bounds.contains(&solver.body.joint_value(at, values))).count()
    };
    followers.map(beyond).sum()
}

/// Degrees between two directions.
fn angle(a: &Vector3<f64>, b: &Vector3<f64>) -> f64 {
    a.cross(b).norm().atan2(a.dot(b)).to_degrees()
}

fn share(sorted: &[f64], share: f64) -> f64 {
    let at = (share * sorted.len().saturating_sub(1) as f64).round() as usize;
    sorted.get(at).copied().unwrap_or(0.0)
}

impl Retargeted {
    /// Number of frames.
    pub fn frames(&self) -> usize {
        self.values.len().checked_div(self.joints.len()).unwrap_or(0)
    }

    /// The table: `time_s`, then `NAME_rad` of every hinge and `NAME_m` of every slider that leads. Six decimals, more where rounding
    /// would leave the limits.
    pub fn csv(&self, robot: &Robot) -> String {
        let mut out = String::from("time_s");
        for &at in &self.joints {
            let joint = &robot.joints[at];
            let unit = if joint.motion == Motion::Prismatic { "m" } else { "rad" };
            let name = format!("{}_{unit}", joint.name);
            let quoted = name.contains([',', '"', '\n', '\r']);
            let name = if quoted { format!("\"{}\"", name.replace('"', "\"\"")) } else { name };
            let _ = write!(out, ",{name}");
        }
        // Cut towards zero, a value stays between zero and itself: where zero is allowed, and no follower has limits of its own, that is
        // within the limits.
        let follows = robot.joints.iter().any(|joint| joint.mimic.is_some());
        let cut: Vec<bool> = self
            .joints
            .iter()
            .map(|at| {
                let joint = &robot.joints[*at];
                !follows && joint.lower.unwrap_or(-1.0) <= 0.0 && joint.upper.unwrap_or(1.0) >= 0.0
            })
            .collect();
        for (frame, values) in self.values.chunks(self.joints.len().max(1)).enumerate() {
            let _ = write!(out, "\n{:.6}", frame as f64 * self.frame_time);
            for (value, cut) in values.iter().zip(&cut) {
                // Writing to a String cannot fail.
                let _ = match cut {
                    true => write!(out, ",{:.6}", (value * 1e6).trunc() / 1e6 + 0.0),
                    false => write!(out, ",{value}"),
                };
            }
        }
        out.push('\n');
        out
    }
}
