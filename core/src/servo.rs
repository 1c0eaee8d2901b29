//! Servos: what a coordinate is as the number that a servo takes.
//!
//! `value = zero + scale coordinate`, in the servo's own unit. Sign, gear and zero are in the pack, so that firmware has no table of its
//! own. A coordinate without a servo has no value.

use crate::model::{LoadError, Pack};
use crate::rig::Rig;

/// What a servo's values are counted in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u16)]
pub enum Unit {
    /// rad.
    Radians = 0,
    /// Degrees.
    Degrees = 1,
    /// m.
    Metres = 2,
    /// mm.
    Millimetres = 3,
    /// Whole steps of the servo's encoder.
    Ticks = 4,
    /// Length of a pulse, whole microseconds.
    Microseconds = 5,
}

impl Unit {
    /// The unit with this number in the tensor `servo/units`.
    pub fn from_code(code: u16) -> Option<Self> {
        match code {
            0 => Some(Self::Radians),
            1 => Some(Self::Degrees),
            2 => Some(Self::Metres),
            3 => Some(Self::Millimetres),
            4 => Some(Self::Ticks),
            5 => Some(Self::Microseconds),
            _ => None,
        }
    }

    /// Whether values are whole numbers.
    pub fn is_whole(self) -> bool {
        matches!(self, Self::Ticks | Self::Microseconds)
    }
}

/// Stands for a coordinate without a servo in the tensor `servo/ids`.
pub const NO_SERVO: u16 = u16::MAX;

/// What one servo is told.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Command {
    /// The servo's id on its bus, or its channel.
    pub id: u16,
    /// Where it goes, in its own unit; a whole number for [ticks and pulses](Unit::is_whole).
    pub value: f32,
    /// The unit.
    pub unit: Unit,
}

impl Command {
    /// The value as a whole number, for ticks and pulses. Values beyond what an `i32` holds are held at its ends.
    pub fn whole(&self) -> i32 {
        nearest(self.value)
    }
}

/// The servos of a machine, borrowed from a pack: one per coordinate of its rig.
#[derive(Clone, Copy, Debug)]
pub struct Servos<'a> {
    ids: &'a [u16],
    units: &'a [u16],
    scale: &'a [f32],
    zero: &'a [f32],
}

impl<'a> Servos<'a> {
    /// The servos of a pack. A pack of a body has none: [`LoadError::NoTensor`].
    pub fn load(pack: &Pack<'a>) -> Result<Self, LoadError> {
        let coordinates = Rig::load(pack)?.coordinates();
        Self::new(
            pack.slice("servo/ids", coordinates)?,
            pack.slice("servo/units", coordinates)?,
            pack.slice("servo/scale", coordinates)?,
            pack.slice("servo/zero", coordinates)?,
        )
    }

    /// Servos from their columns, one entry per coordinate.
    ///
    /// - `ids`: of the servo that turns the coordinate, [`NO_SERVO`] where there is none; no two alike
    /// - `units`: [`Unit`] of its values
    /// - `scale`: units per rad or m, negative where it turns the other way, 1e-6 to 1e9 in size
    /// - `zero`: its value where the coordinate is 0, within 1e9
    pub fn new(ids: &'a [u16], units: &'a [u16], scale: &'a [f32], zero: &'a [f32]) -> Result<Self, LoadError> {
        let count = |tensor, found| match found == ids.len() {
            true => Ok(()),
            false => Err(LoadError::Shape { tensor, found, expected: ids.len() }),
        };
        let value =
            |tensor, index: Option<usize>| index.map_or(Ok(()), |index| Err(LoadError::Value { tensor, index }));
        count("servo/units", units.len())?;
        count("servo/scale", scale.len())?;
        count("servo/zero", zero.len())?;
        let twice = |(index, id): (usize, &u16)| *id != NO_SERVO && ids.iter().take(index).any(|other| other == id);
        value("servo/ids", ids.iter().enumerate().position(twice))?;
        value("servo/units", units.iter().position(|code| Unit::from_code(*code).is_none()))?;
        value("servo/scale", scale.iter().position(|x| !(1e-6..1e9).contains(&x.abs())))?;
        value("servo/zero", zero.iter().position(|x| !(-1e9..1e9).contains(x)))?;
        Ok(Self { ids, units, scale, zero })
    }

