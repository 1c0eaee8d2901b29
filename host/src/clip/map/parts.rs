//! Joint names by their parts: what no layout has to the letter (`mixamorig_LeftUpLeg`, `Bip01 L Thigh`, `upper_arm.L`, `lfoot`).
//!
//! A name is cut at separators and capitals; name spaces, prefixes and numbers are dropped; what says the side is told from what
//! says the bone. The hierarchy must agree: ankles hang on knees, knees on hips, hips and shoulders on the pelvis.

use std::collections::HashMap;

use super::Canonical::{self, *};
use super::{CANONICAL, JointMap};
use crate::clip::Skeleton;

/// Parts that name no bone.
const NOISE: [&str; 22] = [
    "mixamorig",
    "bip",
    "cc",
    "base",
    "j",
    "c",
    "def",
    "org",
    "mch",
    "jnt",
    "joint",
    "bone",
    "bind",
    "skin",
    "character",
    "rig",
    "b",
    "valve",
    "valvebiped",
    "skel",
    "sk",
    "m",
];

/// Words for one bone, best first, of a limb's joints outwards in: a word that two joints could mean goes to the one that lacks a
/// better one.
const HIP: &[&str] = &["upleg", "upperleg", "uplegs", "thigh", "legupper", "upleg1", "hip", "hipjoint", "femur"];
const KNEE: &[&str] = &["lowleg", "lowerleg", "leglower", "shin", "calf", "knee", "leg", "tibia"];
const ANKLE: &[&str] = &["ankle", "foot"];
const TOE: &[&str] = &["toebase", "toe", "toes", "ball", "foot", "toeend"];
const COLLAR: &[&str] = &["clavicle", "collar", "collarbone", "shoulder", "shoulderblade", "innershoulder"];
const SHOULDER: &[&str] = &["upperarm", "uparm", "armupper", "shldr", "arm", "shoulder", "humerus"];
const ELBOW: &[&str] = &["lowarm", "lowerarm", "armlower", "forearm", "elbow", "radius"];
const WRIST: &[&str] = &["wrist", "hand"];

/// What a name says: on which side (-1 left, 1 right), and which bone.
fn parts(name: &str) -> (i8, String) {
    let bare = name.rsplit([':', '|']).next().unwrap_or(name);
    let mut words: Vec<String> = vec![String::new()];
    let mut before = ' ';
    for c in bare.chars() {
        let cut = !c.is_alphanumeric() || c.is_ascii_digit() || (c.is_uppercase() && !before.is_uppercase());
        if cut {
            words.push(String::new());
        }
        if c.is_alphabetic()
            && let Some(word) = words.last_mut()
        {
            word.extend(c.to_lowercase());
        }
        before = c;
    }
    let (mut side, mut bone) = (0, String::new());
    for word in words.iter().filter(|w| !w.is_empty()) {
        match word.as_str() {
            "l" | "left" | "lft" => side = -1,
            "r" | "right" | "rgt" | "rt" => side = 1,
            noise if NOISE.contains(&noise) => {}
            other => bone.push_str(other),
        }
    }
    if side == 0 {
        // Without separators: leftupleg, lthigh.
        let all = [HIP, KNEE, ANKLE, TOE, COLLAR, SHOULDER, ELBOW, WRIST];
        for (prefix, which) in [("left", -1), ("right", 1), ("l", -1), ("r", 1)] {
            for rest in [bone.strip_prefix(prefix), bone.strip_suffix(prefix)].into_iter().flatten() {
                if all.iter().any(|words| words.contains(&rest)) {
                    return (which, rest.to_owned());
                }
            }
        }
    }
    (side, bone)
}

/// The side that a name says: -1 left, 1 right, 0 none.
pub(super) fn side(name: &str) -> i8 {
    parts(name).0
}

/// What all names but the root's begin with, up to a separator: the name of an actor or of a rig.
fn prefix(skeleton: &Skeleton) -> &str {
    let mut names = skeleton.joints.iter().skip(1).map(|j| j.name.as_str());
    let first = names.next().unwrap_or_default();
    let ends = first.char_indices().filter(|(_, c)| !c.is_alphanumeric()).map(|(at, c)| at + c.len_utf8());
    let common = ends.take_while(|end| names.clone().all(|name| name.starts_with(&first[..*end])));
    &first[..common.last().unwrap_or(0)]
}

