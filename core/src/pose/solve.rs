//! Joint positions -> rotations: bones keep their length, swing from the wanted direction, twist from the source pose.

use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};

use crate::kernel::sqrt;

use super::{Pose, Skeleton, World, unit};

/// Steps of the rotation fit of a joint with several bones; it converges quadratically.
const FIT_STEPS: usize = 4;

/// Bones of a joint that are fitted; those behind them follow.
const FITTED: usize = 8;

/// Turns the joints of `source` so that every bone points at its target position, from the root outwards.
///
/// `world` is `source` after [`forward`](super::forward); `targets` are world positions, m, one a joint; the root goes to
/// its target. A joint with one bone makes the smallest turn (so its twist is the source's, relative to the parent); a joint
/// with several bones makes the turn that fits them (the first eight) best; a joint without bones keeps its local rotation. Targets
/// equal to the source's positions give the source pose, to rounding.
///
/// Cost: about 130 multiply-adds a joint with one bone, 500 a joint with several, 30 a joint without.
pub fn solve<const JOINTS: usize>(
    skeleton: &Skeleton,
    source: &Pose<JOINTS>,
    world: &World<JOINTS>,
    targets: &[Vector3<f32>; JOINTS],
    pose: &mut Pose<JOINTS>,
) {
    let mut solved = World::<JOINTS>::identity();
    let mut aims = skeleton.aims;
    pose.root = targets.first().copied().unwrap_or(source.root);
    for (joint, (parent, offset)) in skeleton.parents.iter().zip(skeleton.offsets).enumerate() {
        let (origin, turned) = solved.parent(joint, *parent, pose.root);
        let offset = if joint == 0 { Vector3::zeros() } else { Vector3::from(*offset) };
        let here = origin + turned * offset;
        let count = aims.iter().take_while(|[of, _]| *of as usize == joint).count();
        let (own, rest) = aims.split_at_checked(count).unwrap_or((aims, &[]));
        aims = rest;

        let (Some(local), Some(from), Some(was)) =
            (source.rotations.get(joint), world.positions.get(joint), world.rotations.get(joint))
        else {
            return;
        };
        // As far as the parent has turned.
        let carried = turned * local;
        let mut bones = own.iter().filter_map(|[_, to]| {
            let to = *to as usize;
            let (before, wanted) = (world.positions.get(to)?, targets.get(to)? - here);
            let bone = match (skeleton.parents.get(to), skeleton.offsets.get(to)) {
                (Some(parent), Some(offset)) if *parent as usize == joint => Vector3::from(*offset),
                _ => was.inverse() * (before - from),
            };
            Some((carried * bone, wanted))
        });
        let (rotation, local) = match own.len() {
            0 => (carried, local.into_inner()),
            1 => {
                let turn = bones.next().map_or_else(UnitQuaternion::identity, |(bone, wanted)| swing(bone, wanted));
                let rotation = turn * carried;
                (rotation, (turned.inverse() * rotation).into_inner())
            }
            _ => {
                let rotation = best_turn(bones) * carried;
                (rotation, (turned.inverse() * rotation).into_inner())
            }
        };
        if let (Some(out), Some(position), Some(world)) =
            (pose.rotations.get_mut(joint), solved.positions.get_mut(joint), solved.rotations.get_mut(joint))
        {
            *out = unit(local);
            *position = here;
            *world = rotation;
        }
    }
}

/// The smallest rotation that turns `bone` into the direction of `wanted`.
fn swing(bone: Vector3<f32>, wanted: Vector3<f32>) -> UnitQuaternion<f32> {
    let lengths = sqrt(bone.dot(&bone) * wanted.dot(&wanted));
    half_way(lengths + bone.dot(&wanted), bone.cross(&wanted), lengths)
}

/// One bone of several: where it points, where it should, scaled to its length, and the square of that.
#[derive(Clone, Copy)]
struct Pull {
    bone: Vector3<f32>,
    wanted: Vector3<f32>,
    square: f32,
}

/// The rotation that turns all bones best into the wanted directions, weighted by length (Gauss-Newton on the rotation
/// vector; a trace of damping keeps the twist of bones that lie on one line).
fn best_turn(bones: impl Iterator<Item = (Vector3<f32>, Vector3<f32>)>) -> UnitQuaternion<f32> {
    let mut pulls = [Pull { bone: Vector3::zeros(), wanted: Vector3::zeros(), square: 0.0 }; FITTED];
    let (mut count, mut trace) = (0, 0.0);
    let wide = bones.filter(|(_, wanted)| wanted.dot(wanted) > 1e-12);
    for (pull, (bone, wanted)) in pulls.iter_mut().zip(wide) {
        let square = bone.dot(&bone);
        *pull = Pull { bone, wanted: wanted * sqrt(square / wanted.dot(&wanted)), square };
        count += 1;
        trace += square;
    }
    let mut turn = UnitQuaternion::identity();
    for _ in 0..FIT_STEPS {
        let mut normal = Matrix3::from_diagonal_element(1e-4 * trace + 1e-12);
        let mut right = Vector3::zeros();
        for pull in pulls.iter().take(count) {
            // Weighted by the square of the bone's length, so that zero bones drop out.
            let bone = turn * pull.bone;
            normal += Matrix3::from_diagonal_element(pull.square) - bone * bone.transpose();
            right += bone.cross(&pull.wanted);
        }
        let vector = solve_symmetric(&normal, right);
        turn = unit((UnitQuaternion::new_unchecked(Quaternion::from_parts(1.0, vector * 0.5)) * turn).into_inner());
    }
    turn
}

