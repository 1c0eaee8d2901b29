//! Which frames are kept out.

use crate::pose::{Pose, is_number};

/// What is wrong with a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Fault {
    /// There is none.
    Missing,
    /// A number is NaN or infinite.
    NotFinite,
    /// A quaternion's length is not 1 within 5 %: zero, garbled, or not a quaternion.
    NotUnit,
    /// The root is more than a thousand kilometres away, or a coordinate is beyond a million.
    Far,
    /// The same bits for longer than [`Guard::frozen`].
    Frozen,
}

/// Tells sound frames from others, before anything that remembers sees them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Guard {
    /// Equal frames, after the first, that make a fault; 0 for never. Holding still is no fault unless a source cannot do so.
    pub frozen: u32,
    /// Of the last frame's bits.
    hash: u32,
    /// Frames with these bits, after the first.
    repeats: u32,
}

impl Guard {
    /// Never [`Fault::Frozen`].
    pub const fn new() -> Self {
        Self { frozen: 0, hash: 0, repeats: 0 }
    }

    /// The pose if it is sound, else what is wrong with it; the first `joints` rotations count. Cost: 8 operations per number.
    pub fn check<'f, const JOINTS: usize>(
        &mut self,
        pose: Option<&'f Pose<JOINTS>>,
        joints: usize,
    ) -> Result<&'f Pose<JOINTS>, Fault> {
        let pose = pose.ok_or(Fault::Missing)?;
        let rotations = pose.rotations.iter().take(joints);
        let numbers = || pose.root.iter().chain(rotations.clone().flat_map(|q| q.coords.iter())).copied();
        if !numbers().all(f32::is_finite) {
            return Err(Fault::NotFinite);
        }
        if !pose.is_sound(joints) {
            return Err(if pose.root.iter().all(|x| x.abs() < 1e6) { Fault::NotUnit } else { Fault::Far });
        }
        self.repeated(numbers())?;
        Ok(pose)
    }

    /// The same for coordinates.
    pub fn check_coordinates<'f>(&mut self, coordinates: Option<&'f [f32]>) -> Result<&'f [f32], Fault> {
        let coordinates = coordinates.ok_or(Fault::Missing)?;
        if !coordinates.iter().all(|x| x.is_finite()) {
            return Err(Fault::NotFinite);
        }
        if !coordinates.iter().all(|x| is_number(*x)) {
            return Err(Fault::Far);
        }
        self.repeated(coordinates.iter().copied())?;
        Ok(coordinates)
    }

    fn repeated(&mut self, numbers: impl Iterator<Item = f32>) -> Result<(), Fault> {
        if self.frozen == 0 {
            return Ok(());
        }
        // FNV-1a by words: equal bits have equal hashes, so nothing frozen is missed.
        let hash = numbers.fold(0x811c_9dc5, |hash: u32, x| (hash ^ x.to_bits()).wrapping_mul(0x0100_0193));
        self.repeats = if hash == self.hash { self.repeats.saturating_add(1) } else { 0 };
        self.hash = hash;
        if self.repeats >= self.frozen { Err(Fault::Frozen) } else { Ok(()) }
    }
}
