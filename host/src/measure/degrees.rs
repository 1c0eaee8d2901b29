//! Angles between the rotations of matched frames.

use nalgebra::{UnitQuaternion, Vector3};
use serde::Serialize;

use crate::clip::Skeleton;

/// Bones shorter than this have no direction, m.
const SHORTEST_BONE: f64 = 1e-4;

/// Mean geodesic angles between local rotations, degrees.
///
/// The root counts with its tilt alone, the smallest angle over all headings: as in centimetres, it does not matter which way a
/// body faces.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Degrees {
    /// Over all joints.
    pub all: f64,
    /// Over the joints from which no other joint hangs: head, hands, feet.
    pub leaves: f64,
    /// Over the others.
    pub inner: f64,
    /// Joint by joint.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub joints: Vec<JointDegrees>,
}

/// Mean angles of one joint, degrees.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct JointDegrees {
    /// Its name.
    pub joint: String,
    /// Whether no other joint hangs from it.
    pub leaf: bool,
    /// Geodesic angle between the rotations.
    pub angle: f64,
    /// Angle between the directions of the bone. The root's is its tilt.
    pub swing: f64,
    /// Of a slider: how far apart the lengths are, mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub millimetres: Option<f64>,
    /// Turn about the bone that is left when the bone's directions are brought together. The root has none.
    pub twist: f64,
}

/// Mean angles between two motions on one skeleton, `[frames x joints]` each, over the matches `(frame of a, frame of b)`.
///
/// A joint's bone points to the middle of what hangs from it, else to the end of the joint, else away from its parent.
pub fn degrees(
    skeleton: &Skeleton,
    a: &[UnitQuaternion<f64>],
    b: &[UnitQuaternion<f64>],
    matches: impl Iterator<Item = (usize, usize)>,
) -> Degrees {
    let count = skeleton.len();
    let bones: Vec<Vector3<f64>> = (0..count).map(|joint| bone(skeleton, joint)).collect();
    let mut sums = vec![[0.0; 3]; count];
    let mut frames = 0usize;
    for (i, j) in matches {
        frames += 1;
        let rows = a[i * count..][..count].iter().zip(&b[j * count..][..count]);
        for ((sum, bone), (joint, (a, b))) in sums.iter_mut().zip(&bones).zip(rows.enumerate()) {
            let found = if skeleton.joints[joint].parent.is_none() { tilt(a, b) } else { turn(a, b, bone) };
            sum.iter_mut().zip(found).for_each(|(sum, angle)| *sum += angle.to_degrees());
        }
    }
    let joints = skeleton.joints.iter().zip(sums).enumerate().map(|(index, (joint, sum))| {
        let [angle, swing, twist] = sum.map(|sum| sum / frames.max(1) as f64);
        let leaf = skeleton.children(index).next().is_none();
        JointDegrees { joint: joint.name.clone(), leaf, angle, swing, twist, millimetres: None }
    });
    Degrees::of(joints.collect())
}

impl Degrees {
    fn of(joints: Vec<JointDegrees>) -> Self {
        let mean = |keep: fn(&JointDegrees) -> bool| {
            let angles: Vec<f64> = joints.iter().filter(|joint| keep(joint)).map(|joint| joint.angle).collect();
            angles.iter().sum::<f64>() / angles.len().max(1) as f64
        };
        Self { all: mean(|_| true), leaves: mean(|joint| joint.leaf), inner: mean(|joint| !joint.leaf), joints }
    }

    /// Means of the figures of several motions on one skeleton.
    pub fn mean<'a>(all: impl Iterator<Item = &'a Self> + Clone) -> Self {
        let count = all.clone().count().max(1) as f64;
        let mut joints: Vec<JointDegrees> = all.clone().next().map_or_else(Vec::new, |first| first.joints.clone());
        for (index, joint) in joints.iter_mut().enumerate() {
            let mean = |of: fn(&JointDegrees) -> f64| {
                all.clone().filter_map(|degrees| degrees.joints.get(index)).map(of).sum::<f64>() / count
            };
            (joint.angle, joint.swing, joint.twist) = (mean(|j| j.angle), mean(|j| j.swing), mean(|j| j.twist));
            joint.millimetres = joint.millimetres.map(|_| mean(|j| j.millimetres.unwrap_or_default()));
        }
        let mean = |of: fn(&Self) -> f64| all.clone().map(of).sum::<f64>() / count;
        Self { all: mean(|d| d.all), leaves: mean(|d| d.leaves), inner: mean(|d| d.inner), joints }
    }

    /// The same without the joints.
    pub fn brief(&self) -> Self {
        Self { joints: Vec::new(), ..self.clone() }
    }
}

/// Angle, swing and twist of the turn from `a` to `b`, rad, with a bone in the joint's own axes.
fn turn(a: &UnitQuaternion<f64>, b: &UnitQuaternion<f64>, bone: &Vector3<f64>) -> [f64; 3] {
    let between = a.rotation_to(b);
    let swing = (a * bone).angle(&(b * bone));
    // In `a`'s axes: what of the turn is about the bone.
    let local = a.inverse() * b;
    let half = local.imag().dot(bone).abs().atan2(local.w.abs());
    [between.angle(), swing, 2.0 * half]
}

/// The smallest angle between two rotations over all headings: that between the verticals as the joint sees them.
fn tilt(a: &UnitQuaternion<f64>, b: &UnitQuaternion<f64>) -> [f64; 3] {
    let up = |q: &UnitQuaternion<f64>| q.inverse() * Vector3::y();
    let angle = up(a).angle(&up(b));
    [angle, angle, 0.0]
}

