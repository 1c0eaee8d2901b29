//! What a file's numbers mean: BVH states neither its unit of length nor its up axis.

use std::fmt;
use std::str::FromStr;

use nalgebra::{UnitQuaternion, Vector3};

use super::Skeleton;
use super::map::{Canonical, JointMap};

/// A unit of length that BVH files are found in.
#[derive(Clone, Copy, Debug, PartialEq)]
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
    /// 0.1 m: MakeHuman.
    Decimetre,
    /// 0.3048 m.
    Foot,
    /// 0.08 m: MikuMikuDance.
    Mmd,
    /// Any other: so many metres.
    Factor(f64),
}

impl Unit {
    /// All units that have a name, in the order in which messages list them.
    pub const ALL: [Unit; 8] = [
        Unit::Metre,
        Unit::Centimetre,
        Unit::Millimetre,
        Unit::Inch,
        Unit::Cmu,
        Unit::Decimetre,
        Unit::Foot,
        Unit::Mmd,
    ];

    /// Metres per unit.
    pub fn metres(self) -> f64 {
        match self {
            Unit::Metre => 1.0,
            Unit::Centimetre => 0.01,
            Unit::Millimetre => 0.001,
            Unit::Inch => 0.0254,
            Unit::Cmu => 0.0254 / 0.45,
            Unit::Decimetre => 0.1,
            Unit::Foot => 0.3048,
            Unit::Mmd => 0.08,
            Unit::Factor(metres) => metres,
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
            Unit::Decimetre => "dm",
            Unit::Foot => "foot",
            Unit::Mmd => "mmd",
            Unit::Factor(_) => "factor",
        }
    }

    /// The unit in which a leg of `leg` units (hip to knee to ankle) belongs to a person.
    ///
    /// The ranges do not overlap; where two units would both give a human, the commoner file wins, see [`Unit::others`]:
    ///
    /// | leg, units | unit | leg, m |
    /// |---|---|---|
    /// | 0.3 to 1.3 | m | 0.30 to 1.30 |
    /// | 1.6 to 4.3 | foot | 0.49 to 1.31 |
    /// | 6 to 9.5 | dm | 0.60 to 0.95 |
    /// | 9.5 to 20 | cmu | 0.54 to 1.13 |
    /// | 20 to 43 | inch | 0.51 to 1.09 |
    /// | 43 to 130 | cm | 0.43 to 1.30 |
    /// | 380 to 1300 | mm | 0.38 to 1.30 |
    pub fn detect(leg: f64) -> Option<Unit> {
        match leg {
            l if (0.3..=1.3).contains(&l) => Some(Unit::Metre),
            l if (1.6..=4.3).contains(&l) => Some(Unit::Foot),
            l if (6.0..9.5).contains(&l) => Some(Unit::Decimetre),
            l if (9.5..20.0).contains(&l) => Some(Unit::Cmu),
            l if (20.0..43.0).contains(&l) => Some(Unit::Inch),
            l if (43.0..=130.0).contains(&l) => Some(Unit::Centimetre),
            l if (380.0..=1300.0).contains(&l) => Some(Unit::Millimetre),
            _ => None,
        }
    }

    /// Units in which the leg would belong to a person too, where the size alone does not decide. Adults in inches, toddlers in
    /// cm: 25 to 50 units. Adults in decimetres, figures of MikuMikuDance, children of the CMU database: 6 to 10 units.
    pub fn others(self, leg: f64) -> Vec<Unit> {
        let rivals: &[Unit] = match leg {
            l if (6.0..10.5).contains(&l) => &[Unit::Decimetre, Unit::Mmd, Unit::Cmu],
            l if (25.0..51.0).contains(&l) => &[Unit::Inch, Unit::Centimetre],
            _ => &[],
        };
        rivals.iter().copied().filter(|unit| *unit != self).collect()
    }
}

