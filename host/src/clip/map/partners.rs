//! Left-right partners: by the canonical joints first, by the names for the rest (fingers, eyes, helpers).

use std::collections::HashMap;

use super::{Canonical, JointMap};
use crate::clip::Skeleton;

/// The mirror partner of each joint `[joints]`: itself for joints of the middle, `None` for a joint that its name puts on
/// one side, without counterpart on the other.
///
/// Name patterns: `Left`/`Right` in any case and anywhere; a part `L`/`R` between separators (`Hand_L`, `CC_Base_L_Hand`,
/// `shin.L`); a prefix `l`/`r` before a capital (`lShin`, `LThumb`).
pub fn mirror_partners(skeleton: &Skeleton, map: Option<&JointMap>) -> Vec<Option<usize>> {
    let index: HashMap<&str, usize> = skeleton.joints.iter().enumerate().map(|(i, j)| (j.name.as_str(), i)).collect();
    let by_map = |joint: usize| {
        let map = map?;
        map.joint(map.canonical(joint)?.mirrored())
    };
    let by_name = |name: &str, joint: usize| match side_swapped(name) {
        Some((other, certain)) => match index.get(other.as_str()) {
            Some(&partner) => Some(partner),
            // A lone capital after an l or r may be chance.
            None if !certain => Some(joint),
            None => None,
        },
        None => Some(joint),
    };
    let joints = skeleton.joints.iter().enumerate();
    joints.map(|(i, j)| by_map(i).or_else(|| by_name(&j.name, i))).collect()
}

/// The name with its side exchanged, and whether the pattern is unmistakable; `None` for a name without side.
fn side_swapped(name: &str) -> Option<(String, bool)> {
    const WORDS: [(&str, &str); 3] = [("Left", "Right"), ("left", "right"), ("LEFT", "RIGHT")];
    for (left, right) in WORDS {
        if name.contains(left) {
            return Some((name.replacen(left, right, 1), true));
        }
        if name.contains(right) {
            return Some((name.replacen(right, left, 1), true));
        }
    }
    let is_separator = |c: char| ['_', '.', ' ', ':', '-'].contains(&c);
    let mut start = 0;
    for part in name.split(is_separator) {
        // A name that is nothing but L has no part to be a side of.
        if let (Some(swapped), true) = (swap_letter(part), part.len() < name.len()) {
            return Some((format!("{}{swapped}{}", &name[..start], &name[start + part.len()..]), true));
        }
        start += part.len() + 1;
    }
    let (first, rest) = name.split_at_checked(1)?;
    let swapped = swap_letter(first)?;
    rest.starts_with(|c: char| c.is_ascii_uppercase()).then(|| (format!("{swapped}{rest}"), false))
}

fn swap_letter(letter: &str) -> Option<&'static str> {
    match letter {
        "L" => Some("R"),
        "R" => Some("L"),
        "l" => Some("r"),
        "r" => Some("l"),
        _ => None,
    }
}

impl Canonical {
    /// Whether the joint is on the person's left.
    pub fn is_left(self) -> bool {
        self.name().starts_with("l_")
    }

    /// Whether the joint is on the person's right.
    pub fn is_right(self) -> bool {
        self.name().starts_with("r_")
    }
}

#[cfg(test)]
mod tests {
    use super::side_swapped;

    #[test]
    fn sides_are_found_in_names() {
        let swapped = |name| side_swapped(name).map(|(other, _)| other);
        for (left, right) in [
            ("LeftHand", "RightHand"),
            ("mixamorig:LeftHandIndex1", "mixamorig:RightHandIndex1"),
            ("Hand_L", "Hand_R"),
            ("CC_Base_L_Thigh", "CC_Base_R_Thigh"),
            ("Bip01 L Calf", "Bip01 R Calf"),
            ("lShin", "rShin"),
            ("LThumb", "RThumb"),
            ("leftEye", "rightEye"),
            ("ElbowLeft", "ElbowRight"),
        ] {
            assert_eq!(swapped(left).as_deref(), Some(right));
            assert_eq!(swapped(right).as_deref(), Some(left));
        }
        for middle in ["LowerBack", "Hips", "abdomen", "L", "", "é", "ribs", "_"] {
            assert_eq!(swapped(middle), None, "{middle}");
        }
    }
}
