//! Which frames are quarantined.

use crate::pose::Pose;

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
    /// The root is more than a thousand kilometres away.
    Far,
    /// The same bits for longer than the table's `frozen`.
    Frozen,
}

/// Tells sound frames from others. A stage of its own before engines that remember: a NaN must not get into their filters.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Guard {
    /// Of the last frame's bits.
    hash: u32,
    /// Frames with these bits, after the first.
    repeats: u32,
}

impl Guard {
    /// The next frame if it is sound, else what is wrong with it. `frozen` is the number of equal frames that make a fault, 0 for never; the
    /// first `joints` rotations count. Cost: 8 operations a number.
    pub fn check<'f, const JOINTS: usize>(
        &mut self,
        frame: Option<&'f Pose<JOINTS>>,
        joints: usize,
        frozen: u32,
    ) -> Result<&'f Pose<JOINTS>, Fault> {
        let pose = frame.ok_or(Fault::Missing)?;
        let rotations = pose.rotations.iter().take(joints);
        let numbers = || pose.root.iter().chain(rotations.clone().flat_map(|q| q.coords.iter()));
        if !numbers().all(|x| x.is_finite()) {
            return Err(Fault::NotFinite);
        }
        if !pose.is_sound(joints) {
            return Err(if pose.root.iter().all(|x| (-1e6..1e6).contains(x)) { Fault::NotUnit } else { Fault::Far });
        }
        // FNV-1a by words: equal bits have equal hashes, so nothing frozen is missed.
        let hash = numbers().fold(0x811c_9dc5, |hash: u32, x| (hash ^ x.to_bits()).wrapping_mul(0x0100_0193));
        self.repeats = if hash == self.hash { self.repeats.saturating_add(1) } else { 0 };
        self.hash = hash;
        if frozen > 0 && self.repeats >= frozen { Err(Fault::Frozen) } else { Ok(pose) }
    }
}
