//! What an MJCF says for all: units and order of angles, and the defaults of joints by class.

use std::collections::HashMap;

use nalgebra::{Isometry3, Matrix3, Rotation3, Translation3, UnitQuaternion, Vector3};
use roxmltree::Node;

use super::super::RobotError;
use super::super::xml::{Xml, numbers};

/// The attributes of a joint that say how it moves.
pub(super) const JOINT: [&str; 6] = ["type", "pos", "axis", "range", "ref", "limited"];

/// Values of [`JOINT`], where they are given.
pub(super) type Given<'a> = [Option<&'a str>; JOINT.len()];

/// The element `compiler` and the defaults.
pub(super) struct Settings<'a> {
    /// Radians in a unit of angle.
    pub angle: f64,
    /// Axes of Euler angles, in order; capitals turn about fixed axes.
    eulerseq: String,
    /// A range limits a joint that does not say.
    pub autolimits: bool,
    classes: HashMap<&'a str, Given<'a>>,
}

impl<'a> Settings<'a> {
    pub fn read<'t: 'a>(xml: &'a Xml<'t>) -> Result<Self, RobotError> {
        let root = xml.document.root_element();
        let mut settings =
            Self { angle: 1f64.to_radians(), eulerseq: "xyz".into(), autolimits: true, classes: HashMap::new() };
        for node in root.children().filter(|node| node.has_tag_name("compiler")) {
            let refuse = |key: &str, found: &str, expected: &str| {
                let what = format!("<compiler {key}=\"{found}\">: expected {expected}");
                RobotError::new(format!("line {}", xml.line(node)), what, "MuJoCo refuses it too; correct it")
            };
            match node.attribute("angle") {
                None => {}
                Some("degree") => settings.angle = 1f64.to_radians(),
                Some("radian") => settings.angle = 1.0,
                Some(other) => return Err(refuse("angle", other, "degree or radian")),
            }
            if let Some(found) = node.attribute("eulerseq") {
                if found.len() != 3 || !found.chars().all(|axis| "xyzXYZ".contains(axis)) {
                    return Err(refuse("eulerseq", found, "three of x, y, z, X, Y, Z"));
                }
                settings.eulerseq = found.to_owned();
            }
            if node.attribute("coordinate") == Some("global") {
                return Err(refuse("coordinate", "global", "local frames"));
            }
            if let Some(found) = node.attribute("autolimits") {
                settings.autolimits = found != "false";
            }
        }
        let mut open: Vec<(Node, Given)> =
            root.children().filter(|node| node.has_tag_name("default")).map(|node| (node, Given::default())).collect();
        while let Some((node, above)) = open.pop() {
            let top = node.parent() == Some(root);
            let class = node.attribute("class").or(top.then_some("main")).ok_or_else(|| {
                let place = format!("line {}", xml.line(node));
                RobotError::new(
                    place,
                    "found a <default> without a class",
                    "expected class=\"...\": only the outermost needs none",
                )
            })?;
            let mut given = self::given(node.children().filter(|node| node.has_tag_name("joint")), above);
            // Sections of one class add up.
            if let Some(before) = settings.classes.get(class) {
                given.iter_mut().zip(before).for_each(|(given, before)| *given = given.or(*before));
            }
            settings.classes.insert(class, given);
            open.extend(node.children().filter(|node| node.has_tag_name("default")).map(|node| (node, given)));
        }
        Ok(settings)
    }

    /// What a joint says, and what its class says where it does not.
    pub fn joint(&self, node: Node<'a, '_>, class: Option<&'a str>, place: &str) -> Result<Given<'a>, RobotError> {
        let class = node.attribute("class").or(class);
        let defaults = match class {
            None => self.classes.get("main").copied().unwrap_or_default(),
            Some(class) => *self.classes.get(class).ok_or_else(|| {
                let what = format!("its class '{class}' is no <default> of the file, which has {}", self.classes.len());
                RobotError::new(place, what, format!("add <default class=\"{class}\"> or correct the name"))
            })?,
        };
        Ok(given([node].into_iter(), defaults))
    }

    /// The frame that `pos` and an orientation give, in the parent's.
    pub fn frame(&self, node: Node, place: &str) -> Result<Isometry3<f64>, RobotError> {
        let of = |key: &str, count: usize| -> Result<Option<Vec<f64>>, RobotError> {
            let Some(text) = node.attribute(key) else { return Ok(None) };
            let found = numbers(text).filter(|found| found.len() == count).ok_or_else(|| {
                RobotError::new(
                    place,
                    format!("{key}=\"{text}\": expected {count} numbers"),
                    "MuJoCo refuses it too; correct it",
                )
            })?;
            Ok(Some(found))
        };
        let three = |values: &[f64]| Vector3::from_iterator(values.iter().copied().chain([0.0; 3]).take(3));
        let direction = |key: &str, vector: Vector3<f64>| {
            vector.try_normalize(1e-9).ok_or_else(|| {
                RobotError::new(place, format!("{key}: found a vector of length zero"), "expected a direction")
            })
        };
        let at = of("pos", 3)?.map_or_else(Vector3::zeros, |at| three(&at));
        let mut turn = UnitQuaternion::identity();
        if let Some(q) = of("quat", 4)? {
            let q = nalgebra::Quaternion::new(q[0], q[1], q[2], q[3]);
            turn = UnitQuaternion::try_new(q, 1e-9).ok_or_else(|| {
                RobotError::new(place, "quat: found four zeros", "expected w x y z, as in \"1 0 0 0\"")
            })?;
        }
        if let Some(found) = of("axisangle", 4)? {
            let axis = direction("axisangle", three(&found))?;
            turn = UnitQuaternion::from_scaled_axis(axis * found[3] * self.angle);
        }
        if let Some(found) = of("euler", 3)? {
            turn = self.euler(&found);
        }
        if let Some(found) = of("xyaxes", 6)? {
            let x = direction("xyaxes", three(&found))?;
            let y = three(&found[3..]);
            let y = direction("xyaxes", y - x * x.dot(&y))?;
            turn = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(Matrix3::from_columns(&[
                x,
                y,
                x.cross(&y),
            ])));
        }
        if let Some(found) = of("zaxis", 3)? {
            let z = direction("zaxis", three(&found))?;
            let half = || UnitQuaternion::from_scaled_axis(Vector3::x() * std::f64::consts::PI);
            turn = UnitQuaternion::rotation_between(&Vector3::z(), &z).unwrap_or_else(half);
        }
        Ok(Isometry3::from_parts(Translation3::from(at), turn))
    }

    fn euler(&self, angles: &[f64]) -> UnitQuaternion<f64> {
        let mut turn = UnitQuaternion::identity();
        for (axis, angle) in self.eulerseq.chars().zip(angles) {
            let about = match axis.to_ascii_lowercase() {
                'x' => Vector3::x(),
                'y' => Vector3::y(),
                _ => Vector3::z(),
            };
            let next = UnitQuaternion::from_scaled_axis(about * *angle * self.angle);
            turn = if axis.is_ascii_lowercase() { turn * next } else { next * turn };
        }
        turn
    }
}

/// The later element's word goes first.
fn given<'a, 'b: 'a>(nodes: impl Iterator<Item = Node<'a, 'b>>, mut given: Given<'a>) -> Given<'a> {
    for node in nodes {
        given.iter_mut().zip(JOINT).for_each(|(given, key)| *given = node.attribute(key).or(*given));
    }
    given
}
