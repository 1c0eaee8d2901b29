//! Moves of Reachy Mini: `time`, and `set_target_data` with the head as a 4 x 4 matrix, antennas `[right, left]`, and the body's yaw.
//!
//! The head becomes six channels, m and rad: its place, and `R = Rz(yaw) Ry(pitch) Rx(roll)`. Beyond a pitch of a quarter turn roll and yaw
//! have no meaning; the robot stops at 40 degrees.

use std::fmt::Write;

use nalgebra::{Matrix3, Rotation3};

use super::build::Draft;
use super::records::{self, Others};
use super::spelling::clock;
use super::tape::{Node, quote};
use super::write::{number, numbers};
use super::{Channel, Extra, Format, Moves, MovesError, Options, Unit};

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

/// A matrix may be so far from a rotation: moves are written with few digits.
const ORTHOGONAL: f64 = 1e-3;

/// What of a target is joints.
#[derive(Clone, Copy, Default)]
struct Target<'a> {
    head: Option<Node<'a>>,
    antennas: Option<Node<'a>>,
    body_yaw: Option<Node<'a>>,
}

/// Reads a move.
pub(super) fn parse(whole: Node<'_>, size: usize, options: &Options) -> Result<Moves, MovesError> {
    let list = |key: &str| {
        whole.get(key).ok_or_else(|| {
            let what = format!("found no '{key}', expected one entry per frame");
            MovesError::new(whole.place(""), what, "a move of Reachy Mini has time and set_target_data")
        })
    };
    let (clock, targets) = (list("time")?, list("set_target_data")?);
    let times: Vec<f64> = clock
        .list(|| "time".into())?
        .enumerate()
        .map(|(frame, time)| time.finite(|| format!("time, frame {frame}")))
        .collect::<Result<_, _>>()?;
    let (mut values, mut others) = (Vec::new(), Others::new(size));
    let (mut turned, mut still) = ([0.0; 3], 0);
    for (frame, target) in targets.list(|| "set_target_data".into())?.enumerate() {
        let place = |key: &str| format!("set_target_data, frame {frame}, {key}");
        let mut own = Target::default();
        others.frame(target);
        for (key, value) in target.members() {
            match key {
                "head" => own.head = Some(value),
                "antennas" => own.antennas = Some(value),
                "body_yaw" => own.body_yaw = Some(value),
                _ => others.add(key, value)?,
            }
        }
        let (at, rotation) = head(own.head.unwrap_or(target), || place("head"))?;
        values.extend(at);
        // Angles go on from the frame before, whole turns included.
        let (roll, pitch, yaw) = rotation.euler_angles();
        for (now, last) in [roll, pitch, yaw].into_iter().zip(&mut turned) {
            *last = now + ((*last - now) / std::f64::consts::TAU).round() * std::f64::consts::TAU;
            values.push(*last);
        }
        let antennas: Vec<Node<'_>> = own.antennas.into_iter().flat_map(Node::items).take(3).collect();
        let [right, left] = antennas.as_slice() else {
            let what = "found another thing, expected two numbers: right, left";
            let line = own.antennas.unwrap_or(target).place(&place("antennas"));
            return Err(MovesError::new(line, what, "in radians, as in [0.1, -0.1]"));
        };
        values.push(right.finite(|| place("antennas"))?);
        values.push(left.finite(|| place("antennas"))?);
        still += usize::from(own.body_yaw.is_none());
        values.push(own.body_yaw.map_or(Ok(0.0), |yaw| yaw.finite(|| place("body_yaw")))?);
    }
    let frames = values.len() / CHANNELS.len();
    if times.len() != frames {
        let what = format!("found {frames} targets and {} times, expected as many", times.len());
        return Err(MovesError::new(targets.place("set_target_data"), what, "is the file whole?"));
    }
    let mut notes = Vec::new();
    if still > 0 {
        notes.push(format!("{still} of {frames} targets tell no body_yaw: 0 is assumed."));
    }
    let channels = CHANNELS.map(|(name, unit)| Channel { name: name.to_owned(), unit: Some(unit) }).to_vec();
    let labels = CHANNELS.map(|(name, _)| name.to_owned()).to_vec();
    let own = ["time", "set_target_data"];
    let fields = records::fields(whole.members().filter(|(key, _)| !own.contains(key)), size)?;
    let (columns, rows) = others.finish()?;
    let extra = Extra { fields, columns, rows, ..Extra::default() };
    let place = Box::new(|frame| format!("set_target_data, frame {frame}"));
    Draft { format: Format::Reachy, channels, labels, times: Some(times), fps: None, values, extra, notes, place }
        .finish(options)
}

