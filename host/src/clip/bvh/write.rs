//! Writing BVH: the plain dialect that Blender, MotionBuilder and the usual scripts read.
//!
//! The root has six channels (`Xposition Yposition Zposition Zrotation Xrotation Yrotation`), all others three, every leaf
//! an End Site, OFFSETs carry the bones, six decimals. Centimetres by default: BVH does not state its unit, and [`read`]
//! finds the centimetre again from the size of the leg ([`Unit::detect`]) for every human from toddler to giant. A skeleton
//! of another size, or written in another unit, is read back with the unit given.
//!
//! [`read`]: crate::clip::read

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use super::euler;
use crate::clip::{Clip, Unit};
use crate::files::write_whole;

/// How to write.
#[derive(Clone, Copy, Debug)]
pub struct WriteOptions {
    /// Unit of length of the file.
    pub units: Unit,
}

impl Default for WriteOptions {
    fn default() -> Self {
        WriteOptions { units: Unit::Centimetre }
    }
}

/// Why a clip could not be written. Nothing is left behind at the path; an older file there is untouched.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum WriteError {
    /// The system refused.
    #[error("{}: cannot be written: {error}. Check that the folder exists and may be written to", path.display())]
    Io {
        /// The file that was to be written.
        path: PathBuf,
        /// What the system said.
        error: String,
    },
    /// A name that says no format.
    #[error("{}: motions are written as .bvh, .glb, .gltf, .csv (angles) or .positions.csv. Name it {}", path.display(), path.with_extension("bvh").display())]
    Format {
        /// The file that was to be written.
        path: PathBuf,
    },
    /// No joints or no frames.
    #[error("the clip has {joints} joints and {frames} frames, expected at least one of each")]
    Empty {
        /// Joints of the clip.
        joints: usize,
        /// Frames of the clip.
        frames: usize,
    },
    /// The tables do not fit together.
    #[error("the clip has {found} rotations, expected {expected} (frames x joints)")]
    Shape {
        /// Number of rotations.
        found: usize,
        /// Frames times joints.
        expected: usize,
    },
    /// A parent that does not come before its child.
    #[error("joint '{joint}' has no parent before it, expected one root and parents before children")]
    Tree {
        /// The joint.
        joint: String,
    },
    /// BVH cannot hold the name.
    #[error(
        "joint name '{name}' cannot be written: BVH names are not empty, hold no braces or line breaks, and occur once. \
             Rename the joint"
    )]
    Name {
        /// The name.
        name: String,
    },
    /// A number that is not finite.
    #[error("frame {frame}: joint '{joint}' is not finite, expected finite numbers only. Look at what made the clip")]
    NotFinite {
        /// Frame, counted from 1 as in the file's lines.
        frame: usize,
        /// The joint.
        joint: String,
    },
    /// No usable frame time.
    #[error("the frame time is {found} s, expected a number above 0")]
    FrameTime {
        /// The frame time.
        found: f64,
    },
}

impl Clip {
    /// Writes BVH in centimetres: whole or not at all. See [`WriteOptions`].
    pub fn write_bvh(&self, path: impl AsRef<Path>) -> Result<(), WriteError> {
        self.write_bvh_with(path, &WriteOptions::default())
    }

    /// Writes BVH: whole or not at all.
    ///
    /// A temporary file in the same folder is renamed over `path` at the end.
    pub fn write_bvh_with(&self, path: impl AsRef<Path>, options: &WriteOptions) -> Result<(), WriteError> {
        let path = path.as_ref();
        let text = self.to_bvh(options)?;
        write_whole(path, text.as_bytes()).map_err(|e| WriteError::Io { path: path.into(), error: e.to_string() })
    }

    /// The text of a BVH file.
    pub fn to_bvh(&self, options: &WriteOptions) -> Result<String, WriteError> {
        check(self)?;
        let order = depth_first(self);
        let scale = 1.0 / options.units.metres();
        let mut out = String::from("HIERARCHY\n");
        hierarchy(self, &order, scale, &mut out);
        out.push_str(&format!("MOTION\nFrames: {}\nFrame Time: {}\n", self.frames(), self.frame_time));
        let mut angles = vec![[0.0; 3]; self.skeleton.len()];
        for (frame, root) in self.root.iter().enumerate() {
            let pose = self.pose(frame);
            for v in root.iter() {
                number(&mut out, v * scale, ' ');
            }
            for (at, &(joint, _)) in order.iter().enumerate() {
                if let (Some(near), Some(rotation)) = (angles.get_mut(joint), pose.get(joint)) {
                    *near = euler::zxy(rotation, *near);
                    let last = if at + 1 == order.len() { '\n' } else { ' ' };
                    number(&mut out, near[0].to_degrees(), ' ');
                    number(&mut out, near[1].to_degrees(), ' ');
                    number(&mut out, near[2].to_degrees(), last);
                }
            }
        }
        Ok(out)
    }
}

