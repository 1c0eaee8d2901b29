//! Why a limb is off: what the robot cannot do.

use super::Aim;
use super::report::share;
use super::solve::Solver;

/// A limb that is off by more than this counts as off, degrees.
const FAR: f64 = 10.0;
/// From this share of the frames it is said.
const OFTEN: f64 = 0.05;
/// A joint at a limit in this share of those frames is named.
const MOSTLY: f64 = 0.5;
/// Speed limits that cost more than this are said, degrees.
const LATE: f64 = 2.0;

/// A sentence for a limb that is often off. `reachable` and `played` are its errors by frame, degrees.
pub(super) fn say(
    solver: &Solver,
    index: usize,
    aim: &Aim,
    path: &[Vec<f64>],
    reachable: &[Option<f64>],
    played: &[Option<f64>],
) -> Vec<String> {
    let mut said = Vec::new();
    let off: Vec<&Vec<f64>> = path
        .iter()
        .zip(reachable)
        .filter(|(_, error)| error.is_some_and(|error| error > FAR))
        .map(|(x, _)| x)
        .collect();
    let part = off.len() as f64 / reachable.iter().flatten().count().max(1) as f64;
    if part >= OFTEN {
        let why = cause(solver, index, &off);
        said.push(format!("{}: more than {FAR} degrees off in {:.0} % of the frames; {why}", aim.name, 100.0 * part));
    }
    let [could, does] = [reachable, played].map(|errors| share(errors, 0.95));
    if does > could + LATE {
        said.push(format!(
            "{}: speed limits take it from {could:.1} to {does:.1} degrees off (95 % of the frames)",
            aim.name
        ));
    }
    said
}

/// What stands in the way of an arrow at these poses.
fn cause(solver: &Solver, index: usize, off: &[&Vec<f64>]) -> String {
    let body = solver.body;
    let moving = solver.movers(index);
    let name = |variable: usize| body.robot.joints[body.variables[variable].joint].name.as_str();
    let mut at_limit = Vec::new();
    for &at in &moving {
        let variable = &body.variables[at];
        for (limit, count) in [
            ("lower", off.iter().filter(|values| variable.at_lower(values[at])).count()),
            ("upper", off.iter().filter(|values| variable.at_upper(values[at])).count()),
        ] {
            if count as f64 >= MOSTLY * off.len() as f64 {
                at_limit.push(format!("{} ({limit})", name(at)));
            }
        }
    }
    let names = moving.iter().map(|at| name(*at)).collect::<Vec<_>>().join(", ");
    match (at_limit.is_empty(), moving.len()) {
        (_, 0) => "no joint moves it".to_owned(),
        (false, _) => format!("at a limit then: {}", at_limit.join(", ")),
        (true, 1 | 2) => format!("it has no other joints than {names}"),
        (true, _) => format!("its joints do not turn there, or other limbs need them: {names}"),
    }
}
