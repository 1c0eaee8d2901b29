//! Units of channels, and how names carry them.

pub use kinesic::servo::Unit;

/// Short names of the units, as in headers, tables of servos and on the command line.
pub const UNITS: [(&str, Unit); 6] = [
    ("rad", Unit::Radians),
    ("deg", Unit::Degrees),
    ("m", Unit::Metres),
    ("mm", Unit::Millimetres),
    ("ticks", Unit::Ticks),
    ("us", Unit::Microseconds),
];

/// Short name of a unit.
pub fn unit_name(unit: Unit) -> &'static str {
    UNITS.iter().find(|(_, known)| *known == unit).map_or("", |(name, _)| name)
}

/// The unit that a word means, in any case: a short name, or one that people write in headers.
pub fn unit_of(word: &str) -> Option<Unit> {
    let word = word.trim().to_lowercase();
    let short = UNITS.iter().find(|(name, _)| *name == word).map(|(_, unit)| *unit);
    short.or(match word.as_str() {
        "radian" | "radians" => Some(Unit::Radians),
        "degree" | "degrees" | "°" => Some(Unit::Degrees),
        "metre" | "metres" | "meter" | "meters" => Some(Unit::Metres),
        "millimetre" | "millimetres" | "millimeter" | "millimeters" => Some(Unit::Millimetres),
        "tick" | "steps" => Some(Unit::Ticks),
        "µs" | "μs" | "microseconds" => Some(Unit::Microseconds),
        _ => None,
    })
}

/// One column of numbers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Channel {
    /// Name without its unit.
    pub name: String,
    /// What the numbers count, as the file says it.
    pub unit: Option<Unit>,
}

impl Channel {
    /// What a header says: `pan_deg`, `pan [deg]`, `pan (deg)`, `pan`. LeRobot's `pan.pos` names no unit.
    pub fn from_header(header: &str) -> Self {
        let header = header.trim();
        let known = |name: &str, word: &str| {
            let name = name.trim();
            unit_of(word).filter(|_| !name.is_empty()).map(|unit| Self { name: name.to_owned(), unit: Some(unit) })
        };
        let bracketed = [('[', ']'), ('(', ')')].into_iter().find_map(|(open, close)| {
            let (name, word) = header.strip_suffix(close)?.rsplit_once(open)?;
            known(name, word)
        });
        let suffixed = || header.rsplit_once('_').and_then(|(name, word)| known(name, word));
        let plain = || header.strip_suffix(".pos").filter(|name| !name.is_empty()).unwrap_or(header);
        bracketed.or_else(suffixed).unwrap_or_else(|| Self { name: plain().to_owned(), unit: None })
    }

    /// As a header: `pan_deg`, or `pan` without a unit.
    pub fn header(&self) -> String {
        match self.unit.map(unit_name) {
            // A name that tells it from another one has its unit.
            Some(unit) if !self.name.ends_with(&format!("_{unit}")) => format!("{}_{unit}", self.name),
            _ => self.name.clone(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headers_carry_units() {
        for (header, name, unit) in [
            ("pan_deg", "pan", Some(Unit::Degrees)),
            ("pan [rad]", "pan", Some(Unit::Radians)),
            ("pan(°)", "pan", Some(Unit::Degrees)),
            ("lift_m", "lift", Some(Unit::Metres)),
            ("x_ticks", "x", Some(Unit::Ticks)),
            ("pwm_us", "pwm", Some(Unit::Microseconds)),
            ("pan.pos", "pan", None),
            ("_deg", "_deg", None),
            ("arm_left", "arm_left", None),
            ("x [V]", "x [V]", None),
        ] {
            let channel = Channel::from_header(header);
            assert_eq!((channel.name.as_str(), channel.unit), (name, unit), "{header}");
        }
        assert_eq!(Channel { name: "pan".into(), unit: Some(Unit::Degrees) }.header(), "pan_deg");
    }
}
