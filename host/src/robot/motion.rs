//! A machine's motion: from the numbers in a file to coordinates, and back to what its servos take.

use std::fmt::Write;

use kinesic::servo::Servos;

use super::machine::{Machine, Servo};
use super::{ServoEntry, ServoTable};
use crate::clip::Clip;
use crate::clip::map::nearest;
use crate::moves::{Channel, Format, Moves, Unit, unit_name};
use crate::rig::{HostFrame, frame_of};

/// Beyond its range by more than this, rad or m, and by more than a twentieth of it, a coordinate is said to be outside.
const OUTSIDE: f64 = 0.02;

/// Why a motion is not one of this machine's.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MotionError {
    /// Joints without a channel.
    #[error(
        "{missing} of {joints} joints of the robot '{robot}' are not in the file: {names}{near}. Its columns are: {columns}. Name them as the \
         robot does (kinesic inspect ROBOT.kin)"
    )]
    Missing {
        /// How many.
        missing: usize,
        /// Of how many.
        joints: usize,
        /// Name of the robot.
        robot: String,
        /// Their names.
        names: String,
        /// What a name may have been meant to be.
        near: String,
        /// What there is.
        columns: String,
    },
    /// Two columns for one joint.
    #[error(
        "joint '{joint}': found two columns for it, '{first}' and '{second}', expected one: take the other out, or give it another name"
    )]
    Twice {
        /// Which joint.
        joint: String,
        /// A column.
        first: String,
        /// Another.
        second: String,
    },
    /// A unit that the joint cannot have.
    #[error("joint '{joint}': found {found}, expected {expected}")]
    Unit {
        /// Which joint.
        joint: String,
        /// The file's unit.
        found: String,
        /// What would do.
        expected: &'static str,
    },
    /// A unit that was assumed, and cannot be right.
    #[error(
        "joint '{joint}': the file names no unit, and taken as the robot's own, {unit}, {count} of {frames} frames are outside its range. Say \
         what angles are counted in: --angles deg, or name the column {joint}_deg"
    )]
    Assumed {
        /// Which joint.
        joint: String,
        /// The unit that was assumed.
        unit: &'static str,
        /// Frames outside.
        count: usize,
        /// Of how many.
        frames: usize,
    },
    /// Numbers that fit in degrees only.
    #[error(
        "joint '{joint}': found values from {low} to {high} {unit}, its range is {from:.3} to {to:.3} {unit}: these look like degrees. Say so with \
         --angles deg, or name the column {joint}_deg"
    )]
    Degrees {
        /// Which joint.
        joint: String,
        /// Least value.
        low: f64,
        /// Greatest value.
        high: f64,
        /// The unit that was taken.
        unit: &'static str,
        /// Least value that the joint can take.
        from: f64,
        /// Greatest value.
        to: f64,
    },
}

impl Machine {
    /// A motion as a clip of this machine: coordinates, rad and m, at the file's own rate, which must be even. `angles` says what angles
    /// are counted in where the file does not. What was assumed is in the clip's notes.
    pub fn clip(&self, moves: &Moves, angles: Option<Unit>) -> Result<Clip, MotionError> {
        let columns = self.columns(moves)?;
        let mut notes = moves.notes.clone();
        let ranges = self.ranges();
        let mut values = vec![0.0; moves.frames() * self.servos.len()];
        let mut assumed: Vec<String> = Vec::new();
        for (at, ((servo, column), range)) in self.servos.iter().zip(columns).zip(&ranges).enumerate() {
            let channel = &moves.channels[column];
            let told = told(servo, channel, moves.format, angles);
            if told.is_none() {
                assumed.push(format!("{} ({})", servo.name, unit_name(servo.unit)));
            }
            let unit = told.unwrap_or(servo.unit);
            let to = Conversion::new(servo, unit)?;
            let raw = || moves.values.iter().skip(column).step_by(moves.channels.len());
            let found: Vec<f64> = raw().map(|x| to.coordinate(*x)).collect();
            let outside = fits(servo, unit, raw().copied(), &found, *range, &mut notes)?;
            if told.is_none() && 2 * outside > found.len() {
                let (joint, unit, frames) = (servo.name.clone(), unit_name(servo.unit), found.len());
                return Err(MotionError::Assumed { joint, unit, count: outside, frames });
            }
            values.iter_mut().skip(at).step_by(self.servos.len()).zip(found).for_each(|(to, x)| *to = x);
        }
        if !assumed.is_empty() {
            notes.push(format!(
                "The file names no unit: the robot's own is assumed for {}. --angles deg or rad, or names like pan_deg, settle it.",
                listed(&assumed.iter().map(String::as_str).collect::<Vec<_>>())
            ));
        }
        let unknown: Vec<&str> = moves
            .channels
            .iter()
            .map(|channel| channel.name.as_str())
            .filter(|name| !self.servos.iter().any(|servo| same(&servo.name, name)))
            .collect();
        if !unknown.is_empty() {
            notes.push(format!("Columns that are no joints of the robot are left out: {}.", listed(&unknown)));
        }
        let frames: Vec<HostFrame> = values.chunks_exact(self.servos.len()).map(frame_of).collect();
        Ok(Clip { notes, ..self.rig.clip_of(&frames, 1.0 / moves.fps()) })
    }

