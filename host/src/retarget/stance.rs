//! An upright pose of any skeleton, to compare rest poses in: arms and legs straight, facing +Z.
//!
//! Some rest poses are one (CMU, Daz). Others lay every bone along its own axis (Bandai Namco, Character Creator), so that legs point up.
//! A clip's mean pose then stands for it, with the axes about which its elbows and knees bend. Of a pack's rig it is the mean of what the
//! pack was trained on. Of a rig without one it is a pose with the arms held out that is made by the smallest turns: how its limbs are
//! twisted about themselves is then a guess.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use super::NO_BONE;
use crate::clip::solve::turn;
use crate::clip::{Canonical, Clip, JointMap, Skeleton};
use crate::rig::Rig;

use Canonical::*;

/// World rotations and positions of every joint.
pub(super) struct Stance {
    pub worlds: Vec<UnitQuaternion<f64>>,
    pub positions: Vec<Vector3<f64>>,
    /// Whether it is the rest pose.
    pub rests: bool,
    /// Whether it is the mean of a clip, in which hands and heads may be bent.
    bent: bool,
    /// The axes about which elbows and knees bend, in the order of [`BENDS`], if they had to be looked for.
    pub axes: [Option<Vector3<f64>>; 4],
}

/// Limbs that bend about one axis: their joints, and that axis in a stance with the arms held out.
pub(super) const BENDS: [([Canonical; 3], [f64; 3]); 4] = [
    ([LShoulder, LElbow, LWrist], [0.0, -1.0, 0.0]),
    ([RShoulder, RElbow, RWrist], [0.0, 1.0, 0.0]),
    ([LHip, LKnee, LAnkle], [1.0, 0.0, 0.0]),
    ([RHip, RKnee, RAnkle], [1.0, 0.0, 0.0]),
];

impl Stance {
    /// Of a clip's skeleton: its rest pose, else the mean pose of the clip.
    pub fn of_clip(clip: &Clip, map: &JointMap) -> Self {
        Self::at_rest(&clip.skeleton, map).unwrap_or_else(|| Self::mean(clip, map))
    }

    /// Of a rig: its rest pose, else the mean of what it was trained on, else a pose with the arms held out.
    pub fn of_rig(rig: &Rig) -> Self {
        let (skeleton, map) = (&rig.skeleton, &rig.map);
        Self::at_rest(skeleton, map).or_else(|| Self::trained(rig)).unwrap_or_else(|| Self::built(skeleton, map))
    }

    /// The pose at which a trained rig's coordinates are 0.
    fn trained(rig: &Rig) -> Option<Self> {
        let turn = |[i, j, k, w]: [f32; 4]| UnitQuaternion::try_new(Quaternion::new(w, i, j, k).cast(), 1e-9);
        let mut locals: Vec<_> =
            rig.joint_coordinates().iter().map(|joint| turn(joint.reference).unwrap_or_default()).collect();
        if locals.iter().all(|local| local.angle() < 1e-3) {
            return None;
        }
        let across = across(&rig.skeleton.pose_positions(&Vector3::zeros(), &locals), &rig.map)?;
        locals[0] = facing(&across)?.inverse() * locals[0];
        Some(Self { bent: true, ..Self::new(&rig.skeleton, &locals) })
    }

    fn new(skeleton: &Skeleton, locals: &[UnitQuaternion<f64>]) -> Self {
        Self {
            worlds: skeleton.world_rotations(locals),
            positions: skeleton.pose_positions(&Vector3::zeros(), locals),
            rests: false,
            bent: false,
            axes: [None; 4],
        }
    }

    /// Where the tip of a hand or a head without one is, in its axes: on from the forearm, up from the neck.
    pub fn straight(&self, skeleton: &Skeleton, joint: usize, head: bool) -> Vector3<f64> {
        let offset = skeleton.joints[joint].offset;
        match skeleton.joints[joint].parent {
            _ if self.bent => offset,
            _ if head => self.worlds[joint].inverse() * Vector3::y(),
            Some(p) => self.worlds[joint].inverse() * (self.worlds[p] * offset),
            None => offset,
        }
    }

