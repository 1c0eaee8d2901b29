//! Motion clips: a skeleton and one pose per frame, whatever file they came from.
//!
//! Everything is in metres, radians and seconds, right-handed, Y up; a person who faces +Z has the left hand at +X.
//!
//! | file | holds |
//! |---|---|
//! | [`read`], [`read_with`] | any accepted file to a [`Clip`], chosen by content |
//! | [`formats`] | the table of readers |
//! | [`bvh`] | the BVH parser and [`Clip::write_bvh`] |
//! | [`write`](Clip::write) | a clip to a file of the format that its name says: BVH, glTF ([`gltf`]), tables of angles ([`angles`]) and of positions (`positions`) |
//! | [`fbx`] | FBX: bones and their animation |
//! | [`kinect`] | Kinect CSV recordings: positions, resampled and fitted with a skeleton |
//! | [`map`] | which joint is the pelvis, the left knee, ...: known layouts, map files, mirror partners |
//! | [`units`] | what a file's numbers mean: unit of length, up axis |
//! | `kinematics`, `resample`, `mirror`, `summary` | methods of [`Clip`] |
//! | [`solve`] | joint positions to joint rotations |

use nalgebra::{UnitQuaternion, Vector3};

pub mod angles;
pub mod bvh;
mod error;
pub mod fbx;
pub mod formats;
pub mod gltf;
pub mod kinect;
mod kinematics;
pub mod map;
mod measure;
mod mirror;
mod notes;
pub(crate) mod positions;
mod read;
mod resample;
mod settle;
pub mod solve;
mod summary;
pub mod units;
mod write;

pub use bvh::write::{WriteError, WriteOptions};
pub use error::ReadError;
pub use map::{Canonical, JointMap, SkeletonMap};
pub use mirror::MirrorError;
pub(crate) use mirror::{reflect, reflect_rotation};
pub use notes::NoteLog;
pub use read::{ReadOptions, contents, gathered, read, read_with};
pub use resample::{Memory, ResampleError};
pub use summary::Summary;
pub use units::{Unit, UpAxis};
pub use write::Format;

/// One joint of a [`Skeleton`].
#[derive(Clone, Debug, PartialEq)]
pub struct Joint {
    /// Name as the file spells it.
    pub name: String,
    /// Index of the parent, always smaller than the joint's own; `None` for the root (joint 0) only.
    pub parent: Option<usize>,
    /// Rest position relative to the parent, m. Zero for the root: the clip's root track is its position.
    pub offset: Vector3<f64>,
    /// Tip of a leaf's bone ("End Site"), relative to the joint, m.
    pub end: Option<Vector3<f64>>,
}

/// A tree of joints in depth-first order, parents before children, one root.
#[derive(Clone, Debug, PartialEq)]
pub struct Skeleton {
    /// The joints; index 0 is the root (the hips).
    pub joints: Vec<Joint>,
}

impl Skeleton {
    /// Number of joints.
    pub fn len(&self) -> usize {
        self.joints.len()
    }

    /// Whether there is no joint at all; no reader makes such a skeleton.
    pub fn is_empty(&self) -> bool {
        self.joints.is_empty()
    }

    /// Index of the joint with this name, spelled exactly so.
    pub fn find(&self, name: &str) -> Option<usize> {
        self.joints.iter().position(|j| j.name == name)
    }

    /// Indices of the children of `joint`, in file order.
    pub fn children(&self, joint: usize) -> impl Iterator<Item = usize> + '_ {
        let rest = self.joints.iter().enumerate();
        rest.filter(move |(_, j)| j.parent == Some(joint)).map(|(i, _)| i)
    }
}

/// A skeleton in motion: `frames x joints` local rotations and the root's path.
#[derive(Clone, Debug)]
pub struct Clip {
    /// What is moved.
    pub skeleton: Skeleton,
    /// Seconds between frames.
    pub frame_time: f64,
    /// World position of the root joint, m, one per frame.
    pub root: Vec<Vector3<f64>>,
    /// Rotation of each joint relative to its parent (the root's: to the world), row-major `[frames x joints]`.
    pub rotations: Vec<UnitQuaternion<f64>>,
    /// Of a machine's motion: the coordinates of its rig, rad or m, row-major `[frames x 3 rows]`; `rotations` then only show them.
    pub coordinates: Option<Vec<f64>>,
    /// What the reader changed or assumed on the way in, one sentence each; `kinesic inspect` prints them.
    pub notes: Vec<String>,
}

impl Clip {
    /// Number of frames.
    pub fn frames(&self) -> usize {
        self.root.len()
    }

    /// Frames per second.
    pub fn fps(&self) -> f64 {
        1.0 / self.frame_time
    }

    /// Length in seconds, from the first frame to the last.
    pub fn duration(&self) -> f64 {
        self.frame_time * self.frames().saturating_sub(1) as f64
    }

    /// The frames of a range, with the notes; what the range has beyond the clip is left out.
    pub fn slice(&self, frames: std::ops::Range<usize>) -> Clip {
        let end = frames.end.min(self.frames());
        let start = frames.start.min(end);
        let n = self.skeleton.len();
        Clip {
            skeleton: self.skeleton.clone(),
            frame_time: self.frame_time,
            root: self.root.get(start..end).unwrap_or(&[]).to_vec(),
            rotations: self.rotations.get(start * n..end * n).unwrap_or(&[]).to_vec(),
            coordinates: self.coordinates.as_ref().map(|all| {
                let width = all.len() / self.frames().max(1);
                all.get(start * width..end * width).unwrap_or(&[]).to_vec()
            }),
            notes: self.notes.clone(),
        }
    }

    /// The coordinates of a frame of a machine's motion; `None` for a body's.
    pub fn coordinates(&self, frame: usize) -> Option<&[f64]> {
        let all = self.coordinates.as_ref()?;
        let width = all.len() / self.frames().max(1);
        all.get(frame * width..(frame + 1) * width)
    }

    /// The clip with some of its joints, and with those that carry them. A joint that loses its children keeps the first as its tip.
    pub fn with_joints(&self, keep: &mut [bool]) -> Clip {
        for joint in (1..self.skeleton.len()).rev() {
            if let (true, Some(parent)) = (keep[joint], self.skeleton.joints[joint].parent) {
                keep[parent] = true;
            }
        }
        let mut index = vec![0; keep.len()];
        let mut joints: Vec<Joint> = Vec::new();
        for (at, joint) in self.skeleton.joints.iter().enumerate().filter(|(at, _)| keep[*at]) {
            index[at] = joints.len();
            let mut children = self.skeleton.children(at);
            let leaf = self.skeleton.children(at).all(|c| !keep[c]);
            let tip = children.next().filter(|_| leaf).map(|c| self.skeleton.joints[c].offset);
            joints.push(Joint { parent: joint.parent.map(|p| index[p]), end: joint.end.or(tip), ..joint.clone() });
        }
        let mut columns = keep.iter().cycle();
        let kept = |_: &&UnitQuaternion<f64>| columns.next() == Some(&true);
        Clip {
            skeleton: Skeleton { joints },
            frame_time: self.frame_time,
            root: self.root.clone(),
            rotations: self.rotations.iter().filter(kept).copied().collect(),
            coordinates: None,
            notes: self.notes.clone(),
        }
    }

    /// Local rotations of one frame, one per joint; empty when there is no such frame.
    pub fn pose(&self, frame: usize) -> &[UnitQuaternion<f64>] {
        let n = self.skeleton.len();
        self.rotations.get(frame * n..(frame + 1) * n).unwrap_or(&[])
    }
}
