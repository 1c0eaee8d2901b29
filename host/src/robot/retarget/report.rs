//! How near a robot comes to a person.

use nalgebra::Vector3;
use serde::Serialize;

use super::path::Targets;
use super::solve::Solver;
use super::{Aim, cannot};
use crate::robot::{Motion, RobotJoint};

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
    /// Of arms and legs as a whole: 95th percentile of how far the distance of their ends is off, as a share of the stretched limb.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub length_p95: Option<f64>,
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

/// The joint that comes nearest to its speed limit.
#[derive(Clone, Debug, Serialize)]
pub struct Quickest {
    /// Its name.
    pub joint: String,
    /// Its largest speed from frame to frame, rad/s or m/s.
    pub speed: f64,
    /// That speed as a share of its limit, 0 to 1.
    pub share: f64,
}

/// How near the robot comes to the person.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Number of frames.
    pub frames: usize,
    /// Limbs in the order of [`Limb::ALL`](super::Limb::ALL), those that the clip has.
    pub limbs: Vec<LimbReport>,
    /// Values beyond a limit, followers' too: none.
    pub limits_exceeded: usize,
    /// Steps from frame to frame that are quicker than a speed limit: none.
    pub speeds_exceeded: usize,
    /// The joint nearest to its speed limit; none where no speed limit is known.
    pub quickest: Option<Quickest>,
    /// Joints that are at a limit in more than a fifth of the frames.
    pub at_limit: Vec<AtLimit>,
    /// What the robot cannot do, one sentence each.
    pub cannot: Vec<String>,
    /// What was assumed, one sentence each.
    pub notes: Vec<String>,
}

/// Share of frames from which a joint at its limit is named.
const OFTEN: f64 = 0.2;

/// Poses of the robot.
pub(super) struct Paths<'p> {
    /// That stays at zero.
    pub zero: &'p [f64],
    /// Before speed limits, every frame.
    pub reachable: &'p [Vec<f64>],
    /// As it is played.
    pub played: &'p [Vec<f64>],
}

/// `hurried` are variables that would be too quick.
pub(super) fn make(
    solver: &Solver,
    aims: &[Aim],
    targets: &Targets,
    paths: &Paths,
    hurried: &[usize],
    frame_time: f64,
) -> Report {
    let (body, robot, path) = (solver.body, solver.body.robot, paths.played);
    let errors = |values: &dyn Fn(usize) -> Vec<f64>, measure: fn(&Vector3<f64>, &Vector3<f64>) -> f64| {
        let mut all: Vec<Vec<Option<f64>>> = vec![Vec::new(); aims.len()];
        for (frame, targets) in targets.iter().enumerate() {
            let frames = body.placed(&values(frame));
            for ((all, term), target) in all.iter_mut().zip(&solver.terms).zip(targets) {
                all.push(target.map(|target| measure(&body.arrow(&frames, term.arrow), &target)));
            }
        }
        all
    };
    let played = errors(&|frame| path[frame].clone(), angle);
    let could = errors(&|frame| paths.reachable[frame].clone(), angle);
    let still = errors(&|_| paths.zero.to_vec(), angle);
    let longer = errors(&|frame| path[frame].clone(), |a, b| (a.norm() - b.norm()).abs());
    let (mut notes, mut cannot, mut limbs) = (Vec::new(), Vec::new(), Vec::new());
    for (at, aim) in aims.iter().enumerate() {
        if played[at].iter().all(Option::is_none) {
            notes.push(format!("{}: the clip does not say where it points, left out", aim.name));
            continue;
        }
        cannot.extend(cannot::say(solver, at, aim, paths.reachable, &could[at], &played[at]));
        limbs.push(LimbReport {
            limb: aim.name.clone(),
            median: share(&played[at], 0.5),
            p95: share(&played[at], 0.95),
            reachable_median: share(&could[at], 0.5),
            reachable_p95: share(&could[at], 0.95),
            zero_median: share(&still[at], 0.5),
            zero_p95: share(&still[at], 0.95),
            length_p95: aim.limb.reaches().then(|| share(&longer[at], 0.95)),
        });
    }
    let part = |count: usize| count as f64 / path.len().max(1) as f64;
    if !hurried.is_empty() {
        let names: Vec<&str> = hurried.iter().map(|at| robot.joints[body.variables[*at].joint].name.as_str()).collect();
        cannot.push(format!("to follow without speed limits, these would have to be quicker: {}", names.join(", ")));
    }
    let (mut at_limit, mut limits_exceeded) = (Vec::new(), followers_beyond(solver, path));
    let (mut speeds_exceeded, mut quickest): (usize, Option<Quickest>) = (0, None);
    for (at, variable) in body.variables.iter().enumerate() {
        let (name, values) = (&robot.joints[variable.joint].name, || path.iter().map(|values| values[at]));
        limits_exceeded += values().filter(|value| !(variable.lower..=variable.upper).contains(value)).count();
        let speeds = || values().zip(values().skip(1)).map(|(a, b)| (b - a).abs() / frame_time);
        speeds_exceeded += speeds().filter(|speed| *speed > variable.velocity).count();
        let speed = speeds().fold(0.0, f64::max);
        let of_limit = speed / variable.velocity;
        if variable.velocity.is_finite() && quickest.as_ref().is_none_or(|other| of_limit > other.share) {
            quickest = Some(Quickest { joint: name.clone(), speed, share: of_limit });
        }
        if !solver.active.contains(&at) {
            continue;
        }
        for (limit, count) in [
            ("lower", values().filter(|value| variable.at_lower(*value)).count()),
            ("upper", values().filter(|value| variable.at_upper(*value)).count()),
        ] {
            if part(count) > OFTEN {
                at_limit.push(AtLimit { joint: name.clone(), limit, share: part(count) });
            }
        }
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
    notes.extend(body.notes.iter().chain(&robot.notes).cloned());
    notes.extend(robot.joints.iter().flat_map(|joint| &joint.notes).cloned());
    Report { frames: path.len(), limbs, limits_exceeded, speeds_exceeded, quickest, at_limit, cannot, notes }
}

/// Followers' values beyond their own limits.
fn followers_beyond(solver: &Solver, path: &[Vec<f64>]) -> usize {
    let joints = solver.body.robot.joints.iter().enumerate();
    let followers = joints.filter(|(_, joint)| joint.mimic.is_some() && joint.motion != Motion::Continuous);
    let beyond = |(at, joint): (usize, &RobotJoint)| {
        let bounds = joint.lower.unwrap_or(f64::NEG_INFINITY)..=joint.upper.unwrap_or(f64::INFINITY);
        path.iter().filter(|values| !bounds.contains(&solver.body.joint_value(at, values))).count()
    };
    followers.map(beyond).sum()
}

/// Degrees between two directions.
fn angle(a: &Vector3<f64>, b: &Vector3<f64>) -> f64 {
    a.cross(b).norm().atan2(a.dot(b)).to_degrees()
}

/// The error that so large a share of the frames stays below.
pub(super) fn share(errors: &[Option<f64>], share: f64) -> f64 {
    let mut sorted: Vec<f64> = errors.iter().flatten().copied().collect();
    sorted.sort_by(f64::total_cmp);
    let at = (share * sorted.len().saturating_sub(1) as f64).round() as usize;
    sorted.get(at).copied().unwrap_or(0.0)
}