impl Unit {
    /// What the unit could be as well, for a leg of `leg` units, as a note; none where the size decides.
    pub(super) fn uncertain(self, leg: f64) -> Option<String> {
        let could = |other: Unit| format!("{other} (a leg of {:.2} m)", leg * other.metres());
        let list = self.others(leg).into_iter().map(could).collect::<Vec<_>>().join(" or ");
        (!list.is_empty()).then(|| format!("The unit is not certain: it could be {list} as well; --units says which."))
    }
}

impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Unit::Factor(metres) => write!(f, "{metres} m"),
            named => f.write_str(named.name()),
        }
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
            "dm" => Ok(Unit::Decimetre),
            "ft" | "foot" | "feet" => Ok(Unit::Foot),
            "mmd" => Ok(Unit::Mmd),
            other => match other.parse::<f64>() {
                Ok(metres) if (1e-6..=1e6).contains(&metres) => Ok(Unit::Factor(metres)),
                _ => Err(format!(
                    "'{text}' is not a unit of length; use one of m, cm, mm, inch, cmu, dm, foot, mmd, or the metres that one \
                     unit has, like 0.08"
                )),
            },
        }
    }
}

/// Which axis points up in a file. Clips in memory are always Y up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)] // The axis, and whether it is its other end.
pub enum UpAxis {
    X,
    /// What BVH files have by custom.
    Y,
    /// Exports from tools that work so. Turned to Y up on import: (x, y, z) becomes (x, z, -y).
    Z,
    NegX,
    NegY,
    NegZ,
}

impl UpAxis {
    /// All of them.
    pub const ALL: [UpAxis; 6] = [UpAxis::X, UpAxis::Y, UpAxis::Z, UpAxis::NegX, UpAxis::NegY, UpAxis::NegZ];

    /// The direction in the file.
    pub fn direction(self) -> Vector3<f64> {
        match self {
            UpAxis::X => Vector3::x(),
            UpAxis::Y => Vector3::y(),
            UpAxis::Z => Vector3::z(),
            UpAxis::NegX => -Vector3::x(),
            UpAxis::NegY => -Vector3::y(),
            UpAxis::NegZ => -Vector3::z(),
        }
    }

    /// The rotation that brings it to +Y: a quarter or half turn about X, for the X axis about Z.
    pub fn to_y(self) -> UnitQuaternion<f64> {
        let (axis, quarters) = match self {
            UpAxis::X => (Vector3::z_axis(), 1.0),
            UpAxis::Y => (Vector3::x_axis(), 0.0),
            UpAxis::Z => (Vector3::x_axis(), -1.0),
            UpAxis::NegX => (Vector3::z_axis(), -1.0),
            UpAxis::NegY => (Vector3::x_axis(), 2.0),
            UpAxis::NegZ => (Vector3::x_axis(), 1.0),
        };
        UnitQuaternion::from_axis_angle(&axis, quarters * std::f64::consts::FRAC_PI_2)
    }

    /// As [`UpAxis::to_y`] for a vector, without rounding.
    pub fn turn(self, v: Vector3<f64>) -> Vector3<f64> {
        match self {
            UpAxis::X => Vector3::new(-v.y, v.x, v.z),
            UpAxis::Y => v,
            UpAxis::Z => Vector3::new(v.x, v.z, -v.y),
            UpAxis::NegX => Vector3::new(v.y, -v.x, v.z),
            UpAxis::NegY => Vector3::new(v.x, -v.y, -v.z),
            UpAxis::NegZ => Vector3::new(v.x, -v.z, v.y),
        }
    }
}

const AXES: [&str; 6] = ["x", "y", "z", "-x", "-y", "-z"];

impl fmt::Display for UpAxis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(AXES[*self as usize])
    }
}

impl FromStr for UpAxis {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let lower = text.trim().to_ascii_lowercase();
        let at = AXES.iter().position(|axis| *axis == lower.trim_start_matches('+'));
        at.map(|at| Self::ALL[at]).ok_or_else(|| format!("'{text}' is not an up axis; use x, y, z, -x, -y or -z"))
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
