//! Which coordinates the joints of a rig have.

use kinesic::model::LoadError;
use kinesic::rig::JointKind;
use kinesic::{Frame, Pack, Pose, Rig as DeviceRig};
use nalgebra::{UnitQuaternion, Vector3, Vector4};

use super::{MAX_JOINTS, Rig, Sides};
use crate::pack::PackWriter;

const UPRIGHT: [[f32; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// A joint that turns less over all clips never moves, rad.
const STILL: f64 = 1e-3;

/// Lever of a joint on which little hangs, m: a hand's length.
const SHORTEST_LEVER: f64 = 0.15;

/// Which coordinates one joint has: see [`kinesic::rig`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointCoordinates {
    /// Hinge, chain, ball, slider or fixed.
    pub kind: JointKind,
    /// Axes in the frame of `reference`; a ball has none.
    pub axes: [[f32; 3]; 3],
    /// Local rotation `[i, j, k, w]` where the coordinates are 0.
    pub reference: [f32; 4],
    /// Middle of the range of each angle, rad.
    pub middle: [f32; 3],
}

impl JointCoordinates {
    /// A joint of this kind, along the axes of its parent, 0 at rest.
    pub fn new(kind: JointKind) -> Self {
        Self { kind, axes: UPRIGHT, reference: [0.0, 0.0, 0.0, 1.0], middle: [0.0; 3] }
    }
}

/// The tables as the device has them.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Coordinates {
    kinds: Vec<u16>,
    axes: Vec<[[f32; 3]; 3]>,
    reference: Vec<[f32; 4]>,
    middle: Vec<[f32; 3]>,
    pub across: Option<[f32; 3]>,
}

impl Coordinates {
    pub fn new(joints: &[JointCoordinates], across: Option<[f32; 3]>) -> Self {
        Self {
            kinds: joints.iter().map(|joint| joint.kind as u16).collect(),
            axes: joints.iter().map(|joint| joint.axes).collect(),
            reference: joints.iter().map(|joint| joint.reference).collect(),
            middle: joints.iter().map(|joint| joint.middle).collect(),
            across,
        }
    }

    pub fn joints(&self) -> Vec<JointCoordinates> {
        let joint = |index: usize| JointCoordinates {
            kind: JointKind::from_code(self.kinds[index]).unwrap_or(JointKind::Fixed),
            axes: self.axes[index],
            reference: self.reference[index],
            middle: self.middle[index],
        };
        (0..self.kinds.len()).map(joint).collect()
    }

    /// The device's view, checked.
    pub fn checked(&self) -> Result<DeviceRig<'_>, LoadError> {
        DeviceRig::new(&self.kinds, &self.axes, &self.reference, &self.middle, self.across.as_ref())
    }

    /// The tables of a pack.
    pub fn of_pack(pack: &Pack) -> Result<Self, LoadError> {
        let joints = pack.metadata().joints.len();
        Ok(Self {
            kinds: pack.slice::<u16>("rig/kinds", joints)?.to_vec(),
            axes: pack.slice::<[[f32; 3]; 3]>("rig/axes", joints)?.to_vec(),
            reference: pack.slice::<[f32; 4]>("rig/reference", joints)?.to_vec(),
            middle: pack.slice::<[f32; 3]>("rig/middle", joints)?.to_vec(),
            across: pack.slice::<[f32; 3]>("rig/across", pack.rows("rig/across")?)?.first().copied(),
        })
    }

    pub fn write(&self, pack: &mut PackWriter) {
        pack.u16s("rig/kinds", 1, &self.kinds);
        pack.f32s("rig/axes", 9, self.axes.as_flattened().as_flattened());
        pack.f32s("rig/reference", 4, self.reference.as_flattened());
        pack.f32s("rig/middle", 3, self.middle.as_flattened());
        pack.f32s("rig/across", 3, self.across.as_slice().as_flattened());
    }
}

