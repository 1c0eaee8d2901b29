//! A map from what a robot's joints are called and where they are.

use nalgebra::{Isometry3, Vector3};

use super::map::{Base, End, Limb, LimbEntry, LimbMap, direction};
use crate::robot::{Motion, Robot, RobotError};

/// Points nearer than this show no direction, m.
const SHORT: f64 = 0.02;
/// An axis of a link this near to a direction (cosine) is that direction.
const ALONG: f64 = 0.9;

/// Words for parts of the body, in names of joints. A name with several is the first one's.
const PARTS: [(Part, &[&str]); 8] = [
    (Part::Shoulder, &["shoulder"]),
    (Part::Elbow, &["elbow"]),
    (Part::Wrist, &["wrist"]),
    (Part::Ankle, &["ankle", "foot"]),
    (Part::Knee, &["knee"]),
    (Part::Hip, &["hip", "thigh"]),
    (Part::Head, &["head", "neck"]),
    (Part::Trunk, &["waist", "torso", "trunk", "spine", "chest", "abdomen", "abs", "bust"]),
];

#[derive(Clone, Copy, PartialEq, Eq)]
enum Part {
    Shoulder,
    Elbow,
    Wrist,
    Ankle,
    Knee,
    Hip,
    Head,
    Trunk,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Side {
    Left,
    Right,
    Middle,
}

/// Small words of a name: `LShoulderPitch` and `left_shoulder_pitch` have the same but for the side's.
fn words(name: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let letters: Vec<char> = name.chars().collect();
    for (at, letter) in letters.iter().enumerate() {
        let next = letters.get(at + 1);
        let lower_before = at > 0 && letters[at - 1].is_lowercase();
        let starts = letter.is_uppercase() && (lower_before || next.is_some_and(|next| next.is_lowercase()));
        if !letter.is_alphabetic() || starts {
            words.push(String::new());
        }
        if let (true, Some(word)) = (letter.is_alphabetic(), words.last_mut()) {
            word.extend(letter.to_lowercase());
        }
    }
    words.retain(|word| !word.is_empty());
    words
}

fn meaning(name: &str) -> Option<(Part, Side)> {
    let words = words(name);
    let has = |word: &str| words.iter().any(|found| found == word || found.strip_suffix('s') == Some(word));
    let (part, _) = PARTS.iter().find(|(_, names)| names.iter().any(|name| has(name)))?;
    let side = match (has("left") || has("l"), has("right") || has("r")) {
        (true, false) => Side::Left,
        (false, true) => Side::Right,
        _ => Side::Middle,
    };
    let middle = matches!(part, Part::Head | Part::Trunk);
    (middle == (side == Side::Middle)).then_some((*part, side))
}

struct Body<'a> {
    robot: &'a Robot,
    frames: Vec<Isometry3<f64>>,
    meanings: Vec<Option<(Part, Side)>>,
    order: Vec<usize>,
}

