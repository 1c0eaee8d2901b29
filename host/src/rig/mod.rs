//! The rig: a clip's skeleton in the form in which a pack holds it and the device walks it.

use kinesic::model::LoadError;
use kinesic::pose::{Heading, World, forward, local_positions};
use kinesic::rig::{Drift, JointKind};
use kinesic::{Frame, Pack, Pose, Rig as DeviceRig, Skeleton as DeviceSkeleton};
use nalgebra::{UnitQuaternion, Vector3};

use coordinates::Coordinates;
pub use coordinates::JointCoordinates;
pub use sides::{Mirror, Sides};

mod coordinates;
mod sides;

use crate::clip::map::CANONICAL;
use crate::clip::{Canonical, Clip, Joint, JointMap, Skeleton};
use crate::pack::PackWriter;

/// Capacity of the poses that the host steps; a rig has at most this many joints.
pub const MAX_JOINTS: usize = 128;

/// Capacity of the frames that the host steps: a row per joint, and the root's.
pub const MAX_ROWS: usize = MAX_JOINTS + 1;

/// A frame at the host's capacity.
pub type HostFrame = Frame<MAX_ROWS>;

/// Stands for a canonical joint that the skeleton does not have.
const UNKNOWN: u16 = u16::MAX;

/// Why a skeleton cannot be a rig.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RigError {
    /// More joints than the host steps.
    #[error("the skeleton has {found} joints, at most {MAX_JOINTS} are supported: remove finger or face joints")]
    TooManyJoints {
        /// Joints in the skeleton.
        found: usize,
    },
    /// The heading needs both hips.
    #[error(
        "the skeleton has no known {missing}: give a skeleton map (--map FILE) that names it; the joints are: {joints}"
    )]
    NoHips {
        /// What is missing.
        missing: &'static str,
        /// The joints' names.
        joints: String,
    },
    /// The device refuses the tables, or a pack lacks them.
    #[error("the skeleton's tables cannot be used: {0}")]
    Refused(#[from] LoadError),
}

/// A skeleton as device tables, with the names and the joint map that the host needs beside them.
#[derive(Clone, Debug)]
pub struct Rig {
    /// Joints, offsets in metres, in the clip's order.
    pub skeleton: Skeleton,
    /// Which joint is which.
    pub map: JointMap,
    parents: Vec<u16>,
    offsets: Vec<[f32; 3]>,
    across: Vec<[u16; 2]>,
    coordinates: Coordinates,
}

impl Rig {
    /// The rig of a body that travels. `map` says which of its joints are the hips.
    pub fn new(skeleton: &Skeleton, map: &JointMap) -> Result<Self, RigError> {
        let hip = |canonical, missing| {
            map.joint(canonical).map(|j| j as u16).ok_or_else(|| RigError::NoHips {
                missing,
                joints: skeleton.joints.iter().map(|j| j.name.as_str()).collect::<Vec<_>>().join(", "),
            })
        };
        let across = vec![[hip(Canonical::LHip, "left hip")?, hip(Canonical::RHip, "right hip")?]];
        let balls = vec![JointCoordinates::new(JointKind::Ball); skeleton.joints.len()];
        Self::build(skeleton, map, across, Coordinates::new(&balls, hips_axis(skeleton, map)))
    }

    /// The rig of a machine that stands: one entry of `joints` per joint of the skeleton.
    pub fn machine(skeleton: &Skeleton, joints: &[JointCoordinates]) -> Result<Self, RigError> {
        let map = JointMap::from_indices("machine", [None; CANONICAL], skeleton);
        Self::build(skeleton, &map, Vec::new(), Coordinates::new(joints, None))
    }

