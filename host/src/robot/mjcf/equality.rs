//! `<equality>`: joints that follow joints, and loops that a tree does not keep.

use std::collections::HashMap;

use super::super::{Mimic, RobotError, RobotJoint};
use super::source::Source;

/// Makes followers of what `<equality><joint>` couples. `references` are the coordinates at which the joints were drawn.
pub(super) fn follow(
    source: &Source,
    joints: &mut [RobotJoint],
    references: &[f64],
    notes: &mut Vec<String>,
) -> Result<(), RobotError> {
    let index: HashMap<String, usize> = joints.iter().zip(0..).map(|(joint, at)| (joint.name.clone(), at)).collect();
    let mut leaders: Vec<Option<usize>> = vec![None; joints.len()];
    for section in source.sections("equality") {
        for &at in &source.at(section).children {
            let place = source.place(at);
            let tag = source.at(at).tag.as_str();
            if tag != "joint" {
                notes.push(format!("{place}: it closes a loop, which is not kept"));
                continue;
            }
            if source.get(at, "active") == Some("false") {
                notes.push(format!("{place}: not active, left out"));
                continue;
            }
            let find = |name: &str| {
                index.get(name).copied().ok_or_else(|| {
                    let what = format!("its joint '{name}' is not in the file, which has {} joints", joints.len());
                    RobotError::new(&place, what, "correct the name")
                })
            };
            let Some(one) = source.get(at, "joint1") else {
                return Err(RobotError::new(place, "found no joint1, expected a joint's name", "name it"));
            };
            let one = find(one)?;
            let all = source.numbers(at, "polycoef")?.unwrap_or_else(|| vec![0.0, 1.0]);
            let coefficient = |power: usize| all.get(power).copied().unwrap_or(0.0);
            let Some(two) = source.get(at, "joint2") else {
                let value = references[one] + coefficient(0);
                let joint = &mut joints[one];
                (joint.lower, joint.upper) = (Some(value), Some(value));
                joint.notes.push(format!("{}: an equality holds it at {value}", joint.name));
                continue;
            };
            let two = find(two)?;
            if (2..5).any(|power| coefficient(power) != 0.0) {
                notes.push(format!("{place}: not linear, what follows '{}' is not kept", joints[two].name));
                continue;
            }
            let mut way = std::iter::successors(Some(two), |at| leaders[*at]);
            if leaders[one].is_some() || way.any(|at| at == one) {
                notes.push(format!("{place}: '{}' leads or follows already, left out", joints[one].name));
                continue;
            }
            leaders[one] = Some(two);
            let multiplier = coefficient(1);
            joints[one].mimic = Some(Mimic {
                joint: joints[two].name.clone(),
                multiplier,
                offset: references[one] + coefficient(0) - multiplier * references[two],
            });
        }
    }
    Ok(())
}