impl LimbMap {
    /// A map from the names of the joints (left and right shoulder, elbow, wrist, hip, knee, ankle; head, neck, waist) and from where they
    /// are. Also gives what was assumed, one sentence each.
    pub fn suggest(robot: &Robot) -> Result<(Self, Vec<String>), RobotError> {
        let hinge = |at: usize| matches!(robot.joints[at].motion, Motion::Revolute | Motion::Continuous);
        let meanings =
            (0..robot.joints.len()).map(|at| meaning(&robot.joints[at].name).filter(|_| hinge(at))).collect();
        let body = Body { robot, frames: robot.frames(), meanings, order: robot.depth_first() };
        let mut notes = Vec::new();
        let up = Vector3::z();
        let forward = body.forward(up);
        if forward != Vector3::x() {
            notes.push(
                "by its left and right joints the robot does not face along x: see forward in the map".to_owned(),
            );
        }
        let mut limbs = Vec::new();
        // Where the legs hang on the waist, the root link is the chest.
        let legs = [Side::Left, Side::Right].into_iter().flat_map(|side| body.group(Part::Hip, side));
        let waist = |at: usize| robot.chain(at).any(|at| body.meanings[at] == Some((Part::Trunk, Side::Middle)));
        let hangs = legs.into_iter().any(waist);
        body.middle(forward, up, hangs, &mut limbs);
        let sides = [
            (Side::Left, [Limb::LUpperArm, Limb::LForearm, Limb::LHand], [Limb::LThigh, Limb::LShin, Limb::LFoot]),
            (Side::Right, [Limb::RUpperArm, Limb::RForearm, Limb::RHand], [Limb::RThigh, Limb::RShin, Limb::RFoot]),
        ];
        for (side, arm, leg) in sides {
            body.limb(side, [Part::Shoulder, Part::Elbow, Part::Wrist], arm, &mut limbs, &mut notes);
            body.limb(side, [Part::Hip, Part::Knee, Part::Ankle], leg, &mut limbs, &mut notes);
            body.foot(side, leg[2], forward, &mut limbs);
        }
        if limbs.is_empty() {
            let what = "no joint is called after a shoulder, elbow, wrist, hip, knee, ankle, head, neck or waist";
            let help =
                "write a map and give it with --map: [limbs] with lines as l_upper_arm = [\"joint_3\", \"joint_5\"]";
            return Err(RobotError::new(format!("robot '{}'", robot.name), what, help));
        }
        limbs.sort_by_key(|entry| entry.limb as usize);
        let names: Vec<&str> = limbs.iter().map(|entry| entry.limb.name()).collect();
        notes.push(format!("the map is suggested by names and places of joints: {}", names.join(", ")));
        let base = hangs.then_some(Base::Chest);
        Ok((Self { forward, up, base, limbs }, notes))
    }
}

