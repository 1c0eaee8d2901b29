//! The static memory of an instance.

use core::cell::UnsafeCell;
use core::fmt;
use core::mem::MaybeUninit;

use kinesic::Pose;
use kinesic::face::{Landmarks, POINTS};
use kinesic::model::ATTRIBUTES;
use kinesic::nalgebra::{Quaternion, UnitQuaternion, Vector3};

use crate::JOINTS;
use crate::emotion::{Player, Strengths};
use crate::engine::{Engine, HostPose};
use crate::face::HostFace;

/// Floats of a pose.
const LEN: usize = 3 + 4 * JOINTS;

/// A pose as the page sees it.
pub type PoseFloats = [f32; LEN];

/// Everything that an instance has.
pub struct Memory {
    pub engine: Slot<Engine>,
    pub emotion: Slot<Player>,
    pub face: Slot<HostFace>,
    pub strengths: Strengths,
    pub playing: Strengths,
    pub landmarks: Landmarks,
    pub changed: Landmarks,
    pub reading: [f32; 4],
    pub input: PoseFloats,
    pub other: PoseFloats,
    pub output: PoseFloats,
    pub mask: [f32; JOINTS],
    pub positions: [[f32; 3]; JOINTS],
    pub message: Message,
}

struct Cell(UnsafeCell<Memory>);

// SAFETY: an instance has one thread.
unsafe impl Sync for Cell {}

// All zero, so that it costs nothing in the file.
static MEMORY: Cell = Cell(UnsafeCell::new(Memory {
    engine: Slot::empty(),
    emotion: Slot::empty(),
    face: Slot::empty(),
    strengths: [0.0; ATTRIBUTES],
    playing: [0.0; ATTRIBUTES],
    landmarks: [[0.0; 2]; POINTS],
    changed: [[0.0; 2]; POINTS],
    reading: [0.0; 4],
    input: [0.0; LEN],
    other: [0.0; LEN],
    output: [0.0; LEN],
    // A load sets it.
    mask: [0.0; JOINTS],
    positions: [[0.0; 3]; JOINTS],
    message: Message { text: [0; 256], len: 0 },
}));

/// The memory. Every exported function takes it once and gives it back when it returns.
pub fn memory() -> &'static mut Memory {
    // SAFETY: one thread, and no exported function calls another.
    unsafe { &mut *MEMORY.0.get() }
}

/// What a pack holds, once it is loaded. (An `Option` would mark its absence by a value that is not zero.)
pub struct Slot<T> {
    loaded: bool,
    value: MaybeUninit<T>,
}

impl<T> Slot<T> {
    const fn empty() -> Self {
        Self { loaded: false, value: MaybeUninit::uninit() }
    }

    /// Puts a value there.
    pub fn put(&mut self, value: T) {
        self.value = MaybeUninit::new(value);
        self.loaded = true;
    }

    /// The value, after a load.
    pub fn get(&mut self) -> Option<&mut T> {
        // SAFETY: it was written before `loaded` was set.
        self.loaded.then(|| unsafe { self.value.assume_init_mut() })
    }
}

/// Poses as floats.
pub trait Floats {
    /// As core sees them.
    fn pose(&self) -> HostPose;
}

impl Floats for PoseFloats {
    fn pose(&self) -> HostPose {
        let mut pose = Pose::identity();
        if let Some((root, rotations)) = self.split_first_chunk::<3>() {
            pose.root = Vector3::from(*root);
            for (to, [x, y, z, w]) in pose.rotations.iter_mut().zip(rotations.as_chunks::<4>().0) {
                *to = UnitQuaternion::new_unchecked(Quaternion::new(*w, *x, *y, *z));
            }
        }
        pose
    }
}

/// A pose that goes to the page.
pub trait Write {
    /// As floats.
    fn write(&self, to: &mut PoseFloats);
}

impl Write for HostPose {
    fn write(&self, to: &mut PoseFloats) {
        if let Some((root, rotations)) = to.split_first_chunk_mut::<3>() {
            *root = self.root.into();
            for (to, from) in rotations.as_chunks_mut::<4>().0.iter_mut().zip(&self.rotations) {
                *to = from.coords.into();
            }
        }
    }
}

/// A text without a heap.
pub struct Message {
    text: [u8; 256],
    len: usize,
}

impl Message {
    /// Nothing in it.
    pub fn clear(&mut self) {
        self.len = 0;
    }

    /// What is in it.
    pub fn text(&self) -> &[u8] {
        self.text.get(..self.len).unwrap_or(&[])
    }
}

impl fmt::Write for Message {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for (to, from) in self.text.iter_mut().skip(self.len).zip(text.as_bytes()) {
            *to = *from;
            self.len += 1;
        }
        Ok(())
    }
}
