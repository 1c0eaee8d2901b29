//! Frames for the engines: mostly plausible, some broken, all of them decided by the input's bytes.

use kinesic::nalgebra::{Quaternion, UnitQuaternion, Vector3};
use kinesic::{Frame, Pose};

/// Joints of the frames.
pub const JOINTS: usize = 32;

/// Rows of the frames.
pub const ROWS: usize = JOINTS + 1;

/// Values that arithmetic does not like.
const ODD: [f32; 8] = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, f32::MIN, 1e-40, 0.0, -0.0];

/// A stream of frames.
pub struct Frames {
    state: u64,
}

impl Frames {
    /// Seeded by the bytes (FNV-1a).
    pub fn new(seed: &[u8]) -> Self {
        let fold = |hash: u64, byte: &u8| (hash ^ u64::from(*byte)).wrapping_mul(0x100_0000_01b3);
        Self { state: seed.iter().fold(0xcbf2_9ce4_8422_2325, fold) | 1 }
    }

    /// The next random number (xorshift64).
    pub fn next(&mut self) -> u64 {
        self.state ^= self.state << 13;
        self.state ^= self.state >> 7;
        self.state ^= self.state << 17;
        self.state
    }

    /// -1..1.
    pub fn unit(&mut self) -> f32 {
        (self.next() >> 40) as f32 / (1u64 << 23) as f32 - 1.0
    }

    /// A control: mostly from 0 to 2, sometimes anything at all.
    pub fn control(&mut self) -> f32 {
        match self.next() % 16 {
            0 => ODD[(self.next() % 8) as usize],
            1 => f32::from_bits(self.next() as u32),
            _ => 1.0 + self.unit(),
        }
    }

    /// A frame; one in eight has odd numbers, one in sixteen is noise.
    pub fn pose(&mut self) -> Pose<JOINTS> {
        let mut pose = Pose::identity();
        pose.root = Vector3::new(self.unit(), 1.0 + 0.1 * self.unit(), self.unit());
        for q in &mut pose.rotations {
            let [x, y, z] = [(); 3].map(|()| 0.5 * self.unit());
            *q = UnitQuaternion::new_normalize(Quaternion::new(1.0, x, y, z));
        }
        if self.next().is_multiple_of(8) {
            let (joint, axis) = ((self.next() % JOINTS as u64) as usize, (self.next() % 4) as usize);
            let odd = ODD[(self.next() % 8) as usize];
            let mut q = pose.rotations[joint].into_inner();
            q.coords[axis] = odd;
            pose.rotations[joint] = UnitQuaternion::new_unchecked(q);
            if self.next().is_multiple_of(4) {
                pose.root[axis % 3] = odd;
            }
        }
        if self.next().is_multiple_of(16) {
            for q in &mut pose.rotations {
                let [w, x, y, z] = [(); 4].map(|()| f32::from_bits(self.next() as u32));
                *q = UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z));
            }
        }
        pose
    }

    /// Coordinates without a rig before them; one frame in eight has odd numbers, one in sixteen is noise, one in sixteen leaps.
    pub fn frame(&mut self) -> Frame<ROWS> {
        let mut frame = Frame::new();
        frame.coordinates_mut().iter_mut().for_each(|x| *x = self.unit());
        frame.ground = [self.unit(), self.unit()];
        if self.next().is_multiple_of(8) {
            let at = self.next() as usize % (3 * ROWS);
            frame.coordinates_mut()[at] = self.control();
        }
        match self.next() % 16 {
            0 => frame.coordinates_mut().iter_mut().for_each(|x| *x = f32::from_bits(self.next() as u32)),
            1 => (frame.ground, frame.leap) = ([self.control(); 2], [1e6 * self.unit(), self.control()]),
            _ => {}
        }
        frame
    }
}
