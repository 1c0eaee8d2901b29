//! A suggestion as a map file that says why.

use std::fmt::Write;

use super::seen::Seen;
use super::{Suggestion, Sure};
use crate::clip::map::Canonical;
use crate::plain;

impl Sure {
    /// As a word.
    pub fn name(self) -> &'static str {
        match self {
            Sure::Open => "open",
            Sure::Likely => "likely",
            Sure::Certain => "certain",
        }
    }
}

/// The map as TOML, with what decided in comments.
pub(super) fn toml(seen: &Seen, made: &Suggestion) -> String {
    let mut out = String::from(
        "# A suggestion from hierarchy, lengths of bones and motion. Look at it, then give it with --map.\n",
    );
    let [thigh, shin, upper, fore] = made.bones;
    let percent = |bone: f64| 100.0 * bone / thigh;
    let _ = writeln!(
        out,
        "# Limbs: {}.\n# Shin, upper arm and forearm have {:.0}, {:.0} and {:.0} % of the thigh's length; left and right differ by {:.0} % at most.",
        match made.limbs {
            Sure::Certain => "certain, no other chains are nearly as much like legs and arms",
            Sure::Likely => "likely, others are nearly as much like legs and arms: see the joints that are left out",
            Sure::Open => "OPEN, others are as much like legs and arms: see the joints that are left out",
        },
        percent(shin),
        percent(upper),
        percent(fore),
        100.0 * made.uneven
    );
    let said: Vec<String> = made
        .sides
        .witnesses
        .iter()
        .filter(|w| w.spoke >= 0.05)
        .map(|w| format!("{} {:+.2} in {:.0} %", w.what, w.agreement, 100.0 * w.spoke))
        .collect();
    let _ = writeln!(
        out,
        "# Left and right: {}.\n# For them (1) or against them (-1), in how many frames: {}.",
        match made.sides.sure {
            Sure::Certain => "certain",
            Sure::Likely => "likely, look at the motion",
            Sure::Open => "OPEN, they may be exchanged: look at the motion",
        },
        if said.is_empty() { "nothing".to_owned() } else { said.join(", ") }
    );
    out.push_str(match made.sides.by_names() {
        Some(true) => "# The names say the sides, but toes and knees point backwards: if the axes are left-handed, --handed left.\n",
        Some(false) => "# The names say the sides.\n",
        None => "# If the file's axes are left-handed, left and right are exchanged here: make the map with --handed left.\n",
    });
    out.push_str("[joints]\n");
    for canonical in Canonical::ALL {
        let _ = match made.map.joint(canonical) {
            Some(joint) => writeln!(out, "{} = {}{}", canonical.name(), name(seen, joint), why(seen, made, canonical)),
            None => writeln!(out, "# {}: {}", canonical.name(), missing(canonical)),
        };
    }
    let left_out: Vec<String> = (0..seen.children.len())
        .filter(|&joint| made.map.canonical(joint).is_none())
        .map(|joint| name(seen, joint))
        .collect();
    if !left_out.is_empty() {
        let _ = writeln!(out, "# Left out (scene, twist, fingers, face, helpers): {}", left_out.join(", "));
    }
    out
}

fn name(seen: &Seen, joint: usize) -> String {
    // One line each, whatever the name holds.
    let escaped = |c: char| match c {
        '"' => "\\\"".to_owned(),
        '\\' => "\\\\".to_owned(),
        // What a terminal obeys.
        c if plain::line(c.encode_utf8(&mut [0; 4])) != c.to_string() => format!("\\u{:04X}", u32::from(c)),
        c => c.to_string(),
    };
    format!("\"{}\"", seen.clip.skeleton.joints[joint].name.chars().map(escaped).collect::<String>())
}

/// What decided, where a line has more to say than its name.
fn why(seen: &Seen, made: &Suggestion, canonical: Canonical) -> String {
    let joint = |c: Canonical| made.map.joint(c);
    let fingers = |at: usize| seen.children[at].len();
    match canonical {
        Canonical::Pelvis => "  # legs and trunk meet here".into(),
        Canonical::Chest => "  # arms and neck branch off here".into(),
        Canonical::Neck if joint(Canonical::Neck) == joint(Canonical::Chest) => {
            "  # no joint of its own: the head turns on the chest's".into()
        }
        Canonical::LWrist | Canonical::RWrist => match joint(canonical).map_or(0, fingers) {
            0 | 1 => String::new(),
            n => format!("  # {n} joints hang on it"),
        },
        _ => String::new(),
    }
}

fn missing(canonical: Canonical) -> &'static str {
    match canonical {
        Canonical::Spine => "found no joint between pelvis and chest",
        Canonical::Chest => "the arms branch off the pelvis",
        Canonical::Neck => "found no joint between chest and head",
        Canonical::Head => "found nothing beyond the arms that goes on upwards",
        Canonical::LCollar | Canonical::RCollar => "found no joint before the shoulder",
        Canonical::LToe | Canonical::RToe => "found no joint beyond the ankle",
        _ => "found none",
    }
}