    fn build(
        skeleton: &Skeleton,
        map: &JointMap,
        across: Vec<[u16; 2]>,
        coordinates: Coordinates,
    ) -> Result<Self, RigError> {
        let joints = skeleton.joints.len();
        if joints > MAX_JOINTS {
            return Err(RigError::TooManyJoints { found: joints });
        }
        let rig = Self {
            parents: skeleton.joints.iter().map(|j| j.parent.unwrap_or(0) as u16).collect(),
            offsets: skeleton.joints.iter().map(|j| j.offset.map(|x| x as f32).into()).collect(),
            coordinates,
            across,
            skeleton: skeleton.clone(),
            map: map.clone(),
        };
        rig.checked()?;
        rig.coordinates.checked()?;
        Ok(rig)
    }

    /// The same skeleton with other coordinates: one entry per joint.
    pub fn with_coordinates(&self, joints: Vec<JointCoordinates>) -> Result<Self, LoadError> {
        let coordinates = Coordinates::new(&joints, self.coordinates.across);
        coordinates.checked()?;
        Ok(Self { coordinates, ..self.clone() })
    }

    /// The coordinates of every joint.
    pub fn joint_coordinates(&self) -> Vec<JointCoordinates> {
        self.coordinates.joints()
    }

    /// The same skeleton with coordinates about the mean of these clips: a joint that never moves has none, any other is a ball. Left
    /// and right joints have references that are mirror images of each other. A machine keeps the coordinates that it has.
    pub fn centred(&self, clips: &[&[Pose<MAX_JOINTS>]]) -> Self {
        if !self.frames().travels() {
            return self.clone();
        }
        let joints = coordinates::centred(self, clips);
        let coordinates = Coordinates::new(&joints, self.coordinates.across);
        Self { coordinates, ..self.clone() }
    }

    /// The sides of a body by its references; `None` where left and right are not mirror images of each other.
    pub fn sides(&self) -> Option<Sides> {
        let rest: Pose<MAX_JOINTS> = self.frames().rest();
        let straight =
            rest.rotations[..self.joints()].iter().map(|q| UnitQuaternion::new_normalize(q.into_inner().cast()));
        Sides::find(self, &straight.collect::<Vec<_>>())
    }