impl Body<'_> {
    fn group(&self, part: Part, side: Side) -> Vec<usize> {
        self.order.iter().copied().filter(|at| self.meanings[*at] == Some((part, side))).collect()
    }

    fn place(&self, at: usize) -> Vector3<f64> {
        self.frames[at].translation.vector
    }

    fn axis(&self, at: usize) -> Vector3<f64> {
        self.frames[at].rotation * self.robot.joints[at].axis
    }

    /// The joint of a group that is nearest to the axes of all: where they meet, if they do.
    fn middle_of(&self, group: &[usize]) -> Option<usize> {
        let away = |at: usize| -> f64 {
            let off = group.iter().map(|other| {
                let way = self.place(at) - self.place(*other);
                (way - self.axis(*other) * way.dot(&self.axis(*other))).norm_squared()
            });
            off.sum()
        };
        let mut best: Option<(f64, usize)> = None;
        for &at in group {
            if best.is_none_or(|(least, _)| away(at) < least - 1e-8) {
                best = Some((away(at), at));
            }
        }
        best.map(|(_, at)| at)
    }

    /// The axis of the root link that is forward, from pairs of joints on both sides.
    fn forward(&self, up: Vector3<f64>) -> Vector3<f64> {
        let mut across = Vector3::zeros();
        for part in [Part::Shoulder, Part::Hip, Part::Elbow, Part::Knee] {
            let [left, right] = [Side::Left, Side::Right].map(|side| self.middle_of(&self.group(part, side)));
            if let (Some(left), Some(right)) = (left, right) {
                across += self.place(left) - self.place(right);
            }
        }
        nearest_axis(&across.cross(&up), 0.0).map_or_else(Vector3::x, |(axis, sign)| direction(axis, sign))
    }

    /// Trunk and head: axes of the last link of each.
    fn middle(&self, forward: Vector3<f64>, up: Vector3<f64>, hangs: bool, limbs: &mut Vec<LimbEntry>) {
        let left = up.cross(&forward);
        let wanted = [
            (Part::Trunk, [(Limb::Trunk, up), (Limb::Shoulders, left)]),
            (Part::Head, [(Limb::Gaze, forward), (Limb::Crown, up)]),
        ];
        for (part, ways) in wanted.into_iter().filter(|(part, _)| !hangs || *part != Part::Trunk) {
            // Where a neck and a head fork, as antennas do, the longest way counts.
            let far = self.group(part, Side::Middle).into_iter().max_by_key(|at| self.robot.chain(*at).count());
            let Some(last) = far else { continue };
            for (limb, way) in ways {
                self.along(limb, last, way, limbs);
            }
        }
    }

    /// An axis of the joint's link that points along `way` at zero.
    fn along(&self, limb: Limb, joint: usize, way: Vector3<f64>, limbs: &mut Vec<LimbEntry>) {
        let inside = self.frames[joint].rotation.inverse() * way;
        if let Some((axis, sign)) = nearest_axis(&inside, ALONG) {
            let begin = self.robot.joints[joint].name.clone();
            limbs.push(LimbEntry { limb, begin, end: End::Axis(axis, sign) });
        }
    }

    /// Upper and lower bone of an arm or leg, and a hand.
    fn limb(
        &self,
        side: Side,
        parts: [Part; 3],
        names: [Limb; 3],
        limbs: &mut Vec<LimbEntry>,
        notes: &mut Vec<String>,
    ) {
        let groups = parts.map(|part| self.group(part, side));
        let [root, bend, tip] = [0, 1, 2].map(|at| self.middle_of(&groups[at]));
        let name = |at: usize| self.robot.joints[at].name.clone();
        let far = |a: usize, b: usize| (self.place(a) - self.place(b)).norm() > SHORT;
        if let (Some(root), Some(bend)) = (root, bend)
            && far(root, bend)
        {
            limbs.push(LimbEntry { limb: names[0], begin: name(root), end: End::At(name(bend)) });
        }
        if let Some(bend) = bend {
            let end = tip.filter(|tip| far(bend, *tip)).map(|tip| End::At(name(tip)));
            let end = end.or_else(|| self.farthest(bend).map(End::At));
            if let Some(end) = end {
                limbs.push(LimbEntry { limb: names[1], begin: name(bend), end });
            } else if let (Some(&last), Some(root)) = (groups[1].last(), root)
                && let Some(way) = (self.place(bend) - self.place(root)).try_normalize(SHORT)
            {
                self.along(names[1], last, way, limbs);
                notes.push(format!("{}: nothing shows where it ends, straight at zero is assumed", names[1].name()));
            }
        }
        // A foot is turned by more than its bone: see `foot`.
        if let (Some(&last), Part::Wrist) = (groups[2].last(), parts[2])
            && let Some(end) = self.farthest(last)
        {
            limbs.push(LimbEntry { limb: names[2], begin: name(last), end: End::At(end) });
        }
    }

    /// The way that a foot faces.
    fn foot(&self, side: Side, limb: Limb, forward: Vector3<f64>, limbs: &mut Vec<LimbEntry>) {
        if let Some(&last) = self.group(Part::Ankle, side).last() {
            self.along(limb, last, forward, limbs);
        }
    }

    /// The link that is carried by a joint and farthest from it.
    fn farthest(&self, joint: usize) -> Option<String> {
        let mut carried = vec![false; self.frames.len()];
        let mut best: Option<(f64, usize)> = None;
        for &at in &self.order {
            carried[at] = at == joint || self.robot.joints[at].parent.is_some_and(|parent| carried[parent]);
            let away = (self.place(at) - self.place(joint)).norm();
            if carried[at] && away > SHORT && best.is_none_or(|(most, _)| away > most) {
                best = Some((away, at));
            }
        }
        best.map(|(_, at)| self.robot.joints[at].child.clone())
    }
}

/// The axis nearest to a direction, and its sign, if the cosine is at least `least`.
fn nearest_axis(way: &Vector3<f64>, least: f64) -> Option<(usize, f64)> {
    let way = way.try_normalize(1e-6)?;
    let at = way.iamax();
    (way[at].abs() >= least).then(|| (at, way[at].signum()))
}
