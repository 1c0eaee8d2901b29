//! Moves of Reachy Mini: `time`, and `set_target_data` with the head as a 4 x 4 matrix, antennas `[right, left]`, and the body's yaw.
//!
//! The head becomes six channels, m and rad: its place, and `R = Rz(yaw) Ry(pitch) Rx(roll)`. Beyond a pitch of a quarter turn roll and yaw
//! have no meaning; the robot stops at 40 degrees.

use nalgebra::{Matrix3, Rotation3};
use serde_json::{Map, Value, json};

use super::build::Draft;
use super::json::{bounded, finite};
use super::{Channel, Extra, Format, Moves, MovesError, Options, Unit, unit_name};

/// The channels, in order.
pub(super) const CHANNELS: [(&str, Unit); 9] = [
    ("head_x", Unit::Metres),
    ("head_y", Unit::Metres),
    ("head_z", Unit::Metres),
    ("head_roll", Unit::Radians),
    ("head_pitch", Unit::Radians),
    ("head_yaw", Unit::Radians),
    ("right_antenna", Unit::Radians),
    ("left_antenna", Unit::Radians),
    ("body_yaw", Unit::Radians),
];

/// What of a target is joints.
const OWN: [&str; 3] = ["head", "antennas", "body_yaw"];

/// A matrix may be so far from a rotation: moves are written with few digits.
const ORTHOGONAL: f64 = 1e-3;

/// Reads a move.
pub(super) fn parse(whole: &Map<String, Value>, options: &Options) -> Result<Moves, MovesError> {
    let list = |key: &str| {
        whole.get(key).and_then(Value::as_array).ok_or_else(|| {
            let what = "found no list, expected one entry per frame";
            MovesError::new(key, what, "a move of Reachy Mini has time and set_target_data")
        })
    };
    let (clock, targets) = (list("time")?, list("set_target_data")?);
    if clock.len() != targets.len() {
        let what = format!("found {} targets and {} times, expected as many", targets.len(), clock.len());
        return Err(MovesError::new("set_target_data", what, "is the file whole?"));
    }
    let times = clock
        .iter()
        .enumerate()
        .map(|(frame, time)| finite(time, || format!("time, frame {frame}")))
        .collect::<Result<_, _>>()?;
    let mut values = Vec::with_capacity(9 * targets.len());
    let mut extra = Extra {
        fields: whole
            .iter()
            .filter(|(key, _)| *key != "time" && *key != "set_target_data")
            .map(|(k, v)| (k.clone(), v.clone()))
            .collect(),
        ..Extra::default()
    };
    let others = targets.first().and_then(Value::as_object).into_iter().flatten().map(|(key, _)| key);
    extra.columns = others.filter(|key| !OWN.contains(&key.as_str())).cloned().collect();
    if let Some(first) = targets.first().and_then(Value::as_object) {
        bounded(&extra.columns, first, targets)?;
    }
    let mut turned = [0.0; 3];
    let yawless = targets.first().is_some_and(|target| target.get("body_yaw").is_none());
    for (frame, target) in targets.iter().enumerate() {
        let place = |key: &str| format!("set_target_data, frame {frame}, {key}");
        let (at, rotation) = head(target.get("head").unwrap_or(&Value::Null), || place("head"))?;
        values.extend(at);
        // Angles go on from the frame before, whole turns included.
        let (roll, pitch, yaw) = rotation.euler_angles();
        for (now, last) in [roll, pitch, yaw].into_iter().zip(&mut turned) {
            *last = now + ((*last - now) / std::f64::consts::TAU).round() * std::f64::consts::TAU;
            values.push(*last);
        }
        let antennas = target.get("antennas").and_then(Value::as_array).map(Vec::as_slice).unwrap_or_default();
        let [right, left] = antennas else {
            let what = format!("found {} numbers, expected two: right, left", antennas.len());
            return Err(MovesError::new(place("antennas"), what, "in radians, as in [0.1, -0.1]"));
        };
        values.push(finite(right, || place("antennas"))?);
        values.push(finite(left, || place("antennas"))?);
        values.push(target.get("body_yaw").map_or(Ok(0.0), |yaw| finite(yaw, || place("body_yaw")))?);
        if !extra.columns.is_empty() {
            extra.rows.push(extra.columns.iter().map(|key| target.get(key).cloned().unwrap_or(Value::Null)).collect());
        }
    }
    let mut notes = Vec::new();
    if yawless {
        notes.push("The move tells no body_yaw: 0 is assumed.".to_owned());
    }
    let channels = CHANNELS.map(|(name, unit)| Channel { name: name.to_owned(), unit: Some(unit) }).to_vec();
    let place = Box::new(|frame| format!("set_target_data, frame {frame}"));
    Draft { format: Format::Reachy, channels, times: Some(times), fps: None, values, extra, notes, place }
        .finish(options)
}