    /// The device's coordinates.
    pub fn frames(&self) -> DeviceRig<'_> {
        // Checked when the rig was made, and never changed since.
        self.coordinates.checked().unwrap_or_else(|error| unreachable!("checked coordinates are refused: {error}"))
    }

    /// Rows of a frame.
    pub fn rows(&self) -> usize {
        self.frames().rows()
    }

    /// The frames of poses, read as the device reads them.
    pub fn read(&self, poses: &[Pose<MAX_JOINTS>]) -> Vec<HostFrame> {
        let rig = self.frames();
        let mut frame = HostFrame::new();
        let read = |pose: &Pose<MAX_JOINTS>| {
            rig.read(pose, &mut frame);
            frame
        };
        poses.iter().map(read).collect()
    }

    /// The weight of every coordinate from that of its joint; the root's row goes with joint 0.
    pub fn coordinate_weights(&self, joints: &[f32; MAX_JOINTS]) -> [[f32; 3]; MAX_ROWS] {
        let mut weights = [[1.0; 3]; MAX_ROWS];
        let flat = weights.as_flattened_mut();
        let rig = self.frames();
        if rig.travels() {
            flat[..3].fill(joints[0]);
        }
        for ((kind, first), weight) in rig.places().zip(joints) {
            flat[first..first + kind.coordinates()].fill(*weight);
        }
        weights
    }

    /// What `turn` makes of every pose's frame, written as the device writes it.
    pub fn restyle(&self, poses: &[Pose<MAX_JOINTS>], mut turn: impl FnMut(&mut HostFrame)) -> Vec<Pose<MAX_JOINTS>> {
        let rig = self.frames();
        let (mut source, mut drift) = (HostFrame::new(), Drift::new());
        let styled = poses.iter().map(|pose| {
            rig.read(pose, &mut source);
            let mut styled = source;
            turn(&mut styled);
            let mut out = Pose::identity();
            rig.write(&source, &styled, &mut drift, pose, &mut out);
            out
        });
        styled.collect()
    }

    /// The frames of a clip on this rig, as the device would see them.
    pub fn frames_of(&self, clip: &Clip) -> Vec<HostFrame> {
        let Some(coordinates) = &clip.coordinates else { return self.read(&self.poses(clip)) };
        coordinates.chunks_exact(3 * self.rows().max(1)).map(frame_of).collect()
    }

    /// What `play` makes of a clip on this rig, frame by frame, in and out as on the device: through poses for a body that travels, from
    /// coordinates to coordinates for a machine.
    pub fn play(&self, clip: &Clip, mut play: impl FnMut(&mut HostFrame)) -> Clip {
        if clip.coordinates.is_none() {
            return self.clip(&self.restyle(&self.poses(clip), play), clip.frame_time);
        }
        let mut frames = self.frames_of(clip);
        frames.iter_mut().for_each(&mut play);
        self.clip_of(&frames, clip.frame_time)
    }

    /// A machine's motion: its coordinates, and poses that show them.
    pub fn clip_of(&self, frames: &[HostFrame], frame_time: f64) -> Clip {
        let (rig, mut drift) = (self.frames(), Drift::new());
        let show = |frame: &HostFrame| {
            let mut pose = self.zero_pose();
            rig.show(frame, frame, &mut drift, &mut pose);
            pose
        };
        let clip = self.clip(&frames.iter().map(show).collect::<Vec<_>>(), frame_time);
        let row = |frame: &HostFrame| frame.coordinates()[..3 * self.rows()].to_vec();
        let coordinates = (!rig.travels()).then(|| frames.iter().flat_map(row).map(f64::from).collect());
        Clip { coordinates, ..clip }
    }

    /// The pose whose coordinates are 0: every joint at its reference.
    pub fn zero_pose(&self) -> Pose<MAX_JOINTS> {
        let mut pose = Pose::identity();
        for (to, joint) in pose.rotations.iter_mut().zip(self.joint_coordinates()) {
            *to = UnitQuaternion::new_normalize(nalgebra::Vector4::from(joint.reference).into());
        }
        pose
    }

    /// What distances are measured in, m, `[frames x 3 joints]`, of coordinates `[frames x 3 rows]`. Of a body: heading-local positions,
    /// the root's `[0, height, 0]`. Of a machine: every joint's own coordinates times their levers, 0 past the ones that it has.
    pub fn positions(&self, coordinates: &[f64]) -> Vec<f64> {
        let (rig, skeleton) = (self.frames(), self.device());
        if !rig.travels() {
            return self.levered(coordinates);
        }
        let mut world = World::<MAX_JOINTS>::identity();
        let mut positions = Vec::with_capacity(coordinates.len());
        let zero = self.zero_pose();
        for row in coordinates.chunks_exact(3 * rig.rows()) {
            let frame = frame_of(row);
            let mut pose = zero;
            rig.show(&frame, &frame, &mut Drift::new(), &mut pose);
            forward(&skeleton, &pose, &mut world);
            let heading = Heading::default().follow(&skeleton, &world);
            let local = local_positions(&skeleton, &world, heading);
            positions.extend(local[..self.joints()].as_flattened().iter().map(|x| f64::from(*x)));
        }
        positions
    }

    /// Coordinates `[frames x 3 rows]`, each times its lever.
    pub fn scaled(&self, coordinates: &[f64]) -> Vec<f64> {
        let levers = self.levers();
        let rows = coordinates.chunks_exact(levers.len());
        rows.flat_map(|row| row.iter().zip(&levers).map(|(x, lever)| x * lever)).collect()
    }

    /// See [`positions`](Self::positions) of a machine.
    fn levered(&self, coordinates: &[f64]) -> Vec<f64> {
        let (levers, places) = (self.levers(), self.frames().places().collect::<Vec<_>>());
        let joint = |row: &[f64], (kind, first): (JointKind, usize)| -> [f64; 3] {
            std::array::from_fn(|axis| {
                let at = first + axis;
                if axis < kind.coordinates() { row[at] * levers[at] } else { 0.0 }
            })
        };
        let rows = coordinates.chunks_exact(levers.len().max(1));
        rows.flat_map(|row| places.iter().flat_map(move |place| joint(row, *place))).collect()
    }

    /// A motion of a machine, from its coordinates `[frames x 3 rows]`.
    pub fn standing(&self, coordinates: Vec<f64>) -> Locals {
        Locals { channels: 3 * self.joints(), positions: self.levered(&coordinates), rows: self.rows(), coordinates }
    }

    /// A clip as the models see it.
    pub fn locals_of(&self, clip: &Clip) -> Locals {
        match &clip.coordinates {
            Some(coordinates) => self.standing(coordinates.clone()),
            None => self.locals(&self.poses(clip)),
        }
    }

    /// How far a unit of each coordinate moves what hangs on it, m per rad or m: the root of the summed squares over the joints and
    /// end sites below, at coordinates 0. Where little hangs on a joint it is a hand's length, so that heads and hands count.
    pub fn levers(&self) -> Vec<f64> {
        coordinates::levers(self)
    }

    /// The device's view, checked.
    fn checked(&self) -> Result<DeviceSkeleton<'_>, LoadError> {
        DeviceSkeleton::new(&self.parents, &self.offsets, &self.across)
    }

    /// The device's view.
    pub fn device(&self) -> DeviceSkeleton<'_> {
        // Checked when the rig was made, and never changed since.
        self.checked().unwrap_or_else(|error| unreachable!("a checked rig is refused: {error}"))
    }

    /// Number of joints.
    pub fn joints(&self) -> usize {
        self.parents.len()
    }

    /// Writes the tables of skeleton and coordinates.
    pub fn write(&self, pack: &mut PackWriter) {
        self.coordinates.write(pack);
        for joint in &self.skeleton.joints {
            pack.joint(&joint.name, joint.parent.map(|p| p as u16));
        }
        pack.u16s("skeleton/parents", 1, &self.parents);
        pack.f32s("skeleton/offsets", 3, self.offsets.as_flattened());
        pack.u16s("skeleton/across", 2, self.across.as_flattened());
        let ends: Vec<f32> = self
            .skeleton
            .joints
            .iter()
            .flat_map(|j| j.end.map_or([0.0; 3], |end| end.map(|x| x as f32).into()))
            .collect();
        pack.f32s("skeleton/ends", 3, &ends);
        let canonical = Canonical::ALL.map(|c| self.map.joint(c).map_or(UNKNOWN, |j| j as u16));
        pack.u16s("skeleton/canonical", 1, &canonical);
    }

    /// The rig that a pack was trained on.
    pub fn from_pack(pack: &Pack) -> Result<Self, RigError> {
        let metas: Vec<_> = pack.metadata().joints.iter().collect();
        let offsets: &[[f32; 3]] = pack.slice("skeleton/offsets", metas.len())?;
        let ends: &[[f32; 3]] = pack.slice("skeleton/ends", metas.len())?;
        let joints = metas.iter().zip(offsets).zip(ends).map(|((meta, offset), end)| Joint {
            name: meta.name.to_owned(),
            parent: meta.parent.map(usize::from),
            offset: Vector3::from(*offset).cast(),
            end: (*end != [0.0; 3]).then(|| Vector3::from(*end).cast()),
        });
        let skeleton = Skeleton { joints: joints.collect() };
        let known: &[[u16; CANONICAL]] = pack.slice("skeleton/canonical", 1)?;
        let indices = known[0].map(|joint| (joint != UNKNOWN).then_some(usize::from(joint)));
        let map = JointMap::from_indices("pack", indices, &skeleton);
        let across: &[[u16; 2]] = pack.slice("skeleton/across", pack.rows("skeleton/across")?)?;
        Self::build(&skeleton, &map, across.to_vec(), Coordinates::of_pack(pack)?)
    }

    /// The poses of a clip on this rig (same joints in the same order; see [`retarget`](crate::retarget)).
    pub fn poses(&self, clip: &Clip) -> Vec<Pose<MAX_JOINTS>> {
        clip.rotations
            .chunks_exact(self.joints())
            .zip(&clip.root)
            .map(|(rotations, root)| {
                let mut pose = Pose::identity();
                pose.root = root.map(|x| x as f32);
                for (to, from) in pose.rotations.iter_mut().zip(rotations) {
                    *to = from.cast();
                }
                pose
            })
            .collect()
    }

    /// A clip of poses on this rig.
    pub fn clip(&self, poses: &[Pose<MAX_JOINTS>], frame_time: f64) -> Clip {
        let joints = self.joints();
        Clip {
            skeleton: self.skeleton.clone(),
            frame_time,
            root: poses.iter().map(|pose| pose.root.map(f64::from)).collect(),
            // As they are: a double holds every single, and `poses` gives the same bits back.
            rotations: poses
                .iter()
                .flat_map(|pose| pose.rotations.iter().take(joints))
                .map(|q| UnitQuaternion::new_unchecked(q.into_inner().cast()))
                .collect(),
            coordinates: None,
            notes: Vec::new(),
        }
    }

    /// Positions and coordinates as the device computes them.
    pub fn locals(&self, poses: &[Pose<MAX_JOINTS>]) -> Locals {
        if !self.frames().travels() {
            let row = |frame: &HostFrame| frame.coordinates()[..3 * self.rows()].to_vec();
            return self.standing(self.read(poses).iter().flat_map(row).map(f64::from).collect());
        }
        let skeleton = self.device();
        let mut heading = Heading::default();
        let mut world = World::<MAX_JOINTS>::identity();
        let rows = self.rows();
        let mut locals = Locals { channels: 3 * self.joints(), positions: Vec::new(), rows, coordinates: Vec::new() };
        for (pose, frame) in poses.iter().zip(self.read(poses)) {
            forward(&skeleton, pose, &mut world);
            heading = heading.follow(&skeleton, &world);
            let positions = local_positions(&skeleton, &world, heading);
            locals.positions.extend(positions[..self.joints()].as_flattened().iter().map(|x| f64::from(*x)));
            locals.coordinates.extend(frame.coordinates()[..3 * rows].iter().map(|x| f64::from(*x)));
        }
        locals
    }
}

