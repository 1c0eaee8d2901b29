//! Joint positions to joint rotations, bones keeping their rest length.

use nalgebra::{Matrix3, Matrix4, Quaternion, UnitQuaternion, Vector3};

use super::Skeleton;

/// A bone shorter than this points nowhere, m.
const NO_BONE: f64 = 1e-6;

/// Local rotations `[joints]` that bring a skeleton to given world positions `[joints]`, m; the root is put at
/// `positions[0]`.
///
/// From the root outwards, each joint is turned so that its bones point from where the joint *came to lie* at where its
/// children should be, which keeps errors of bone length from adding up. One child: the smallest swing from the reference
/// pose, so the twist is the reference's. Several children: the best rotation in the least-squares sense. A child
/// at no distance (CMU: Neck and Shoulders on the chest) is seen through to its own children.
///
/// `reference`: local rotations `[joints]` to start from; `None` is the rest pose. Leaves keep the reference.
/// A missing position counts as zero, so give all of them.
pub fn rotations(
    skeleton: &Skeleton,
    positions: &[Vector3<f64>],
    reference: Option<&[UnitQuaternion<f64>]>,
) -> Vec<UnitQuaternion<f64>> {
    let n = skeleton.len();
    let target = |joint: usize| positions.get(joint).copied().unwrap_or_default();
    let bones = bones(skeleton);
    let (mut places, mut worlds) = (Vec::with_capacity(n), Vec::with_capacity(n));
    let mut locals = Vec::with_capacity(n);
    for (index, joint) in skeleton.joints.iter().enumerate() {
        let (place, above) = match joint.parent {
            Some(p) => (places[p] + worlds[p] * joint.offset, worlds[p]),
            None => (target(index), UnitQuaternion::identity()),
        };
        let start: UnitQuaternion<f64> = above * reference.and_then(|r| r.get(index)).copied().unwrap_or_default();
        let pairs: Vec<(Vector3<f64>, Vector3<f64>)> =
            bones[index].iter().map(|&(child, rest)| (start * rest, target(child) - place)).collect();
        let world = turn(&pairs) * start;
        locals.push(above.inverse() * world);
        places.push(place);
        worlds.push(world);
    }
    locals
}

/// For each joint, the joints that its rotation moves directly, with their rest positions relative to it.
fn bones(skeleton: &Skeleton) -> Vec<Vec<(usize, Vector3<f64>)>> {
    let mut bones: Vec<Vec<(usize, Vector3<f64>)>> = vec![Vec::new(); skeleton.len()];
    // Backwards: the bones of a joint at no distance are known when its parent asks.
    for (index, joint) in skeleton.joints.iter().enumerate().rev() {
        let Some(parent) = joint.parent else { continue };
        if joint.offset.norm() > NO_BONE {
            bones[parent].push((index, joint.offset));
        } else {
            let through = bones[index].clone();
            bones[parent].extend(through);
        }
    }
    bones
}

/// The rotation that turns each first vector best towards its second.
pub(crate) fn turn(pairs: &[(Vector3<f64>, Vector3<f64>)]) -> UnitQuaternion<f64> {
    match pairs {
        [] => UnitQuaternion::identity(),
        [(from, to)] => swing(from, to),
        _ => best(pairs),
    }
}

/// The smallest rotation from one direction to another; none where a direction is missing.
fn swing(from: &Vector3<f64>, to: &Vector3<f64>) -> UnitQuaternion<f64> {
    let (Some(from), Some(to)) = (from.try_normalize(NO_BONE), to.try_normalize(NO_BONE)) else {
        return UnitQuaternion::identity();
    };
    let rough = half_way(&from, &to).unwrap_or_else(|| {
        // Opposite: any axis across will do, the same one every time.
        let other = if from.x.abs() < 0.6 { Vector3::x() } else { Vector3::y() };
        let axis = nalgebra::Unit::new_normalize(from.cross(&other));
        UnitQuaternion::from_axis_angle(&axis, std::f64::consts::PI)
    });
    // Near half a turn the axis is poorly known; the small rest is not.
    half_way(&(rough * from), &to).map_or(rough, |rest| rest * rough)
}

/// `(1 + a.b, a x b)`, normalised, of unit vectors: exact for small angles, where a formula with acos loses half the digits.
fn half_way(a: &Vector3<f64>, b: &Vector3<f64>) -> Option<UnitQuaternion<f64>> {
    let q = Quaternion::from_parts(1.0 + a.dot(b), a.cross(b));
    UnitQuaternion::try_new(q, 1e-9)
}

/// The best rotation in the least-squares sense (Kabsch's problem, by Horn's quaternion method): the largest eigenvector of
/// a 4 x 4 matrix. An eigenvector is always a rotation, never a reflection, also where all pairs lie in a plane.
fn best(pairs: &[(Vector3<f64>, Vector3<f64>)]) -> UnitQuaternion<f64> {
    let s: Matrix3<f64> = pairs.iter().map(|(from, to)| from * to.transpose()).sum();
    let turn = Vector3::new(s.m23 - s.m32, s.m31 - s.m13, s.m12 - s.m21);
    let mut k = Matrix4::zeros();
    k[(0, 0)] = s.trace();
    k.fixed_view_mut::<3, 1>(1, 0).copy_from(&turn);
    k.fixed_view_mut::<1, 3>(0, 1).copy_from(&turn.transpose());
    k.fixed_view_mut::<3, 3>(1, 1).copy_from(&(s + s.transpose() - Matrix3::identity() * s.trace()));
    let eigen = k.symmetric_eigen();
    let first = eigen.eigenvalues.imax();
    let others = (0..4).filter(|&i| i != first).map(|i| eigen.eigenvalues[i]);
    let second = others.fold(f64::NEG_INFINITY, f64::max);
    // All on one line: the rotation about the line is free, so do not make one up.
    if eigen.eigenvalues[first] - second <= 1e-9 * s.norm() {
        return swing_mean(pairs);
    }
    let q = eigen.eigenvectors.column(first);
    UnitQuaternion::from_quaternion(Quaternion::new(q[0], q[1], q[2], q[3]))
}

/// The smallest swing for pairs on one line, which may point both ways.
fn swing_mean(pairs: &[(Vector3<f64>, Vector3<f64>)]) -> UnitQuaternion<f64> {
    let longest = pairs.iter().max_by(|a, b| a.0.norm().total_cmp(&b.0.norm()));
    let Some((line, _)) = longest else {
        return UnitQuaternion::identity();
    };
    let along = |p: &(Vector3<f64>, Vector3<f64>)| p.1 * p.0.dot(line).signum();
    swing(line, &pairs.iter().map(along).sum())
}
