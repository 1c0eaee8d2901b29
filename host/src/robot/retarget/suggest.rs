//! A map from names and geometry: for robots whose joints are called what they are.

use std::fmt::Write;

use nalgebra::{Isometry3, Vector3};

use super::Limb;
use super::body::small;
use crate::robot::{Motion, Robot, RobotError};

/// Points nearer than this to each other show no direction, m.
const SHORTEST: f64 = 0.02;
/// An axis this near to a limb (cosine) twists it.
const ALONG: f64 = 0.9;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Part {
    Shoulder,
    Elbow,
    Wrist,
    Hip,
    Knee,
    Ankle,
    Head,
    Torso,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Side {
    Left,
    Right,
    Middle,
}

/// A map (TOML) for a robot, by the names of its joints: left and right (or l and r), shoulder, elbow, wrist, hip, knee, ankle, neck,
/// head, waist, torso, and by where they are. Comments say what is missing.
///
/// Refused where no limb is found.
pub fn suggest(robot: &Robot) -> Result<String, RobotError> {
    small(robot)?;
    let frames = robot.frames();
    let mut groups: Vec<(Side, Part, Vec<usize>)> = Vec::new();
    let mut depth: Vec<(usize, usize)> = (0..robot.joints.len()).map(|at| (robot.chain(at).count(), at)).collect();
    depth.sort_unstable();
    for (_, at) in depth {
        let joint = &robot.joints[at];
        if matches!(joint.motion, Motion::Fixed | Motion::Other(_)) || joint.mimic.is_some() {
            continue;
        }
        let Some((side, part)) = part(&joint.name).or_else(|| part(&joint.child)) else { continue };
        match groups.iter_mut().find(|(s, p, _)| (*s, *p) == (side, part)) {
            Some((_, _, joints)) => joints.push(at),
            None => groups.push((side, part, vec![at])),
        }
    }
    // A single arm without sides is taken to be the right one.
    let sided = groups.iter().any(|(side, part, _)| *side != Side::Middle && !matches!(part, Part::Head | Part::Torso));
    let group = |side: Side, part: Part| -> &[usize] {
        let side = if !sided && side == Side::Right { Side::Middle } else { side };
        groups.iter().find(|(s, p, _)| (*s, *p) == (side, part)).map_or(&[], |(_, _, joints)| joints)
    };
    let mut out =
        String::from("# Which parts of the robot are which limbs: joints or links, from the trunk outwards.\n");
    let [forward, up] = axes(&frames, &groups);
    let _ = writeln!(out, "forward = \"{forward}\"\nup = \"{up}\"\n[limbs]");
    let mut found = 0;
    let name = |at: usize| toml::Value::String(robot.joints[at].name.clone()).to_string();
    let mut write = |limb: Limb, value: Option<String>, missing: &str| {
        let _ = match value {
            Some(value) => {
                found += 1;
                writeln!(out, "{} = {value}", limb.name())
            }
            None => writeln!(out, "# {}: {missing}", limb.name()),
        };
    };
    // Only what carries a shoulder or a head is a trunk.
    let carries = |at: usize| {
        let outer = groups.iter().filter(|(_, part, _)| matches!(part, Part::Shoulder | Part::Head));
        outer.flat_map(|(_, _, joints)| joints).any(|joint| robot.chain(*joint).any(|on| on == at))
    };
    let torso = group(Side::Middle, Part::Torso).iter().rev().copied().find(|at| carries(*at));
    write(Limb::Torso, torso.map(name), "found no waist joint that carries shoulders or a head");
    write(Limb::Head, group(Side::Middle, Part::Head).last().copied().map(name), "found no neck or head joint");
    let sides = [
        (Side::Left, [Limb::LUpperArm, Limb::LForearm, Limb::LHand, Limb::LThigh, Limb::LShin, Limb::LFoot]),
        (Side::Right, [Limb::RUpperArm, Limb::RForearm, Limb::RHand, Limb::RThigh, Limb::RShin, Limb::RFoot]),
    ];
    for (side, [upper, fore, hand, thigh, shin, foot]) in sides {
        let [shoulder, elbow, wrist] = [Part::Shoulder, Part::Elbow, Part::Wrist].map(|part| group(side, part));
        let [hip, knee, ankle] = [Part::Hip, Part::Knee, Part::Ankle].map(|part| group(side, part));
        let two = |ends: Option<(usize, usize)>| ends.map(|(from, to)| format!("[{}, {}]", name(from), name(to)));
        let missing = "found no two joints for it";
        write(upper, two(between(robot, &frames, shoulder, elbow)), missing);
        let last = |joints: &[usize]| tip(robot, &frames, joints);
        let forearm = two(between(robot, &frames, elbow, wrist)).or_else(|| last(elbow));
        write(fore, forearm, missing);
        // A hand that only turns about the forearm points nowhere of its own.
        let bends = |at: &&usize| {
            let way = elbow.last().map(|elbow| place(&frames, **at) - place(&frames, *elbow));
            way.and_then(|way| way.try_normalize(SHORTEST))
                .is_none_or(|way| axis(robot, &frames, **at).dot(&way).abs() < ALONG)
        };
        let bent = wrist.iter().any(|at| bends(&at));
        write(hand, last(wrist).filter(|_| bent), "found no wrist that bends, or nothing beyond it");
        write(thigh, two(between(robot, &frames, hip, knee)), missing);
        let shank = two(between(robot, &frames, knee, ankle)).or_else(|| last(knee));
        write(shin, shank, missing);
        write(foot, ankle.last().copied().map(name), "found no ankle joint");
    }
    if found == 0 {
        let names: Vec<&str> = robot.joints.iter().map(|joint| joint.name.as_str()).take(12).collect();
        let what =
            format!("found no limb by the names of its {} joints ({}, ...)", robot.joints.len(), names.join(", "));
        return Err(RobotError::new("the robot", what, "write the map by hand: kinesic robot retarget --help has one"));
    }
    if !sided {
        out.push_str("# No name has a side: the arm is taken to be the right one.\n");
    }
    Ok(out)
}

/// Where the robot faces and where up is: from right to left, and from the legs to the arms; x and z unless these say otherwise.
fn axes(frames: &[Isometry3<f64>], groups: &[(Side, Part, Vec<usize>)]) -> [&'static str; 2] {
    const NAMES: [&str; 6] = ["x", "-x", "y", "-y", "z", "-z"];
    let ways = [Vector3::x(), -Vector3::x(), Vector3::y(), -Vector3::y(), Vector3::z(), -Vector3::z()];
    // An axis that a direction is clearly nearest to.
    let nearest = |way: Vector3<f64>| {
        let way = way.try_normalize(SHORTEST)?;
        ways.iter().position(|axis| axis.dot(&way) > 0.8)
    };
    let middle = |wanted: &dyn Fn(Side, Part) -> bool| {
        let joints: Vec<usize> = groups
            .iter()
            .filter(|(side, part, _)| wanted(*side, *part))
            .flat_map(|(_, _, joints)| joints.clone())
            .collect();
        let sum: Vector3<f64> = joints.iter().map(|at| place(frames, *at)).sum();
        (!joints.is_empty()).then(|| sum / joints.len() as f64)
    };
    let legs = middle(&|_, part| matches!(part, Part::Knee | Part::Ankle));
    let top =
        middle(&|_, part| matches!(part, Part::Shoulder | Part::Head)).or_else(|| middle(&|_, part| part == Part::Hip));
    let up = legs.zip(top).and_then(|(legs, top)| nearest(top - legs)).unwrap_or(4);
    let pairs = [Part::Hip, Part::Shoulder];
    let left = pairs.into_iter().find_map(|part| {
        let at = |wanted: Side| middle(&|side, found| (side, found) == (wanted, part));
        nearest(at(Side::Left)? - at(Side::Right)?)
    });
    let forward = left.and_then(|left| nearest(ways[left].cross(&ways[up]))).unwrap_or(if up < 2 { 2 } else { 0 });
    [NAMES[forward], NAMES[up]]
}

fn place(frames: &[Isometry3<f64>], at: usize) -> Vector3<f64> {
    frames[at].translation.vector
}

fn axis(robot: &Robot, frames: &[Isometry3<f64>], at: usize) -> Vector3<f64> {
    frames[at].rotation * robot.joints[at].axis
}

/// Two joints that a limb is between: hinges across it where there are any, the last of the inner ones and the first of the outer ones. What
/// lies beyond a joint that twists the limb may stand off its axis, and goes round with it.
fn between(robot: &Robot, frames: &[Isometry3<f64>], inner: &[usize], outer: &[usize]) -> Option<(usize, usize)> {
    let carried = |at: &usize| inner.iter().any(|on| robot.chain(*at).any(|carrier| carrier == *on));
    let outer: Vec<usize> = outer.iter().copied().filter(carried).collect();
    let start = place(frames, *inner.last()?);
    let far = |at: &&usize| (place(frames, **at) - start).norm() > SHORTEST;
    let across = |at: &&usize| axis(robot, frames, **at).dot(&(place(frames, **at) - start).normalize()).abs() < ALONG;
    let to = *outer.iter().filter(far).find(across).or_else(|| outer.iter().find(far))?;
    let end = place(frames, to);
    let way = |at: &usize| end - place(frames, *at);
    let own: Vec<usize> =
        inner.iter().copied().filter(|at| robot.chain(to).any(|on| on == *at) && way(at).norm() > SHORTEST).collect();
    let from = own.iter().rev().copied().find(|at| axis(robot, frames, *at).dot(&way(at).normalize()).abs() < ALONG);
    Some((from.or_else(|| own.last().copied())?, to))
}

/// The last bone of a limb: to the furthest link that its last joint carries, else to the centre of its mass.
fn tip(robot: &Robot, frames: &[Isometry3<f64>], joints: &[usize]) -> Option<String> {
    let name = |text: &str| toml::Value::String(text.to_owned()).to_string();
    let last = *joints.last()?;
    let start = place(frames, last);
    let far = |at: &usize| (place(frames, *at) - start).norm();
    let carried = (0..robot.joints.len()).filter(|at| *at != last && robot.chain(*at).any(|on| on == last));
    let end = carried.filter(|at| far(at) > SHORTEST).max_by(|a, b| far(a).total_cmp(&far(b)));
    let from = &robot.joints[last];
    match end {
        Some(end) => Some(format!("[{}, {}]", name(&from.name), name(&robot.joints[end].child))),
        None => {
            let way = frames[last].rotation * from.centre?.try_normalize(SHORTEST)?;
            Some(format!("{{ from = {}, bone = [{:.3}, {:.3}, {:.3}] }}", name(&from.name), way.x, way.y, way.z))
        }
    }
}

/// Side and part by a name's words.
fn part(name: &str) -> Option<(Side, Part)> {
    let words = words(name);
    let has = |all: &[&str]| words.iter().any(|word| all.contains(&word.as_str()));
    let side = match (has(&["left", "l"]), has(&["right", "r"])) {
        (true, false) => Side::Left,
        (false, true) => Side::Right,
        _ => Side::Middle,
    };
    let parts: [(Part, &[&str]); 9] = [
        (Part::Elbow, &["elbow", "forearm", "lowerarm"]),
        (Part::Shoulder, &["shoulder", "upperarm"]),
        (Part::Wrist, &["wrist", "hand"]),
        (Part::Knee, &["knee", "shin", "calf", "shank"]),
        (Part::Ankle, &["ankle", "foot"]),
        (Part::Hip, &["hip", "thigh"]),
        (Part::Head, &["head", "neck"]),
        (Part::Torso, &["waist", "torso", "spine", "chest", "abs", "bust", "trunk", "lumbar"]),
        (Part::Shoulder, &["arm"]),
    ];
    let (part, _) = parts.into_iter().find(|(_, all)| has(all))?;
    if has(&[
        "finger", "thumb", "index", "middle", "ring", "pinky", "little", "gripper", "proximal", "distal", "antenna",
    ]) {
        return None;
    }
    Some((side, part))
}

/// Words of a name in lower case: split at signs, digits, and before a capital that a small letter follows.
fn words(name: &str) -> Vec<String> {
    let letters: Vec<char> = name.chars().collect();
    let (mut words, mut word) = (Vec::new(), String::new());
    for (at, letter) in letters.iter().enumerate() {
        let begins = letter.is_uppercase()
            && (letters.get(at + 1).is_some_and(|next| next.is_lowercase())
                || at.checked_sub(1).is_some_and(|last| letters[last].is_lowercase()));
        if !letter.is_alphabetic() || begins {
            words.push(std::mem::take(&mut word));
        }
        if letter.is_alphabetic() {
            word.extend(letter.to_lowercase());
        }
    }
    words.push(word);
    words.retain(|word| !word.is_empty());
    words
}