/// Place and rotation of a 4 x 4 matrix.
fn head(value: Node<'_>, place: impl Fn() -> String) -> Result<([f64; 3], Rotation3<f64>), MovesError> {
    let refuse = |what: String, help: &str| MovesError::new(value.place(&place()), what, help);
    let shape = || refuse("found another thing, expected a 4 x 4 matrix".into(), "four lists of four numbers");
    let mut matrix = [[0.0; 4]; 4];
    let mut rows = value.items();
    for to in &mut matrix {
        let mut row = rows.next().filter(|row| row.is_list()).ok_or_else(shape)?.items();
        for to in to.iter_mut() {
            *to = row.next().ok_or_else(shape)?.finite(&place)?;
        }
        if row.next().is_some() {
            return Err(shape());
        }
    }
    if rows.next().is_some() || !value.is_list() {
        return Err(shape());
    }
    let [[a, b, c, x], [d, e, f, y], [g, h, i, z], last] = matrix;
    let rotation = Matrix3::new(a, b, c, d, e, f, g, h, i);
    let off = (rotation * rotation.transpose() - Matrix3::identity()).amax();
    // What overflows is no rotation either.
    if off.is_nan() || off > ORTHOGONAL || rotation.determinant() < 0.0 || last != [0.0, 0.0, 0.0, 1.0] {
        let what = format!("found a matrix that is no rotation and place (off by {off:.4}), expected one");
        return Err(refuse(what, "its upper 3 x 3 part is a rotation, its last row 0 0 0 1"));
    }
    Ok(([x, y, z], Rotation3::from_matrix_eps(&rotation, 1e-15, 100, Rotation3::from_matrix_unchecked(rotation))))
}

/// Writes a move; `None` where a channel of it is missing. Angles must be rad, lengths m.
pub(super) fn write(moves: &Moves) -> Option<String> {
    let fits = |at: usize, unit: Unit| moves.channels.get(at).is_some_and(|own| own.unit.is_none_or(|own| own == unit));
    let columns: Option<Vec<usize>> =
        CHANNELS.iter().map(|(name, own)| moves.find(name).filter(|at| fits(*at, *own))).collect();
    let columns = columns?;
    let mut out = String::from("{");
    for (key, value) in &moves.extra.fields {
        quote(key, &mut out);
        // Writing to a String cannot fail.
        let _ = write!(out, ": {value}, ");
    }
    let times = numbers(moves.times.iter().map(|time| clock(*time, 1.0)));
    let _ = write!(out, "\"time\": {times}, \"set_target_data\": [");
    for frame in 0..moves.frames() {
        let row = moves.frame(frame);
        let [x, y, z, roll, pitch, yaw, right, left, body]: [f64; 9] =
            std::array::from_fn(|at| columns.get(at).and_then(|at| row.get(*at)).copied().unwrap_or_default());
        let r = Rotation3::from_euler_angles(roll, pitch, yaw);
        out.push_str(if frame == 0 { "\n{\"head\": [" } else { ",\n{\"head\": [" });
        for (at, place) in [x, y, z].into_iter().enumerate() {
            let line = [0, 1, 2].map(|column| number(r[(at, column)])).join(", ");
            let _ = write!(out, "[{line}, {}], ", number(place));
        }
        let (right, left, body) = (number(right), number(left), number(body));
        let _ = write!(out, "[0.0, 0.0, 0.0, 1.0]], \"antennas\": [{right}, {left}], \"body_yaw\": {body}");
        for (key, value) in moves.extra.present(frame) {
            out.push_str(", ");
            quote(key, &mut out);
            let _ = write!(out, ": {value}");
        }
        out.push('}');
    }
    out.push_str("\n]}\n");
    Some(out)
}