/// Direction of a joint's bone in its own axes, of length one.
fn bone(skeleton: &Skeleton, joint: usize) -> Vector3<f64> {
    let own = &skeleton.joints[joint];
    let below = || tips(skeleton, joint).iter().sum::<Vector3<f64>>();
    let candidates = [below(), own.end.unwrap_or_default(), own.offset, Vector3::y()];
    let direction = candidates.into_iter().find_map(|bone| bone.try_normalize(SHORTEST_BONE));
    direction.unwrap_or_else(Vector3::y)
}

/// Where the children of a joint are; those at no distance stand back for their own children.
fn tips(skeleton: &Skeleton, joint: usize) -> Vec<Vector3<f64>> {
    let of = |child: usize| {
        let offset = skeleton.joints[child].offset;
        if offset.norm() > SHORTEST_BONE { vec![offset] } else { tips(skeleton, child) }
    };
    skeleton.children(joint).flat_map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gait::{Manner, skeleton, walk};

    fn about(axis: Vector3<f64>, degrees: f64) -> UnitQuaternion<f64> {
        UnitQuaternion::new(axis.normalize() * degrees.to_radians())
    }

    /// The gait's skeleton, still, and the same with one joint turned.
    fn turned(name: &str, by: UnitQuaternion<f64>) -> (Degrees, JointDegrees) {
        let skeleton = skeleton();
        let joint = skeleton.find(name).unwrap();
        let still = vec![about(Vector3::x(), 20.0); skeleton.len()];
        let mut other = still.clone();
        other[joint] *= by;
        let found = degrees(&skeleton, &still, &other, [(0, 0), (0, 0)].into_iter());
        let joint = found.joints[joint].clone();
        (found, joint)
    }

    fn near(found: f64, wanted: f64) {
        assert!((found - wanted).abs() < 1e-9, "found {found}, wanted {wanted}");
    }

    #[test]
    fn a_turn_about_the_bone_is_twist_and_one_across_it_swing() {
        // The forearm hangs along -Y.
        let (_, twist) = turned("LeftForeArm", about(Vector3::y(), 30.0));
        [twist.angle, twist.swing, twist.twist].into_iter().zip([30.0, 0.0, 30.0]).for_each(|(a, b)| near(a, b));
        let (_, swing) = turned("LeftForeArm", about(Vector3::new(1.0, 0.0, 1.0), -40.0));
        [swing.angle, swing.swing, swing.twist].into_iter().zip([40.0, 40.0, 0.0]).for_each(|(a, b)| near(a, b));
        // Both: half angles multiply as cosines.
        let (_, both) = turned("LeftForeArm", about(Vector3::x(), 40.0) * about(Vector3::y(), 30.0));
        near(both.swing, 40.0);
        near(both.twist, 30.0);
        let half = |degrees: f64| (0.5 * degrees.to_radians()).cos();
        near(both.angle, 2.0 * (half(40.0) * half(30.0)).acos().to_degrees());
        // The long way round is the short way back.
        near(turned("Head", about(Vector3::y(), 350.0)).1.angle, 10.0);
    }

    #[test]
    fn leaves_and_others_are_told_apart() {
        // Head, two hands, two toes of 19 joints.
        let (head, _) = turned("Head", about(Vector3::y(), 19.0));
        [head.all, head.leaves, head.inner].into_iter().zip([1.0, 19.0 / 5.0, 0.0]).for_each(|(a, b)| near(a, b));
        let (neck, _) = turned("Neck1", about(Vector3::y(), 28.0));
        [neck.all, neck.leaves, neck.inner].into_iter().zip([28.0 / 19.0, 0.0, 2.0]).for_each(|(a, b)| near(a, b));
    }

    #[test]
    fn the_root_counts_its_tilt_and_not_its_heading() {
        let skeleton = skeleton();
        let still = vec![about(Vector3::new(1.0, 2.0, 0.5), 25.0); skeleton.len()];
        let mut facing = still.clone();
        facing[0] = about(Vector3::y(), 130.0) * facing[0];
        near(degrees(&skeleton, &still, &facing, [(0, 0)].into_iter()).all, 0.0);
        let mut leaning = vec![UnitQuaternion::identity(); skeleton.len()];
        leaning[0] = about(Vector3::y(), -70.0) * about(Vector3::x(), 38.0);
        let upright = vec![UnitQuaternion::identity(); skeleton.len()];
        let found = degrees(&skeleton, &upright, &leaning, [(0, 0)].into_iter());
        near(found.joints[0].angle, 38.0);
        near(found.all, 2.0);
    }

    #[test]
    fn made_walks_differ_where_their_manners_do() {
        let frames = 60;
        let nodding = Manner { nod: Manner::NEUTRAL.nod + 0.3, ..Manner::NEUTRAL };
        let still = |manner: &Manner| walk(&Manner { sway: 0.0, ..*manner }, 1.0, 60.0, 0.0, 3);
        let (plain, nods) = (still(&Manner::NEUTRAL), still(&nodding));
        let found = degrees(&plain.skeleton, &plain.rotations, &nods.rotations, (0..frames).map(|f| (f, f)));
        let of = |name: &str| found.joints.iter().find(|joint| joint.joint == name).unwrap();
        // The neck bends by the nod (5 % wobble), the head takes 0.3 of the plain nod back, without wobble.
        let nod = 0.3f64.to_degrees();
        assert!((of("Neck1").angle - nod).abs() < 0.06 * nod, "{:?}", of("Neck1"));
        near(of("Head").angle, 0.3 * nod);
        // Bent about the pitch axis, which is square to the bones: all swing.
        near(of("Head").swing, 0.3 * nod);
        near(of("LeftHand").angle, 0.0);
        near(found.leaves, 0.3 * nod / 5.0);
    }
}
