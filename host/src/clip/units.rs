//! What a file's numbers mean: BVH states neither its unit of length nor its up axis.

use std::fmt;
use std::str::FromStr;

use super::Skeleton;
use super::map::{Canonical, JointMap};

/// A unit of length that BVH files are found in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// 1 m.
    Metre,
    /// 0.01 m: Blender, Mixamo, most vendors. What [`Clip::write_bvh`](super::Clip::write_bvh) writes by default.
    Centimetre,
    /// 0.001 m.
    Millimetre,
    /// 0.0254 m.
    Inch,
    /// 5.644 cm (one inch over 0.45): the CMU database and everything converted from its ASF/AMC files.
    Cmu,
}

impl Unit {
    /// All units, in the order in which messages list them.
    pub const ALL: [Unit; 5] = [Unit::Metre, Unit::Centimetre, Unit::Millimetre, Unit::Inch, Unit::Cmu];

    /// Metres per unit.
    pub fn metres(self) -> f64 {
        match self {
            Unit::Metre => 1.0,
            Unit::Centimetre => 0.01,
            Unit::Millimetre => 0.001,
            Unit::Inch => 0.0254,
            Unit::Cmu => 0.0254 / 0.45,
        }
    }

    /// Short name, as `--units` takes it.
    pub fn name(self) -> &'static str {
        match self {
            Unit::Metre => "m",
            Unit::Centimetre => "cm",
            Unit::Millimetre => "mm",
            Unit::Inch => "inch",
            Unit::Cmu => "cmu",
        }
    }

    /// The unit in which a leg of `leg` units (hip to knee to ankle) belongs to a person.
    ///
    /// The ranges do not overlap; where two units would both give a human, the commoner file wins:
    ///
    /// | leg, units | unit | leg, m |
    /// |---|---|---|
    /// | 0.3 to 1.3 | m | 0.30 to 1.30 |
    /// | 6 to 20 | cmu | 0.34 to 1.13 |
    /// | 20 to 38 | inch | 0.51 to 0.97 |
    /// | 38 to 130 | cm | 0.38 to 1.30 |
    /// | 380 to 1300 | mm | 0.38 to 1.30 |
    pub fn detect(leg: f64) -> Option<Unit> {
        match leg {
            l if (0.3..=1.3).contains(&l) => Some(Unit::Metre),
            l if (6.0..20.0).contains(&l) => Some(Unit::Cmu),
            l if (20.0..38.0).contains(&l) => Some(Unit::Inch),
            l if (38.0..=130.0).contains(&l) => Some(Unit::Centimetre),
            l if (380.0..=1300.0).contains(&l) => Some(Unit::Millimetre),
            _ => None,
        }
    }
}

impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Unit {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.trim().to_ascii_lowercase().as_str() {
            "m" | "metre" | "meter" | "metres" | "meters" => Ok(Unit::Metre),
            "cm" => Ok(Unit::Centimetre),
            "mm" => Ok(Unit::Millimetre),
            "in" | "inch" | "inches" => Ok(Unit::Inch),
            "cmu" => Ok(Unit::Cmu),
            _ => Err(format!("'{text}' is not a unit of length; use one of m, cm, mm, inch, cmu")),
        }
    }
}

/// Which axis points up in a file. Clips in memory are always Y up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UpAxis {
    /// Y up: what BVH files have by custom.
    Y,
    /// Z up: exports from tools that work so. Turned to Y up on import: (x, y, z) becomes (x, z, -y).
    Z,
}

impl FromStr for UpAxis {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.trim().to_ascii_lowercase().as_str() {
            "y" => Ok(UpAxis::Y),
            "z" => Ok(UpAxis::Z),
            _ => Err(format!("'{text}' is not an up axis; use y or z")),
        }
    }
}

/// Ratio of a leg to the longest path through a human skeleton (fingertip to toe), for skeletons without known names.
const LEG_OF_LONGEST_PATH: f64 = 0.385;

/// Length of the leg in the skeleton's own units, and how it was measured, for the note and the error.
pub(super) fn measure_leg(skeleton: &Skeleton, map: Option<&JointMap>) -> (f64, String) {
    if let Some(leg) = map.and_then(|m| leg_chain(skeleton, m)) {
        return (leg, format!("a leg (hip to ankle) of {leg:.4} units"));
    }
    let path = longest_path(skeleton);
    (path * LEG_OF_LONGEST_PATH, format!("a longest path between two ends of {path:.4} units (leg about 38.5 %)"))
}

/// Mean over the two legs of the bone lengths from hip to ankle.
fn leg_chain(skeleton: &Skeleton, map: &JointMap) -> Option<f64> {
    let left = chain(skeleton, map.joint(Canonical::LAnkle)?, map.joint(Canonical::LHip)?)?;
    let right = chain(skeleton, map.joint(Canonical::RAnkle)?, map.joint(Canonical::RHip)?)?;
    Some((left + right) / 2.0)
}

/// Sum of the bone lengths from `from` up to its ancestor `to`.
pub(super) fn chain(skeleton: &Skeleton, from: usize, to: usize) -> Option<f64> {
    let (mut at, mut sum) = (from, 0.0);
    while at != to {
        let joint = skeleton.joints.get(at)?;
        sum += joint.offset.norm();
        at = joint.parent?;
    }
    Some(sum)
}

/// Longest path between any two ends of the tree, along the bones.
pub(super) fn longest_path(skeleton: &Skeleton) -> f64 {
    // Deepest reach below each joint; children come after parents, so one backward sweep does it.
    let mut reach: Vec<f64> = skeleton.joints.iter().map(|j| j.end.map_or(0.0, |e| e.norm())).collect();
    let mut best = reach.iter().copied().fold(0.0, f64::max);
    for (index, joint) in skeleton.joints.iter().enumerate().rev() {
        let Some(parent) = joint.parent else { continue };
        let through = reach[index] + joint.offset.norm();
        best = best.max(reach[parent] + through);
        reach[parent] = reach[parent].max(through);
    }
    best
}