    /// The rest pose, if it is upright with straight arms that are held out or hang.
    fn at_rest(skeleton: &Skeleton, map: &JointMap) -> Option<Self> {
        let mut locals = vec![UnitQuaternion::identity(); skeleton.len()];
        let across = across(&skeleton.rest_positions(), map)?;
        locals[0] = facing(&across)?.inverse();
        let stance = Self::new(skeleton, &locals);
        let way = |from: Canonical, to: Canonical| {
            Some((stance.positions[map.joint(to)?] - stance.positions[map.joint(from)?]).normalize())
        };
        // What a map does not name says nothing.
        let arm = |shoulder, elbow, wrist, side: f64| {
            way(shoulder, elbow).zip(way(elbow, wrist)).is_none_or(|(upper, lower)| {
                let (out, down) = (side * upper.x, -upper.y);
                upper.dot(&lower) > 0.7 && out > -0.3 && (out > 0.5 || down > 0.5)
            })
        };
        let trunk = [Head, Neck, Chest, Spine].into_iter().find_map(|top| way(Pelvis, top));
        let leg = |hip, knee, ankle| way(hip, ankle).or(way(hip, knee)).is_none_or(|leg| leg.y < -0.7);
        let upright = trunk.is_none_or(|trunk| trunk.y > 0.7)
            && leg(LHip, LKnee, LAnkle)
            && leg(RHip, RKnee, RAnkle)
            && arm(LShoulder, LElbow, LWrist, 1.0)
            && arm(RShoulder, RElbow, RWrist, -1.0);
        upright.then_some(Self { rests: true, ..stance })
    }

    /// The mean of a clip's poses, without their headings.
    fn mean(clip: &Clip, map: &JointMap) -> Self {
        let n = clip.skeleton.len();
        let mut sums = vec![Quaternion::new(0.0, 0.0, 0.0, 0.0); n];
        for frame in 0..clip.frames() {
            let heading = across(&clip.positions(frame), map).and_then(|across| facing(&across));
            for (joint, (sum, local)) in sums.iter_mut().zip(clip.pose(frame)).enumerate() {
                let ahead = heading.filter(|_| joint == 0).map_or(*local, |heading| heading.inverse() * local);
                let sign = if sum.dot(ahead.quaternion()) < 0.0 { -1.0 } else { 1.0 };
                *sum += ahead.into_inner() * sign;
            }
        }
        let locals = sums.into_iter().map(|sum| UnitQuaternion::try_new(sum, 1e-9).unwrap_or_default());
        let stance = Self::new(&clip.skeleton, &locals.collect::<Vec<_>>());
        let axes = BENDS.map(|(limb, _)| {
            let upper = map.joint(limb[0])?;
            Some(stance.worlds[upper] * bend(clip, [upper, map.joint(limb[1])?, map.joint(limb[2])?])?)
        });
        Self { bent: true, axes, ..stance }
    }

    /// Spine up, legs down, feet ahead, arms out, left on the left: from the root outwards, by the smallest turns.
    fn built(skeleton: &Skeleton, map: &JointMap) -> Self {
        let goals = goals(skeleton, map);
        let mut worlds: Vec<UnitQuaternion<f64>> = Vec::with_capacity(skeleton.len());
        let mut locals = Vec::with_capacity(skeleton.len());
        for (index, joint) in skeleton.joints.iter().enumerate() {
            let above = joint.parent.map_or_else(UnitQuaternion::identity, |p| worlds[p]);
            let mut bones = vec![index];
            let (mut pairs, mut sides) = (Vec::new(), [None, None]);
            while let Some(at) = bones.pop() {
                for child in skeleton.children(at) {
                    let offset = skeleton.joints[child].offset;
                    match goals[child] {
                        _ if offset.norm() < NO_BONE => bones.push(child),
                        Some(Goal::Towards(way)) => pairs.push((above * offset, way * offset.norm())),
                        Some(Goal::Side(side)) => sides[side] = Some(offset),
                        None => {}
                    }
                }
            }
            if let [Some(left), Some(right)] = sides {
                let line = left - right;
                pairs.push((above * line, Vector3::x() * line.norm()));
            }
            if let Some(end) = joint.end.filter(|end| pairs.is_empty() && end.norm() > NO_BONE) {
                let ankle = [LAnkle, RAnkle].iter().any(|a| map.joint(*a) == Some(index));
                pairs.extend(ankle.then(|| (above * end, ahead())));
            }
            let world = turn_about_ahead(&pairs) * above;
            locals.push(above.inverse() * world);
            worlds.push(world);
        }
        Self::new(skeleton, &locals)
    }
}

