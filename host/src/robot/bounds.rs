//! What one joint of a machine may do: the table's numbers beside the description's, checked.

use kinesic::limit::{LONGEST_STOP, STEPS, stop_frames};
use kinesic::rig::JointKind;

use super::RobotError;
use super::keys::LARGEST;
use super::machine::{Defaults, Part};
use crate::limit::JointLimit;
use crate::moves::unit_name;

/// A coordinate without bounds goes so far, rad or m: 15 turns either way. No servo's bounds may lie beyond.
const UNLIMITED: f64 = 100.0;

/// A description's bounds beyond this mean that there are none, rad or m: degrees stay below.
const NONE: f64 = 1e3;

/// A servo without a given acceleration reaches its full speed in this time, s.
const START: f64 = 0.2;

/// Speed of a joint for which nobody gives one, rad/s (a turn per second) and m/s.
const SPEED: [f64; 2] = [std::f64::consts::TAU, 0.5];

/// A speed or an acceleration that stands in for others is at most so large.
const FASTEST: f64 = 1e5;

/// What was assumed, joint by joint, until notes of one kind become one line.
#[derive(Default)]
pub(super) struct Assumed {
    unbounded: [Vec<String>; 2],
    speed: [Vec<String>; 2],
    acceleration: Vec<String>,
    /// One sentence each.
    pub notes: Vec<String>,
}

impl Assumed {
    /// One sentence for each kind.
    pub fn notes(self) -> Vec<String> {
        let mut notes = self.notes;
        for (names, unit) in self.unbounded.iter().zip(["rad", "m"]).filter(|(names, _)| !names.is_empty()) {
            let kept = if names.len() == 1 { "it is kept" } else { "they are kept" };
            notes.push(format!("no bounds are known for {}; {kept} within {UNLIMITED} {unit}", names.join(", ")));
        }
        for ((names, unit), speed) in self.speed.iter().zip(["rad/s", "m/s"]).zip(SPEED) {
            if !names.is_empty() {
                let names = names.join(", ");
                notes.push(format!("no speed is known for {names}; {speed:.2} {unit} is assumed (--velocity)"));
            }
        }
        if !self.acceleration.is_empty() {
            let names = self.acceleration.join(", ");
            let assumed = format!("full speed in {START} s is assumed (--acceleration)");
            notes.push(format!("no acceleration is known for {names}; {assumed}"));
        }
        notes
    }
}

/// A joint with the numbers of its servo.
#[derive(Clone, Copy)]
struct Limits<'p> {
    part: &'p Part,
    /// Units of the servo in a rad or m.
    scale: f64,
    /// Unit of the servo.
    unit: &'static str,
    fps: f64,
}

/// What one joint may do. The table's bounds are kept beside the description's, the tighter of the two.
pub(super) fn limit(
    part: &Part,
    fps: f64,
    defaults: Defaults,
    assumed: &mut Assumed,
) -> Result<JointLimit, RobotError> {
    let coordinates = |limit: JointLimit| JointLimit {
        coordinates: crate::rig::JointCoordinates {
            reference: part.reference.coords.map(|x| x as f32).into(),
            ..limit.coordinates
        },
        ..limit
    };
    if part.kind == JointKind::Fixed {
        return Ok(coordinates(JointLimit::fixed()));
    }
    let slider = part.kind == JointKind::Slider;
    let otherwise = ["rad", "m"][usize::from(slider)];
    let (scale, unit) = (part.servo.scale(slider)?, part.servo.unit.map_or(otherwise, unit_name));
    let own = Limits { part, scale, unit, fps };
    if let Some(per_turn) = part.servo.per_turn.filter(|_| slider) {
        let name = &part.joint.name;
        assumed.notes.push(format!("{name}: a slider; per_turn = {per_turn} is taken as {per_turn} {unit} a metre"));
    }
    let [lower, upper] = own.bounds(assumed)?;
    let rest = own.rest([lower, upper])?;
    let (name, servo) = (&part.joint.name, &part.servo);
    let per_second = |value: Option<f64>| value.map(|value| value / scale.abs());
    let speed = [per_second(servo.speed), part.speed].into_iter().flatten().reduce(f64::min).or(defaults.velocity);
    let speed = speed.unwrap_or_else(|| {
        assumed.speed[usize::from(slider)].push(name.clone());
        SPEED[usize::from(slider)]
    });
    let acceleration = per_second(servo.acceleration).or(defaults.acceleration).unwrap_or_else(|| {
        assumed.acceleration.push(name.clone());
        speed / START
    });
    let jerk = per_second(servo.jerk).or(defaults.jerk).unwrap_or(0.0);
    let step = own.step("speed", "--velocity", speed, servo.speed.is_some(), 1)?;
    let change = own.step("acceleration", "--acceleration", acceleration, servo.acceleration.is_some(), 2)?;
    if jerk != 0.0 {
        let jerk = own.step("jerk", "--jerk", jerk, servo.jerk.is_some(), 3)?;
        own.stop(step, change, jerk)?;
    }
    let axis = part.axis.map(|x| x as f32).into();
    let mut limit =
        JointLimit::hinge(axis, [lower as f32, upper as f32], speed as f32, acceleration as f32).with_jerk(jerk as f32);
    limit.coordinates.kind = part.kind;
    limit.rest[0] = (rest as f32).clamp(limit.lower[0], limit.upper[0]);
    Ok(coordinates(limit))
}