    /// Number of coordinates.
    pub fn coordinates(&self) -> usize {
        self.ids.len()
    }

    /// What the servo of one coordinate is told; `None` for a coordinate that has no servo, or that the rig does not have.
    /// Cost: a multiply-add.
    pub fn command(&self, index: usize, coordinate: f32) -> Option<Command> {
        let id = *self.ids.get(index)?;
        let unit = Unit::from_code(*self.units.get(index)?)?;
        let value = self.zero.get(index)? + self.scale.get(index)? * coordinate;
        let value = if unit.is_whole() { nearest(value) as f32 } else { value };
        (id != NO_SERVO).then_some(Command { id, value, unit })
    }

    /// What every servo is told, in the order of the coordinates: of what
    /// [`Pipeline::step_coordinates`](crate::Pipeline::step_coordinates) gave.
    pub fn commands(&self, coordinates: &[f32]) -> impl Iterator<Item = Command> {
        coordinates.iter().enumerate().filter_map(|(index, coordinate)| self.command(index, *coordinate))
    }

    /// The coordinate at which the servo `id` stands when it reports `value`; with it the coordinate's index. `None` for an unknown servo.
    /// Cost: a division, and a walk over the ids.
    pub fn coordinate(&self, id: u16, value: f32) -> Option<(usize, f32)> {
        let index = self.ids.iter().position(|own| *own == id && id != NO_SERVO)?;
        Some((index, (value - self.zero.get(index)?) / self.scale.get(index)?))
    }
}

/// The nearest whole number, halves away from zero.
fn nearest(x: f32) -> i32 {
    (x + if x < 0.0 { -0.5 } else { 0.5 }) as i32
}

#[cfg(test)]
mod tests {
    use super::*;

    const IDS: [u16; 3] = [7, NO_SERVO, 3];
    const UNITS: [u16; 3] = [Unit::Ticks as u16, Unit::Radians as u16, Unit::Degrees as u16];
    const SCALE: [f32; 3] = [-651.898_6, 1.0, 57.295_78];
    const ZERO: [f32; 3] = [2048.0, 0.0, 90.0];

    #[test]
    fn a_coordinate_becomes_the_servo_s_own_number_and_comes_back() {
        let servos = Servos::new(&IDS, &UNITS, &SCALE, &ZERO).unwrap();
        let found: [Option<Command>; 4] = core::array::from_fn(|index| servos.command(index, 0.5));
        assert_eq!(found[0], Some(Command { id: 7, value: 1722.0, unit: Unit::Ticks }));
        assert_eq!(found[0].unwrap().whole(), 1722);
        assert_eq!((found[1], found[3]), (None, None));
        assert!((found[2].unwrap().value - 118.647_89).abs() < 1e-4);
        assert_eq!(servos.commands(&[0.5; 9]).count(), 2);
        let (index, back) = servos.coordinate(7, 1722.0).unwrap();
        assert!(index == 0 && (back - 0.5).abs() < 1e-3);
        assert_eq!((servos.coordinate(5, 0.0), servos.coordinate(NO_SERVO, 0.0)), (None, None));
    }

    #[test]
    fn columns_that_make_no_servos_are_refused_by_name() {
        let refused = |ids: [u16; 3], units: [u16; 3], scale: [f32; 3], zero: [f32; 3]| {
            Servos::new(&ids, &units, &scale, &zero).unwrap_err()
        };
        let value = |tensor, index| LoadError::Value { tensor, index };
        assert_eq!(refused([1, 2, 1], UNITS, SCALE, ZERO), value("servo/ids", 2));
        assert_eq!(refused(IDS, [0, 9, 0], SCALE, ZERO), value("servo/units", 1));
        assert_eq!(refused(IDS, UNITS, [0.0, 1.0, 1.0], ZERO), value("servo/scale", 0));
        assert_eq!(refused(IDS, UNITS, SCALE, [0.0, 0.0, f32::NAN]), value("servo/zero", 2));
        assert!(matches!(Servos::new(&IDS, &[0], &SCALE, &ZERO), Err(LoadError::Shape { tensor: "servo/units", .. })));
    }
}
