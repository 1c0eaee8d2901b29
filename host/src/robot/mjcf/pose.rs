//! Where things are, and how they are turned: `pos`, and one of five ways to write a rotation.

use nalgebra::{Isometry3, Matrix3, Quaternion, Rotation3, Translation3, Unit, UnitQuaternion, Vector3};

use super::super::RobotError;
use super::source::Source;

/// Vectors shorter than this show no direction.
const SHORTEST: f64 = 1e-9;

/// What `<compiler>` says of angles.
pub(super) struct Angles {
    /// Radians of one of the file's units.
    pub unit: f64,
    /// Axes of `euler`: 0 to 2.
    axes: [usize; 3],
    /// About axes that turn along, or about those that stay.
    turning: [bool; 3],
    /// Whether a range makes a joint limited.
    pub autolimits: bool,
}

impl Angles {
    /// Reads all `<compiler>` elements; later ones go first.
    pub fn read(source: &Source) -> Result<Self, RobotError> {
        let unit = std::f64::consts::PI / 180.0;
        let mut angles = Self { unit, axes: [0, 1, 2], turning: [true; 3], autolimits: true };
        for at in source.sections("compiler") {
            let refuse = |what: String, help: &str| RobotError::new(source.place(at), what, help);
            match source.get(at, "angle") {
                None => {}
                Some("degree") => angles.unit = unit,
                Some("radian") => angles.unit = 1.0,
                Some(other) => {
                    return Err(refuse(format!("angle=\"{other}\": expected degree or radian"), "correct it"));
                }
            }
            match source.get(at, "autolimits") {
                None => {}
                Some("true") => angles.autolimits = true,
                Some("false") => angles.autolimits = false,
                Some(other) => {
                    return Err(refuse(format!("autolimits=\"{other}\": expected true or false"), "correct it"));
                }
            }
            if source.get(at, "coordinate").is_some_and(|found| found != "local") {
                let what = "coordinate=\"global\": places relative to the world are of MuJoCo before 2.3.4";
                return Err(refuse(what.into(), "load and save it with MuJoCo 2.3.3, which writes local places"));
            }
            let Some(sequence) = source.get(at, "eulerseq") else { continue };
            let wrong = || {
                let what = format!("eulerseq=\"{sequence}\": expected three of x, y, z, X, Y, Z");
                refuse(what, "small letters turn along, capitals stay, as in \"xyz\"")
            };
            let letters = <[u8; 3]>::try_from(sequence.as_bytes()).map_err(|_| wrong())?;
            for (at, letter) in letters.into_iter().enumerate() {
                angles.axes[at] = b"xyz".iter().position(|x| *x == letter.to_ascii_lowercase()).ok_or_else(wrong)?;
                angles.turning[at] = letter.is_ascii_lowercase();
            }
        }
        Ok(angles)
    }

    /// Place and rotation of an element in its parent's frame.
    pub fn pose(&self, source: &Source, at: usize) -> Result<Isometry3<f64>, RobotError> {
        let place = Translation3::from(source.vector(at, "pos")?);
        Ok(Isometry3::from_parts(place, self.rotation(source, at)?))
    }

    fn rotation(&self, source: &Source, at: usize) -> Result<UnitQuaternion<f64>, RobotError> {
        let ways = ["quat", "axisangle", "xyaxes", "zaxis", "euler"];
        let given: Vec<&str> = ways.into_iter().filter(|way| source.get(at, way).is_some()).collect();
        if let &[first, second, ..] = &given[..] {
            let what = format!("it has both {first} and {second}, expected one rotation");
            return Err(RobotError::new(source.place(at), what, "leave one of the two out"));
        }
        let none = |name: &str| {
            let what = format!("{name}: found a vector of length zero, expected a direction");
            RobotError::new(source.place(at), what, "correct it, or leave it out")
        };
        let unit =
            |name: &str, x: &[f64]| Unit::try_new(Vector3::new(x[0], x[1], x[2]), SHORTEST).ok_or_else(|| none(name));
        if let Some([w, x, y, z]) = source.exactly::<4>(at, "quat")? {
            return UnitQuaternion::try_new(Quaternion::new(w, x, y, z), SHORTEST).ok_or_else(|| none("quat"));
        }
        if let Some(turn) = source.exactly::<4>(at, "axisangle")? {
            return Ok(UnitQuaternion::from_axis_angle(&unit("axisangle", &turn[..3])?, turn[3] * self.unit));
        }
        if let Some(axes) = source.exactly::<6>(at, "xyaxes")? {
            let x = unit("xyaxes", &axes[..3])?.into_inner();
            let y = unit("xyaxes", &axes[3..])?.into_inner();
            let y = (y - x * x.dot(&y)).try_normalize(SHORTEST).ok_or_else(|| none("xyaxes"))?;
            let turn = Rotation3::from_matrix_unchecked(Matrix3::from_columns(&[x, y, x.cross(&y)]));
            return Ok(UnitQuaternion::from_rotation_matrix(&turn));
        }
        if let Some(z) = source.exactly::<3>(at, "zaxis")? {
            let z = unit("zaxis", &z)?;
            let half = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI);
            return Ok(UnitQuaternion::rotation_between(&Vector3::z(), &z).unwrap_or(half));
        }
        let mut turn = UnitQuaternion::identity();
        if let Some(euler) = source.exactly::<3>(at, "euler")? {
            for (at, angle) in euler.into_iter().enumerate() {
                let axis = [Vector3::x_axis(), Vector3::y_axis(), Vector3::z_axis()][self.axes[at]];
                let one = UnitQuaternion::from_axis_angle(&axis, angle * self.unit);
                turn = if self.turning[at] { turn * one } else { one * turn };
            }
        }
        Ok(turn)
    }
}