/// Where a bone points in the built pose.
#[derive(Clone, Copy)]
enum Goal {
    Towards(Vector3<f64>),
    /// Left or right of its partner.
    Side(usize),
}

fn ahead() -> Vector3<f64> {
    Vector3::new(0.0, -0.3, 1.0).normalize()
}

/// Where the bone that leads to each joint points: that of the first canonical joint at it or below it.
fn goals(skeleton: &Skeleton, map: &JointMap) -> Vec<Option<Goal>> {
    let goal = |canonical: Canonical| match canonical {
        Pelvis => None,
        Spine | Chest | Neck | Head => Some(Goal::Towards(Vector3::y())),
        LCollar | LHip => Some(Goal::Side(0)),
        RCollar | RHip => Some(Goal::Side(1)),
        LShoulder | LElbow | LWrist => Some(Goal::Towards(Vector3::x())),
        RShoulder | RElbow | RWrist => Some(Goal::Towards(-Vector3::x())),
        LKnee | LAnkle | RKnee | RAnkle => Some(Goal::Towards(-Vector3::y())),
        LToe | RToe => Some(Goal::Towards(ahead())),
    };
    let mut goals: Vec<Option<Goal>> = vec![None; skeleton.len()];
    for canonical in Canonical::ALL {
        if let Some(joint) = map.joint(canonical) {
            goals[joint] = goal(canonical);
        }
    }
    for joint in (1..skeleton.len()).rev() {
        if let Some(parent) = skeleton.joints[joint].parent {
            let known = Canonical::ALL.iter().any(|c| map.joint(*c) == Some(parent));
            goals[parent] = goals[parent].or(goals[joint].filter(|_| !known));
        }
    }
    goals
}

/// The axis about which a limb bends over a clip, in the axes of its first joint; none where it hardly bends, or not about one.
fn bend(clip: &Clip, limb: [usize; 3]) -> Option<Vector3<f64>> {
    let (mut sum, mut whole) = (Vector3::zeros(), 0.0);
    for frame in 0..clip.frames() {
        let positions = clip.positions(frame);
        let world = clip.skeleton.world_rotations(clip.pose(frame))[limb[0]];
        let bone = |from: usize, to: usize| (positions[to] - positions[from]).try_normalize(NO_BONE);
        let axis = bone(limb[0], limb[1]).zip(bone(limb[1], limb[2])).map_or_else(Vector3::zeros, |(a, b)| a.cross(&b));
        sum += world.inverse() * axis;
        whole += axis.norm();
    }
    // A bend of 6 degrees on the average.
    let bends = whole > 0.1 * clip.frames() as f64 && sum.norm() > 0.8 * whole;
    sum.try_normalize(NO_BONE).filter(|_| bends)
}

/// From the right hip to the left one.
fn across(positions: &[Vector3<f64>], map: &JointMap) -> Option<Vector3<f64>> {
    Some(positions[map.joint(LHip)?] - positions[map.joint(RHip)?])
}

/// The turn about the vertical of somebody whose hips lie so.
fn facing(across: &Vector3<f64>) -> Option<UnitQuaternion<f64>> {
    let flat = across.x.hypot(across.z) > NO_BONE;
    flat.then(|| UnitQuaternion::from_axis_angle(&Vector3::y_axis(), f64::atan2(-across.z, across.x)))
}

/// The best turn of the pairs; nearly half a turn of one bone goes about the axis ahead, as legs do whose hips have the bone's axis up.
fn turn_about_ahead(pairs: &[(Vector3<f64>, Vector3<f64>)]) -> UnitQuaternion<f64> {
    match pairs {
        [(from, to)] if from.angle(to) > 2.9 => {
            let half = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), std::f64::consts::PI);
            turn(&[(half * from, *to)]) * half
        }
        _ => turn(pairs),
    }
}