/// `m^-1 v` for a positive definite 3 x 3 matrix, by cofactors.
fn solve_symmetric(m: &Matrix3<f32>, v: Vector3<f32>) -> Vector3<f32> {
    let (a, b, c) = (m.column(0).into_owned(), m.column(1).into_owned(), m.column(2).into_owned());
    let (bc, ca, ab) = (b.cross(&c), c.cross(&a), a.cross(&b));
    Vector3::new(bc.dot(&v), ca.dot(&v), ab.dot(&v)) * (1.0 / a.dot(&bc))
}

/// The rotation along the quaternion with this real and imaginary part; the identity where both vanish against `scale` (a half
/// turn has no smallest rotation, and a bone without length no direction).
fn half_way(real: f32, imaginary: Vector3<f32>, scale: f32) -> UnitQuaternion<f32> {
    // Squares neither vanish nor overflow between these.
    if (1e-12..1e12).contains(&scale) && real > 1e-6 * scale {
        let inverse = 1.0 / sqrt(real * real + imaginary.dot(&imaginary));
        UnitQuaternion::new_unchecked(Quaternion::from_parts(real * inverse, imaginary * inverse))
    } else {
        UnitQuaternion::identity()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pose::forward;

    // Hips with two legs and a spine behind a zero-length joint; an arm.
    const PARENTS: [u16; 7] = [0, 0, 0, 0, 3, 4, 5];
    const OFFSETS: [[f32; 3]; 7] =
        [[0.0; 3], [0.1, -0.1, 0.0], [-0.1, -0.1, 0.0], [0.0; 3], [0.0, 0.3, 0.02], [0.2, 0.1, 0.0], [0.3, 0.0, 0.1]];
    const AIMS: [[u16; 2]; 5] = [[0, 1], [0, 2], [3, 4], [4, 5], [5, 6]];

    fn skeleton() -> Skeleton<'static> {
        Skeleton::new(&PARENTS, &OFFSETS, &AIMS, &[[1, 2]]).unwrap()
    }

    fn pose(seed: f32) -> Pose<8> {
        let mut pose = Pose::identity();
        pose.root = Vector3::new(seed, 0.9, -seed);
        for (j, rotation) in pose.rotations.iter_mut().enumerate() {
            let k = j as f32 + seed;
            *rotation =
                unit(Quaternion::new(1.0, 0.3 * libm::sinf(k), 0.3 * libm::sinf(2.0 * k), 0.3 * libm::sinf(3.0 * k)));
        }
        pose
    }

    fn positions(pose: &Pose<8>) -> World<8> {
        let mut world = World::identity();
        forward(&skeleton(), pose, &mut world);
        world
    }

    #[test]
    fn own_positions_give_the_source_back() {
        let source = pose(1.0);
        let world = positions(&source);
        let mut out = Pose::identity();
        solve(&skeleton(), &source, &world, &world.positions, &mut out);
        assert_eq!(out.root, source.root);
        for (out, source) in out.rotations.iter().zip(&source.rotations).take(7) {
            assert!((out.coords - source.coords).norm() < 2e-6);
        }
    }

    #[test]
    fn reaches_the_positions_of_another_pose() {
        let source = pose(1.0);
        let wanted = positions(&pose(1.4));
        let mut out = Pose::identity();
        solve(&skeleton(), &source, &positions(&source), &wanted.positions, &mut out);
        for (reached, wanted) in positions(&out).positions.iter().zip(&wanted.positions).take(7) {
            assert!((reached - wanted).norm() < 2e-4, "{reached} {wanted}");
        }
    }

    #[test]
    fn opposite_and_vanishing_directions_are_harmless() {
        let source = pose(0.5);
        let world = positions(&source);
        let mut targets = world.positions;
        targets[6] = targets[5] - (targets[6] - targets[5]);
        targets[5] = targets[4];
        let mut out = Pose::identity();
        solve(&skeleton(), &source, &world, &targets, &mut out);
        assert!(out.rotations.iter().all(|q| (q.norm() - 1.0).abs() < 1e-5));
        // Farther away than squares reach: rotations all the same.
        targets[6] = Vector3::new(1e30, -1e30, 1e25);
        solve(&skeleton(), &source, &world, &targets, &mut out);
        assert!(out.rotations.iter().all(|q| (q.norm() - 1.0).abs() < 1e-5));
    }

    #[test]
    fn eight_bones_of_a_joint_are_fitted_and_the_ninth_follows() {
        let offset = |bone: usize| [libm::cosf(bone as f32), 0.3 * bone as f32 - 1.0, libm::sinf(1.7 * bone as f32)];
        let parents = [0u16; 10];
        let mut offsets = [[0.0; 3]; 10];
        (1..10).for_each(|bone| offsets[bone] = offset(bone));
        let mut aims = [[0u16; 2]; 9];
        (1..10).for_each(|bone| aims[bone - 1] = [0, bone as u16]);
        let hand = Skeleton::new(&parents, &offsets, &aims, &[[1, 2]]).unwrap();
        let source = Pose::<10>::identity();
        let mut world = World::identity();
        forward(&hand, &source, &mut world);
        let turn = UnitQuaternion::from_scaled_axis(Vector3::new(0.4, -0.3, 0.5));
        let mut targets = world.positions.map(|position| turn * position);
        // It pulls elsewhere, and does not count.
        targets[9] = Vector3::new(3.0, 0.0, 0.0);
        let mut out = Pose::identity();
        solve(&hand, &source, &world, &targets, &mut out);
        assert!(out.rotations[0].angle_to(&turn) < 1e-3, "{}", out.rotations[0].angle_to(&turn));
    }
}
