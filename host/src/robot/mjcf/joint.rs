//! One joint of a body.

use nalgebra::{Isometry3, Translation3, Vector3};

use super::super::{Motion, RobotError};
use super::defaults::Defaults;
use super::pose::Angles;
use super::source::Source;

/// Attributes of a joint that are read.
pub(super) const ATTRIBUTES: [&str; 6] = ["type", "axis", "range", "limited", "pos", "ref"];

/// How a joint moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Hinge,
    Slide,
    Ball,
    Free,
}

impl Kind {
    /// Its name in the file.
    pub fn name(self) -> &'static str {
        ["hinge", "slide", "ball", "free"][self as usize]
    }

    /// Whether it has one coordinate.
    pub fn moves(self) -> bool {
        matches!(self, Self::Hinge | Self::Slide)
    }

    /// The same of a robot.
    pub fn motion(self, bounded: bool) -> Motion {
        match self {
            Self::Hinge if bounded => Motion::Revolute,
            Self::Hinge => Motion::Continuous,
            Self::Slide => Motion::Prismatic,
            Self::Ball => Motion::Other("ball"),
            Self::Free => Motion::Other("free"),
        }
    }
}

/// A joint in its body's frame.
pub(super) struct Axis {
    pub element: usize,
    pub name: Option<String>,
    pub kind: Kind,
    /// A point of the axis, m.
    pub place: Vector3<f64>,
    /// Length one.
    pub axis: Vector3<f64>,
    /// rad or m.
    pub bounds: Option<[f64; 2]>,
    /// Coordinate at which the body stands where it is written, rad or m.
    pub reference: f64,
    pub notes: Vec<String>,
}

impl Axis {
    /// From where the body is written to where the coordinate is 0.
    pub fn back(&self) -> Isometry3<f64> {
        match self.kind {
            Kind::Hinge => Isometry3::rotation(self.axis * -self.reference),
            Kind::Slide => Isometry3::translation(
                -self.axis.x * self.reference,
                -self.axis.y * self.reference,
                -self.axis.z * self.reference,
            ),
            Kind::Ball | Kind::Free => Isometry3::identity(),
        }
    }
}

/// Reads a joint; `class` is that of the bodies around it, `frame` that of the `<frame>` elements in its body.
pub(super) fn read(
    source: &Source,
    angles: &Angles,
    defaults: &Defaults,
    at: usize,
    class: Option<&str>,
    frame: &Isometry3<f64>,
) -> Result<Axis, RobotError> {
    let name = source.get(at, "name").filter(|name| !name.is_empty()).map(str::to_owned);
    let bare = |kind| Axis {
        element: at,
        name: name.clone(),
        kind,
        place: Vector3::zeros(),
        axis: Vector3::z(),
        bounds: None,
        reference: 0.0,
        notes: Vec::new(),
    };
    if source.at(at).tag == "freejoint" {
        return Ok(bare(Kind::Free));
    }
    let says = |attribute: &str| defaults.says(source, at, class, attribute);
    let text = |attribute: &str| Ok::<_, RobotError>(says(attribute)?.and_then(|from| source.get(from, attribute)));
    let refuse = |what: String, help: &str| RobotError::new(source.place(at), what, help);
    let kind = match text("type")? {
        None | Some("hinge") => Kind::Hinge,
        Some("slide") => Kind::Slide,
        Some("ball") => Kind::Ball,
        Some("free") => Kind::Free,
        Some(other) => {
            return Err(refuse(format!("type=\"{other}\": expected hinge, slide, ball or free"), "correct it"));
        }
    };
    if !kind.moves() {
        return Ok(bare(kind));
    }
    let given = says("axis")?.map(|from| source.vector(from, "axis")).transpose()?;
    let axis = given.unwrap_or_else(Vector3::z).try_normalize(1e-9).ok_or_else(|| {
        refuse("axis: found a vector of length zero, expected a direction".into(), "as in axis=\"0 1 0\"")
    })?;
    let place = says("pos")?.map(|from| source.vector(from, "pos")).transpose()?.unwrap_or_default();
    let unit = if kind == Kind::Hinge { angles.unit } else { 1.0 };
    let reference = says("ref")?.map(|from| source.exactly::<1>(from, "ref")).transpose()?.flatten();
    let range = says("range")?.map(|from| source.exactly::<2>(from, "range")).transpose()?.flatten();
    let mut notes = Vec::new();
    let limited = match text("limited")? {
        Some("true") => true,
        Some("false") => false,
        None | Some("auto") => angles.autolimits && range.is_some(),
        Some(other) => return Err(refuse(format!("limited=\"{other}\": expected true, false or auto"), "correct it")),
    };
    let bounds = match (limited, range) {
        (true, Some([lower, upper])) if lower <= upper => Some([lower * unit, upper * unit]),
        (true, Some([lower, upper])) => {
            let what = format!("range=\"{lower} {upper}\": expected the lower bound first");
            return Err(refuse(what, "swap the two"));
        }
        (true, None) => return Err(refuse("limited=\"true\" without a range".into(), "add range=\"LOWER UPPER\"")),
        (false, Some(_)) => {
            notes.push("it has a range and is not limited: no bounds".to_owned());
            None
        }
        (false, None) => None,
    };
    Ok(Axis {
        place: (frame * Translation3::from(place)).translation.vector,
        axis: frame.rotation * axis,
        bounds,
        reference: reference.map_or(0.0, |[x]| x * unit),
        notes,
        ..bare(kind)
    })
}

/// The hinges and slides of a body; `top` bodies may be free in the world, which is left out.
pub(super) fn of_one_coordinate(
    source: &Source,
    axes: Vec<Axis>,
    top: bool,
    notes: &mut Vec<String>,
) -> Result<Vec<Axis>, RobotError> {
    let (kept, others): (Vec<Axis>, Vec<Axis>) = axes.into_iter().partition(|axis| axis.kind.moves());
    for axis in others {
        let place = source.place(axis.element);
        if !top {
            let what = format!("found a {} joint, expected hinge or slide", axis.kind.name());
            return Err(RobotError::new(
                place,
                what,
                "write a ball as three hinges at one place, about axes of their own",
            ));
        }
        notes.push(format!("{place}: a {} joint of the root, left out", axis.kind.name()));
    }
    Ok(kept)
}