/// Place and rotation of a 4 x 4 matrix.
fn head(value: &Value, place: impl Fn() -> String) -> Result<([f64; 3], Rotation3<f64>), MovesError> {
    let shape = || {
        MovesError::new(
            place(),
            "found another shape, expected a 4 x 4 matrix of numbers",
            "four lists of four numbers",
        )
    };
    let rows = value.as_array().filter(|rows| rows.len() == 4).ok_or_else(shape)?;
    let mut matrix = [[0.0; 4]; 4];
    for (to, row) in matrix.iter_mut().zip(rows) {
        let row = row.as_array().filter(|row| row.len() == 4).ok_or_else(shape)?;
        for (to, x) in to.iter_mut().zip(row) {
            *to = finite(x, &place)?;
        }
    }
    let [[a, b, c, x], [d, e, f, y], [g, h, i, z], last] = matrix;
    let rotation = Matrix3::new(a, b, c, d, e, f, g, h, i);
    let off = (rotation * rotation.transpose() - Matrix3::identity()).amax();
    if off > ORTHOGONAL || rotation.determinant() < 0.0 || last != [0.0, 0.0, 0.0, 1.0] {
        let what = format!("found a matrix that is no rotation and place (off by {off:.4}), expected one");
        return Err(MovesError::new(place(), what, "its upper 3 x 3 part is a rotation, its last row 0 0 0 1"));
    }
    Ok(([x, y, z], Rotation3::from_matrix_eps(&rotation, 1e-15, 100, Rotation3::from_matrix_unchecked(rotation))))
}

/// Writes a move. Angles must be rad, lengths m; a joint that is missing, or in another unit, is named.
pub(super) fn write(moves: &Moves) -> Result<Value, MovesError> {
    let mut columns = [0; 9];
    for (column, (name, own)) in columns.iter_mut().zip(CHANNELS) {
        let found = match moves.find(name) {
            None => {
                format!("found no joint '{name}', expected it in {}, as a move of Reachy Mini has it", unit_name(own))
            }
            Some(at) => match moves.channels[at].unit {
                Some(unit) if unit != own => format!(
                    "joint '{name}': found it in {}, expected {}, as a move of Reachy Mini has it",
                    unit_name(unit),
                    unit_name(own)
                ),
                _ => {
                    *column = at;
                    continue;
                }
            },
        };
        let help = "write .csv, or take a robot whose head, antennas and body_yaw are in m and rad";
        return Err(MovesError::new("", found, help));
    }
    let target = |frame: usize| {
        let row = moves.frame(frame);
        let [x, y, z, roll, pitch, yaw, right, left, body]: [f64; 9] = std::array::from_fn(|at| row[columns[at]]);
        let r = Rotation3::from_euler_angles(roll, pitch, yaw);
        let m = r.matrix();
        let line = |at: usize, place: f64| json!([m[(at, 0)], m[(at, 1)], m[(at, 2)], place]);
        let mut target = Map::new();
        for (key, value) in moves.extra.columns.iter().zip(moves.extra.rows.get(frame).into_iter().flatten()) {
            target.insert(key.clone(), value.clone());
        }
        target.insert("head".into(), json!([line(0, x), line(1, y), line(2, z), [0.0, 0.0, 0.0, 1.0]]));
        target.insert("antennas".into(), json!([right, left]));
        target.insert("body_yaw".into(), json!(body));
        Value::Object(target)
    };
    let mut whole = moves.extra.fields.clone();
    whole.insert("time".into(), json!(moves.times));
    whole.insert("set_target_data".into(), (0..moves.frames()).map(target).collect());
    Ok(Value::Object(whole))
}