    /// The unit in which [`clip`](Self::clip) takes every channel; none of a channel that is no joint.
    pub fn units(&self, moves: &Moves, angles: Option<Unit>) -> Result<Vec<Option<Unit>>, MotionError> {
        let mut units: Vec<Option<Unit>> = moves.channels.iter().map(|channel| channel.unit).collect();
        for (servo, column) in self.servos.iter().zip(self.columns(moves)?) {
            units[column] = told(servo, &moves.channels[column], moves.format, angles).or(Some(servo.unit));
        }
        Ok(units)
    }

    /// What the servos take, in their own units, frame by frame: the device's own arithmetic. With the extras of the motion that it was made
    /// of.
    pub fn moves(&self, clip: &Clip, from: Option<&Moves>) -> Moves {
        let channel = |servo: &Servo| Channel { name: servo.name.clone(), unit: Some(servo.unit) };
        let channels: Vec<Channel> = self.servos.iter().map(channel).collect();
        let mut values = Vec::with_capacity(clip.frames() * channels.len());
        for frame in self.rig.frames_of(clip) {
            let coordinates = self.servos.iter().zip(frame.coordinates());
            values.extend(coordinates.map(|(servo, x)| servo.value(*x)));
        }
        let times = (0..clip.frames()).map(|frame| frame as f64 * clip.frame_time).collect();
        match from {
            Some(from) => from.with(channels, times, values),
            None => Moves::new(channels, times, values),
        }
    }

    /// The column of every servo.
    fn columns(&self, moves: &Moves) -> Result<Vec<usize>, MotionError> {
        let names: Vec<&str> = self.servos.iter().map(|servo| servo.name.as_str()).collect();
        let found: Vec<Option<usize>> =
            names.iter().map(|name| column(name, &names, &moves.channels)).collect::<Result<_, _>>()?;
        if let Some(columns) = found.iter().copied().collect::<Option<Vec<usize>>>() {
            return Ok(columns);
        }
        let missing: Vec<&str> = self
            .servos
            .iter()
            .zip(&found)
            .filter(|(_, found)| found.is_none())
            .map(|(servo, _)| servo.name.as_str())
            .collect();
        let columns: Vec<&str> = moves.channels.iter().map(|channel| channel.name.as_str()).collect();
        let near = nearest(missing[0], columns.iter().copied());
        Err(MotionError::Missing {
            missing: missing.len(),
            joints: self.servos.len(),
            robot: self.name.clone(),
            names: listed(&missing),
            near: near.map_or(String::new(), |near| format!(" (is '{near}' meant for '{}'?)", missing[0])),
            columns: listed(&columns),
        })
    }
}

impl ServoTable {
    /// Takes the first frame of a motion, in the servos' own numbers, for their zeros: the robot stood at zero. `joints` are those that a
    /// servo turns; other columns are left alone.
    pub fn zero_from(&mut self, moves: &Moves, joints: &[&str]) -> Result<(), MotionError> {
        for joint in joints {
            let Some(column) = column(joint, joints, &moves.channels)? else { continue };
            let (channel, value) = (&moves.channels[column], moves.values[column]);
            let at = self.servos.iter().position(|servo| servo.name == *joint);
            let at = at.unwrap_or_else(|| {
                self.servos.push(ServoEntry::named(joint));
                self.servos.len() - 1
            });
            let servo = &mut self.servos[at];
            let own = servo.unit;
            if own.is_some() && channel.unit.is_some() && own != channel.unit {
                let found = channel.unit.map_or("", unit_name).to_owned();
                return Err(MotionError::Unit { joint: servo.name.clone(), found, expected: "the servo's own unit" });
            }
            // A servo without a unit takes rad or m.
            servo.zero = match channel.unit.filter(|_| own.is_none()) {
                Some(Unit::Degrees) => value.to_radians(),
                Some(Unit::Millimetres) => 1e-3 * value,
                Some(unit) if unit.is_whole() => {
                    let (joint, found) = (servo.name.clone(), unit_name(unit).to_owned());
                    return Err(MotionError::Unit {
                        joint,
                        found,
                        expected: "rad, deg, m or mm, or a table with its unit",
                    });
                }
                _ => value,
            };
        }
        Ok(())
    }
}

impl Servo {
    /// What the servo is told for a coordinate, as the device computes it.
    pub fn value(&self, coordinate: f32) -> f64 {
        let columns = ([0], [self.unit as u16], [self.scale], [self.zero]);
        let servos = Servos::new(&columns.0, &columns.1, &columns.2, &columns.3);
        let command = servos.ok().and_then(|servos| servos.command(0, coordinate));
        // The double that prints as the single does.
        command.map_or(f64::NAN, |command| command.value.to_string().parse().unwrap_or(f64::NAN))
    }
}