/// A frame with these coordinates.
pub(crate) fn frame_of(coordinates: &[f64]) -> HostFrame {
    let mut frame = HostFrame::new();
    frame.coordinates_mut().iter_mut().zip(coordinates).for_each(|(to, from)| *to = *from as f32);
    frame
}

/// A clip as the models see it.
#[derive(Clone, Debug, PartialEq)]
pub struct Locals {
    /// Numbers of one frame of `positions`.
    pub channels: usize,
    /// What distances are measured in, m, `[frames x channels]`: see [`Rig::positions`].
    pub positions: Vec<f64>,
    /// Rows of a frame.
    pub rows: usize,
    /// Coordinates, rad or m, `[frames x 3 rows]`; see [`kinesic::rig`].
    pub coordinates: Vec<f64>,
}

impl Locals {
    /// Number of frames.
    pub fn frames(&self) -> usize {
        self.positions.len() / self.channels.max(1)
    }

    /// Numbers of one frame of `positions`.
    pub fn channels(&self) -> usize {
        self.channels
    }
}

/// Direction from the right hip to the left one at rest, in the root's frame.
fn hips_axis(skeleton: &Skeleton, map: &JointMap) -> Option<[f32; 3]> {
    let rest = skeleton.rest_positions();
    let [left, right] = [map.joint(Canonical::LHip)?, map.joint(Canonical::RHip)?].map(|joint| rest[joint]);
    let axis = (left - right).try_normalize(1e-6)?;
    Some(axis.map(|x| x as f32).into())
}