/// See [`Rig::centred`].
pub(super) fn centred(rig: &Rig, clips: &[&[Pose<MAX_JOINTS>]]) -> Vec<JointCoordinates> {
    let device = rig.frames();
    let (mut sums, mut first) = (vec![Vector4::<f64>::zeros(); rig.joints()], None);
    // The poses in which clips begin.
    let mut begins = Vec::new();
    let mut far = vec![0.0f64; rig.joints()];
    for clip in clips {
        let mut frame = Frame::<{ super::MAX_ROWS }>::new();
        for (at, pose) in clip.iter().enumerate() {
            device.read(pose, &mut frame);
            let mut rotations: Vec<UnitQuaternion<f64>> = pose.rotations[..rig.joints()]
                .iter()
                .map(|q| UnitQuaternion::new_normalize(q.into_inner().cast()))
                .collect();
            if device.travels() {
                rotations[0] = frame.heading.rotation().cast().inverse() * rotations[0];
            }
            let first: &Vec<UnitQuaternion<f64>> = first.get_or_insert_with(|| rotations.clone());
            if at == 0 {
                begins.push(rotations.clone());
            }
            for (((sum, far), q), start) in sums.iter_mut().zip(&mut far).zip(&rotations).zip(first) {
                let sign = if q.coords.dot(&start.coords) < 0.0 { -1.0 } else { 1.0 };
                *sum += q.coords * sign;
                *far = far.max(q.angle_to(start));
            }
        }
    }
    let mean: Vec<UnitQuaternion<f64>> =
        sums.iter()
            .map(|sum| {
                if sum.norm() > 1e-9 {
                    UnitQuaternion::new_normalize((*sum).into())
                } else {
                    UnitQuaternion::identity()
                }
            })
            .collect();
    // The mean of one arm's doing does not show which axes are alike; most clips begin with both arms down.
    let sides = std::iter::once(&mean).chain(&begins).find_map(|straight| Sides::find(rig, straight));
    let joint = |index: usize| {
        let partner = rig.map.mirror_partner(index).unwrap_or(index);
        let still = far[index] < STILL && far[partner] < STILL && !(index == 0 && device.travels());
        // What is the middle of a joint and of its partner's mirror image serves both.
        let reference = match &sides {
            Some(sides) if !still => {
                let image = sides.image(index, &mean);
                let sign = if image.coords.dot(&mean[index].coords) < 0.0 { -1.0 } else { 1.0 };
                UnitQuaternion::new_normalize((mean[index].coords + image.coords * sign).into())
            }
            _ => mean[index],
        };
        JointCoordinates {
            reference: reference.coords.map(|x| x as f32).into(),
            ..JointCoordinates::new(if still { JointKind::Fixed } else { JointKind::Ball })
        }
    };
    (0..rig.joints()).map(joint).collect()
}

/// See [`Rig::levers`].
pub(super) fn levers(rig: &Rig) -> Vec<f64> {
    let device = rig.frames();
    let mut pose = rig.zero_pose();
    let frame = Frame::<{ super::MAX_ROWS }>::new();
    device.show(&frame, &frame, &mut kinesic::rig::Drift::new(), &mut pose);
    let rotations: Vec<UnitQuaternion<f64>> =
        pose.rotations[..rig.joints()].iter().map(|q| UnitQuaternion::new_normalize(q.into_inner().cast())).collect();
    let positions = rig.skeleton.pose_positions(&Vector3::zeros(), &rotations);
    let turned = rig.skeleton.world_rotations(&rotations);
    let mut levers = vec![SHORTEST_LEVER; 3 * device.rows()];
    if device.travels() {
        // The root carries every joint.
        levers[..3].fill((rig.joints() as f64).sqrt());
    }
    let mut below = vec![false; rig.joints()];
    for (joint, ((kind, first), axes)) in device.places().zip(&rig.coordinates.axes).enumerate() {
        below.fill(false);
        let mut points = Vec::new();
        for at in joint..rig.joints() {
            let other = &rig.skeleton.joints[at];
            below[at] = at == joint || other.parent.is_some_and(|parent| below[parent]);
            if below[at] {
                points.push(positions[at] - positions[joint]);
                points.extend(other.end.map(|end| positions[at] + turned[at] * end - positions[joint]));
            }
        }
        for axis in 0..kind.coordinates() {
            let local = if kind == JointKind::Ball { Vector3::from(UPRIGHT[axis]) } else { Vector3::from(axes[axis]) };
            let axis_world = turned[joint] * local.cast::<f64>();
            let square: f64 = points.iter().map(|p| axis_world.cross(p).norm_squared()).sum();
            levers[first + axis] = if kind == JointKind::Slider { 1.0 } else { square.sqrt().max(SHORTEST_LEVER) };
        }
    }
    levers
}