/// From a number in a file to a coordinate: `(x - zero) / scale`.
struct Conversion {
    zero: f64,
    scale: f64,
}

impl Conversion {
    /// The servo's own numbers have its zero, its sign and its gear; angles and lengths in other units are the joint's.
    fn new(servo: &Servo, unit: Unit) -> Result<Self, MotionError> {
        if servo.unit == unit {
            return Ok(Self { zero: f64::from(servo.zero), scale: f64::from(servo.scale) });
        }
        let length = is_length(servo.unit);
        let scale = match unit {
            Unit::Radians if !length => 1.0,
            Unit::Degrees if !length => 180.0 / std::f64::consts::PI,
            Unit::Metres if length => 1.0,
            Unit::Millimetres if length => 1000.0,
            other => {
                let expected = if length { "m or mm" } else { "rad, deg, or the servo's own unit" };
                return Err(MotionError::Unit {
                    joint: servo.name.clone(),
                    found: unit_name(other).to_owned(),
                    expected,
                });
            }
        };
        Ok(Self { zero: 0.0, scale })
    }

    fn coordinate(&self, value: f64) -> f64 {
        (value - self.zero) / self.scale
    }
}

/// Refuses numbers that fit as degrees only, and says which leave the range; the number of frames that do.
fn fits(
    servo: &Servo,
    unit: Unit,
    raw: impl Iterator<Item = f64> + Clone,
    found: &[f64],
    [lower, upper]: [f64; 2],
    notes: &mut Vec<String>,
) -> Result<usize, MotionError> {
    let margin = OUTSIDE.max(0.05 * (upper - lower));
    let outside = |x: &f64| !(lower - margin..=upper + margin).contains(x);
    let count = found.iter().filter(|x| outside(x)).count();
    let (low, high) = raw.clone().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
    if unit == Unit::Radians && high.abs().max(low.abs()) > 4.0 * std::f64::consts::PI {
        let degrees = raw.clone().map(f64::to_radians);
        if degrees.clone().all(|x| !outside(&x)) {
            let (joint, unit) = (servo.name.clone(), "rad");
            return Err(MotionError::Degrees { joint, low, high, unit, from: lower, to: upper });
        }
    }
    if count > 0 {
        let (least, most) = found.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(*x), b.max(*x)));
        notes.push(format!(
            "Joint '{}' goes from {least:.3} to {most:.3}, outside its range of {lower:.3} to {upper:.3}, in {count} of {} frames.",
            servo.name,
            found.len()
        ));
    }
    Ok(count)
}

/// The unit that the file, its format or the caller says.
fn told(servo: &Servo, channel: &Channel, format: Format, angles: Option<Unit>) -> Option<Unit> {
    let length = is_length(servo.unit);
    // A trajectory of ROS is in rad and m, whatever the servo takes.
    let ros = (format == Format::Trajectory).then_some(if length { Unit::Metres } else { Unit::Radians });
    channel.unit.or(ros).or(angles.filter(|_| !length))
}

/// The column of a joint. A name that differs in case and separators only means it too, unless it is another joint's own.
fn column(joint: &str, joints: &[&str], channels: &[Channel]) -> Result<Option<usize>, MotionError> {
    let own = |name: &str| joints.iter().any(|other| *other == name && *other != joint);
    let means = |channel: &Channel| {
        let name = bare(channel);
        channel.name == joint || same(name, joint) && !own(&channel.name) && !own(name)
    };
    let mut all = channels.iter().enumerate().filter(|(_, channel)| means(channel));
    let first = all.next();
    match (first, all.next()) {
        (Some((_, first)), Some((_, second))) => {
            Err(MotionError::Twice { joint: joint.to_owned(), first: first.header(), second: second.header() })
        }
        _ => Ok(first.map(|(at, _)| at)),
    }
}

/// A channel's name without the unit that tells it from another of its name.
fn bare(channel: &Channel) -> &str {
    let unit = channel.unit.map(unit_name);
    unit.and_then(|unit| channel.name.strip_suffix(unit)?.strip_suffix('_')).unwrap_or(&channel.name)
}

/// The same name, whatever its case and separators.
fn same(a: &str, b: &str) -> bool {
    let plain =
        |name: &str| name.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect::<String>();
    plain(a) == plain(b)
}

fn is_length(unit: Unit) -> bool {
    matches!(unit, Unit::Metres | Unit::Millimetres)
}

/// A few names, and how many more there are.
fn listed(names: &[&str]) -> String {
    const FEW: usize = 12;
    let mut text = names.iter().take(FEW).copied().collect::<Vec<_>>().join(", ");
    if names.len() > FEW {
        let _ = write!(text, " and {} more", names.len() - FEW);
    }
    text
}