impl Limits<'_> {
    /// Where a number of the table stands.
    fn place(&self, key: &str) -> String {
        let kind = if self.part.has_servo { "servo" } else { "pose" };
        format!("[[{kind}]] '{}', {key}", self.part.servo.name)
    }

    fn coordinate(&self, value: f64) -> f64 {
        (value - self.part.servo.zero) / self.scale
    }

    fn value(&self, coordinate: f64) -> f64 {
        self.part.servo.zero + self.scale * coordinate
    }

    fn si(&self) -> &'static str {
        if self.part.kind == JointKind::Slider { "m" } else { "rad" }
    }

    /// Least and greatest coordinate.
    fn bounds(&self, assumed: &mut Assumed) -> Result<[f64; 2], RobotError> {
        let (name, servo) = (&self.part.joint.name, &self.part.servo);
        let mut keys = [("min", servo.min), ("max", servo.max)];
        if self.scale < 0.0 {
            keys.reverse();
        }
        for (key, value) in keys {
            let Some(value) = value.filter(|value| self.coordinate(*value).abs() > 1.000_001 * UNLIMITED) else {
                continue;
            };
            let at = self.coordinate(value);
            let same = if self.unit == self.si() { String::new() } else { format!(", {} {}", short(at), self.si()) };
            let what = format!("found {value} {}{same}, expected {}", self.unit, self.farthest());
            let help = match self.unit {
                "rad" => "are these degrees? unit = \"deg\"",
                "m" => "are these millimetres? unit = \"mm\"",
                _ => "correct it, or per_turn and zero",
            };
            return Err(RobotError::new(self.place(key), what, help));
        }
        let [least, most] = keys.map(|(_, value)| value.map(|value| self.coordinate(value)));
        let described = self.part.bounds.map(|bound| bound.filter(|bound| bound.abs() < NONE));
        for (bound, known) in described.into_iter().zip([least, most]) {
            let Some(bound) = bound.filter(|bound| known.is_none() && bound.abs() > 1.000_001 * UNLIMITED) else {
                continue;
            };
            let what = format!("found a bound of {bound} {}, expected {}", self.si(), self.farthest());
            let help = "a description is in rad and m: are these degrees? Convert them, or give min and max of its servo (--servos)";
            return Err(RobotError::new(format!("joint '{name}'"), what, help));
        }
        let [low, high] = described;
        let lower = low.unwrap_or(-UNLIMITED).max(least.unwrap_or(-UNLIMITED)).max(-UNLIMITED);
        let upper = high.unwrap_or(UNLIMITED).min(most.unwrap_or(UNLIMITED)).min(UNLIMITED);
        if lower > upper {
            let what = format!("found bounds {lower:.4} and {upper:.4}, expected the lower one first");
            let help = "correct <limit>, or min and max of its servo";
            return Err(RobotError::new(format!("joint '{name}'"), what, help));
        }
        if [low, high, least, most].iter().all(Option::is_none) {
            assumed.unbounded[usize::from(self.si() == "m")].push(name.clone());
        }
        let out_of_reach = least.is_some_and(|least| least > 1e-6) || most.is_some_and(|most| most < -1e-6);
        if out_of_reach {
            let bound =
                |key: &str, value: Option<f64>| value.map_or(String::new(), |value| format!(", {key} = {value}"));
            assumed.notes.push(format!(
                "{name}: its 0 is out of reach, zero = {}{}{}: is zero right?",
                servo.zero,
                bound("min", servo.min),
                bound("max", servo.max)
            ));
        }
        Ok([lower, upper])
    }

    /// What a bound may be at most.
    fn farthest(&self) -> String {
        match self.part.kind {
            JointKind::Slider => format!("at most {UNLIMITED} m"),
            _ => format!("at most {UNLIMITED} rad, 15 turns"),
        }
    }

    fn rest(&self, [lower, upper]: [f64; 2]) -> Result<f64, RobotError> {
        let Some(value) = self.part.servo.rest else { return Ok(0f64.clamp(lower, upper)) };
        let rest = self.coordinate(value);
        if !(lower - 1e-6..=upper + 1e-6).contains(&rest) {
            let (a, b) = (self.value(lower), self.value(upper));
            let what = format!("found {value} {}, expected {} to {}", self.unit, short(a.min(b)), short(a.max(b)));
            return Err(RobotError::new(self.place("rest"), what, "rest lies within min and max"));
        }
        Ok(rest.clamp(lower, upper))
    }

    /// What a frame adds at a rate, as the device computes it; refused where it cannot.
    fn step(&self, key: &str, option: &str, rate: f64, by_table: bool, power: i32) -> Result<f32, RobotError> {
        let time = 1.0 / self.fps as f32;
        let step = (0..power).fold(1.0, |share, _| share * time) * rate as f32;
        if STEPS.contains(&step) {
            return Ok(step);
        }
        let per = ["/s", "/s^2", "/s^3"][power as usize - 1];
        let (place, scale, unit) = match by_table {
            true => (self.place(key), self.scale.abs(), self.unit),
            false => (format!("joint '{}', {key}", self.part.joint.name), 1.0, self.si()),
        };
        let [least, most] = [1.001e-6, 0.999e6].map(|step| scale * step * self.fps.powi(power));
        let most = most.min(if by_table || power == 3 { LARGEST } else { FASTEST });
        let none = if power == 3 { ", or 0 for no limit" } else { "" };
        let what = format!(
            "found {} {unit}{per}, expected {} to {} {unit}{per} at {} frames a second{none}",
            short(scale * rate),
            short(least),
            short(most),
            self.fps
        );
        let help = match by_table {
            true => "correct it; another frame rate (--fps) has another range".to_owned(),
            false => {
                format!("give it in a table of servos, or with {option}; another frame rate (--fps) has another range")
            }
        };
        Err(RobotError::new(place, what, help))
    }

    /// Refuses a jerk that makes stops too long; steps of frames.
    fn stop(&self, step: f32, change: f32, jerk: f32) -> Result<(), RobotError> {
        let frames = stop_frames(step, change, jerk);
        if frames < LONGEST_STOP {
            return Ok(());
        }
        let (by_table, name) = (self.part.servo.jerk.is_some(), &self.part.joint.name);
        let place = if by_table { self.place("jerk") } else { format!("joint '{name}', jerk") };
        let what = format!(
            "found a jerk with which a stop from full speed takes {frames:.0} frames at {} a second, expected fewer than {LONGEST_STOP}",
            self.fps
        );
        Err(RobotError::new(place, what, "raise jerk, or lower speed"))
    }
}

/// Four digits, or as many as a whole number has.
fn short(x: f64) -> String {
    if x == 0.0 || (x.fract() == 0.0 && x.abs() < 1e7) {
        return format!("{}", x + 0.0);
    }
    let size = x.abs().log10().floor() as i32;
    if !(-4..7).contains(&size) {
        let text = format!("{x:.3e}");
        let (digits, power) = text.split_once('e').unwrap_or((&text, "0"));
        return format!("{}e{power}", digits.trim_end_matches('0').trim_end_matches('.'));
    }
    let text = format!("{x:.*}", (3 - size).max(0) as usize);
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}