/// What every writer asks of a clip.
pub(in crate::clip) fn check(clip: &Clip) -> Result<(), WriteError> {
    let (joints, frames) = (&clip.skeleton.joints, clip.frames());
    if joints.is_empty() || frames == 0 {
        return Err(WriteError::Empty { joints: joints.len(), frames });
    }
    let (found, expected) = (clip.rotations.len(), frames * joints.len());
    if found != expected {
        return Err(WriteError::Shape { found, expected });
    }
    if !(clip.frame_time.is_finite() && clip.frame_time > 0.0) {
        return Err(WriteError::FrameTime { found: clip.frame_time });
    }
    let mut names = HashSet::new();
    for (index, joint) in joints.iter().enumerate() {
        let name = joint.name.trim();
        if name.is_empty() || name.contains(['{', '}', '\n', '\r']) || !names.insert(name) {
            return Err(WriteError::Name { name: joint.name.clone() });
        }
        if joint.parent.map_or(index != 0, |p| p >= index) {
            return Err(WriteError::Tree { joint: joint.name.clone() });
        }
        let finite = joint.offset.iter().chain(joint.end.iter().flatten()).all(|v| v.is_finite());
        if !finite {
            return Err(WriteError::NotFinite { frame: 0, joint: joint.name.clone() });
        }
    }
    let bad =
        |frame: usize, joint: usize| WriteError::NotFinite { frame: frame + 1, joint: joints[joint].name.clone() };
    if let Some(frame) = clip.root.iter().position(|p| !p.iter().all(|v| v.is_finite())) {
        return Err(bad(frame, 0));
    }
    if let Some(at) = clip.rotations.iter().position(|r| !r.coords.iter().all(|v| v.is_finite())) {
        return Err(bad(at / joints.len(), at % joints.len()));
    }
    Ok(())
}

/// Joints in the order of the file, with their depth. A stack, not recursion: the depth is the caller's choice.
fn depth_first(clip: &Clip) -> Vec<(usize, usize)> {
    let mut children = vec![Vec::new(); clip.skeleton.len()];
    for (index, joint) in clip.skeleton.joints.iter().enumerate() {
        if let Some(list) = joint.parent.and_then(|p| children.get_mut(p)) {
            list.push(index);
        }
    }
    let (mut order, mut stack) = (Vec::new(), vec![(0, 0)]);
    while let Some((joint, depth)) = stack.pop() {
        order.push((joint, depth));
        stack.extend(children[joint].iter().rev().map(|&c| (c, depth + 1)));
    }
    order
}

fn hierarchy(clip: &Clip, order: &[(usize, usize)], scale: f64, out: &mut String) {
    let offset = |out: &mut String, tabs: &str, v: &nalgebra::Vector3<f64>| {
        out.push_str(tabs);
        out.push_str("OFFSET ");
        number(out, v.x * scale, ' ');
        number(out, v.y * scale, ' ');
        number(out, v.z * scale, '\n');
    };
    for (at, &(index, depth)) in order.iter().enumerate() {
        let joint = &clip.skeleton.joints[index];
        let (outer, inner) = ("\t".repeat(depth), "\t".repeat(depth + 1));
        let keyword = if depth == 0 { "ROOT" } else { "JOINT" };
        out.push_str(&format!("{outer}{keyword} {}\n{outer}{{\n", joint.name.trim()));
        offset(out, &inner, &joint.offset);
        let channels = if depth == 0 { "6 Xposition Yposition Zposition" } else { "3" };
        out.push_str(&format!("{inner}CHANNELS {channels} Zrotation Xrotation Yrotation\n"));
        let next = order.get(at + 1).map_or(0, |&(_, d)| d);
        let leaf = next <= depth;
        if leaf || joint.end.is_some() {
            out.push_str(&format!("{inner}End Site\n{inner}{{\n"));
            offset(out, &format!("{inner}\t"), &joint.end.unwrap_or_default());
            out.push_str(&format!("{inner}}}\n"));
        }
        // Close every joint that ends here.
        if leaf {
            let floor = if at + 1 == order.len() { 0 } else { next };
            for open in (floor..=depth).rev() {
                out.push_str(&format!("{}}}\n", "\t".repeat(open)));
            }
        }
    }
}

/// Six decimals: half a millionth of a degree, or of a centimetre. No negative zero.
fn number(out: &mut String, value: f64, then: char) {
    use std::fmt::Write;
    let rounded = (value * 1e6).round() / 1e6 + 0.0;
    // Writing to a String cannot fail.
    let _ = write!(out, "{rounded:.6}{then}");
}
