//! Units of channels, and how names carry them.

use serde::Serialize;

/// What the numbers of a channel count.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Unit {
    /// rad.
    Radians,
    /// Degrees.
    Degrees,
    /// m.
    Metres,
    /// mm.
    Millimetres,
    /// Steps of an encoder or of a smart servo.
    Ticks,
    /// Length of a servo's pulse, us.
    Microseconds,
    /// Hundredths of a joint's range.
    Percent,
}

impl Unit {
    /// Short name, as in a header's suffix.
    pub fn name(self) -> &'static str {
        match self {
            Self::Radians => "rad",
            Self::Degrees => "deg",
            Self::Metres => "m",
            Self::Millimetres => "mm",
            Self::Ticks => "ticks",
            Self::Microseconds => "us",
            Self::Percent => "percent",
        }
    }

    /// The unit that a word means, in any case.
    pub fn parse(word: &str) -> Option<Self> {
        Some(match word.trim().to_lowercase().as_str() {
            "rad" | "radian" | "radians" => Self::Radians,
            "deg" | "degree" | "degrees" | "°" => Self::Degrees,
            "m" | "metre" | "metres" | "meter" | "meters" => Self::Metres,
            "mm" | "millimetre" | "millimetres" | "millimeter" | "millimeters" => Self::Millimetres,
            "tick" | "ticks" | "steps" => Self::Ticks,
            "us" | "µs" | "μs" | "microseconds" => Self::Microseconds,
            "percent" | "pct" | "%" => Self::Percent,
            _ => return None,
        })
    }
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
            Unit::parse(word).filter(|_| !name.is_empty()).map(|unit| Self { name: name.to_owned(), unit: Some(unit) })
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
        match self.unit.map(Unit::name) {
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