/// The joints by their names' parts; none where pelvis, head or a limb are not all there, or hang together otherwise.
pub(super) fn fit(skeleton: &Skeleton) -> Option<JointMap> {
    let mut index: HashMap<(i8, String), usize> = HashMap::new();
    let prefix = prefix(skeleton);
    for (joint, j) in skeleton.joints.iter().enumerate() {
        index.entry(parts(j.name.strip_prefix(prefix).unwrap_or(&j.name))).or_insert(joint);
    }
    let parent = |j: usize| skeleton.joints[j].parent;
    let above = |j: usize| std::iter::successors(Some(j), move |&at| parent(at));
    let common = |a: usize, b: usize| above(a).find(|&j| above(b).any(|k| k == j));
    let mut joints: [Option<usize>; CANONICAL] = [None; CANONICAL];
    for (side, limbs) in [
        (-1, [LCollar, LShoulder, LElbow, LWrist, LHip, LKnee, LAnkle, LToe]),
        (1, [RCollar, RShoulder, RElbow, RWrist, RHip, RKnee, RAnkle, RToe]),
    ] {
        let find = |words: &[&str], taken: &[Option<usize>]| {
            let all = words.iter().filter_map(|w| index.get(&(side, (*w).to_owned())).copied());
            all.into_iter().find(|j| !taken.contains(&Some(*j)))
        };
        let [collar, shoulder, elbow, wrist, hip, knee, ankle, toe] = limbs.map(|c| c as usize);
        joints[shoulder] = find(SHOULDER, &[]);
        joints[collar] = find(COLLAR, &[joints[shoulder]]);
        joints[elbow] = find(ELBOW, &[]);
        joints[wrist] = find(WRIST, &[]);
        joints[hip] = find(HIP, &[]);
        joints[knee] = find(KNEE, &[joints[hip]]);
        joints[ankle] = find(ANKLE, &[]);
        joints[toe] = find(TOE, &[joints[ankle]]);
        for [upper, lower] in [[shoulder, elbow], [elbow, wrist], [hip, knee], [knee, ankle]] {
            let (upper, lower) = (joints[upper]?, joints[lower]?);
            above(lower).skip(1).find(|&j| j == upper)?;
        }
        // A collar or toe of another limb is none.
        joints[collar] = joints[collar].filter(|c| joints[shoulder].is_some_and(|s| above(s).any(|j| j == *c)));
        joints[toe] = joints[toe].filter(|t| above(*t).any(|j| Some(j) == joints[ankle]));
    }
    let at = |c: Canonical| joints[c as usize];
    let hips = common(at(LHip)?, at(RHip)?)?;
    let named = ["hips", "pelvis", "hip", "hipcenter"].iter().find_map(|w| index.get(&(0, (*w).to_owned())).copied());
    let pelvis = named.filter(|&p| above(hips).any(|j| j == p)).unwrap_or(hips);
    let head = *index.get(&(0, "head".to_owned()))?;
    let chest = common(common(at(LShoulder)?, at(RShoulder)?)?, head)?;
    let spine =
        above(chest).take_while(|&j| j != pelvis).last().filter(|&s| s != chest && above(chest).any(|j| j == pelvis));
    let neck = index.get(&(0, "neck".to_owned())).copied().filter(|&n| above(head).any(|j| j == n));
    let middle = [(Pelvis, Some(pelvis)), (Spine, spine), (Chest, Some(chest)), (Neck, neck), (Head, Some(head))];
    for (canonical, joint) in middle {
        joints[canonical as usize] = joint;
    }
    let left = skeleton.joints[joints[LHip as usize]?].name.as_str();
    Some(JointMap::new(style(left).into(), joints, skeleton))
}

/// The producer whose custom the names follow, by the name of the left thigh.
fn style(hip: &str) -> &'static str {
    let lower = hip.to_ascii_lowercase();
    match lower {
        l if l.contains("mixamorig") => "mixamo",
        l if l.contains("bip0") => "biped",
        l if l.ends_with("hip") => "biovision",
        l if l.contains("upleg") => "motionbuilder",
        l if l.contains("upperleg") => "unity",
        _ => "parts",
    }
}

#[cfg(test)]
mod tests {
    use super::parts;

    #[test]
    fn side_and_bone_are_told_apart() {
        for (name, side, bone) in [
            ("mixamorig_LeftUpLeg", -1, "upleg"),
            ("mixamorig1:RightToeBase", 1, "toe"),
            ("Bip01 L Thigh", -1, "thigh"),
            ("upper_arm.R", 1, "upperarm"),
            ("leftforearm", -1, "forearm"),
            ("rThigh", 1, "thigh"),
            ("lfoot", -1, "foot"),
            ("J_Bip_L_UpperArm", -1, "upperarm"),
            ("Subject1:LeftHip", -1, "hip"),
            ("J_Bip_C_Head", 0, "head"),
            ("lowerback", 0, "lowerback"),
        ] {
            assert_eq!(parts(name), (side, bone.to_owned()), "{name}");
        }
    }
}
