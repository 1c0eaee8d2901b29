//! What simpler models do to rotations: the mean offset, and the best affine map of each joint's rotation vector.
//!
//! The counterpart in degrees of the baselines on positions. Fitted on matched frames of the training pairs, kept in the pack.

use faer::Mat;
use faer::linalg::solvers::Solve;
use nalgebra::{Matrix3, UnitQuaternion, Vector3};

use super::Measurable;
use crate::align::{AlignError, Series, aligned_path};
use crate::clip::Clip;
use crate::rig::Rig;

/// Numbers that a joint takes in a pack.
const NUMBERS: usize = 15;
/// Variance below which a turn is noise, rad^2 (about one degree): the ridge of the affine map.
const NOISE: f64 = 4e-4;
/// Rounds of the mean of rotations; each leaves a small part of the error.
const ROUNDS: usize = 20;

/// Both simpler models of one joint.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Turn {
    /// Mean rotation of the source, as a rotation vector, rad.
    source: Vector3<f64>,
    /// Mean rotation of the target.
    target: Vector3<f64>,
    /// From rotation vectors about the source's mean to those about the target's.
    slope: Matrix3<f64>,
}

/// The simpler models of all joints.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Turns(Vec<Turn>);

impl Turns {
    /// Fits both models on pairs of clips `(source, target)` on the rig, each matched by the plain time warp of its positions:
    /// what a user without this program would do.
    ///
    /// # Errors
    /// As [`aligned_path`].
    pub fn of_pairs<'a>(rig: &Rig, pairs: impl IntoIterator<Item = (&'a Clip, &'a Clip)>) -> Result<Self, AlignError> {
        let joints = rig.joints();
        let (mut from, mut to) = (Vec::new(), Vec::new());
        for (source, target) in pairs {
            let (a, b) = (Measurable::new(rig, source), Measurable::new(rig, target));
            let series = |motion| Series::new(motion, 3 * joints);
            for (i, j) in aligned_path(series(&a.positions)?, series(&b.positions)?)? {
                from.extend_from_slice(source.pose(i));
                to.extend_from_slice(target.pose(j));
            }
        }
        Ok(Self::fit(&from, &to, joints))
    }

    /// Fits both models on local rotations `[frames x joints]`, the target's frames matched to the source's. The root turns about
    /// its heading, which both leave as it is.
    pub fn fit(source: &[UnitQuaternion<f64>], target: &[UnitQuaternion<f64>], joints: usize) -> Self {
        let column = |rows: &[UnitQuaternion<f64>], joint: usize| -> Vec<UnitQuaternion<f64>> {
            let rows = rows.iter().skip(joint).step_by(joints);
            rows.map(|q| if joint == 0 { split(q).1 } else { *q }).collect()
        };
        Self((0..joints).map(|joint| Turn::fit(&column(source, joint), &column(target, joint))).collect())
    }

    /// From the numbers in a pack; `None` if it holds none for this number of joints.
    pub fn from_numbers(numbers: &[f32], joints: usize) -> Option<Self> {
        let of = |n: &[f32; NUMBERS]| {
            let n = n.map(f64::from);
            let vector = |at: usize| Vector3::new(n[at], n[at + 1], n[at + 2]);
            Turn { source: vector(0), target: vector(3), slope: Matrix3::from_row_slice(&n[6..]) }
        };
        (joints > 0 && numbers.len() == NUMBERS * joints)
            .then(|| Self(numbers.as_chunks::<NUMBERS>().0.iter().map(of).collect()))
    }

    /// As the pack keeps it, `[joints x 15]`: mean rotation vectors of source and target, row-major 3 x 3.
    pub fn numbers(&self) -> Vec<f32> {
        let of = |turn: &Turn| {
            let slope = turn.slope.transpose();
            [turn.source.as_slice(), turn.target.as_slice(), slope.as_slice()].concat()
        };
        self.0.iter().flat_map(of).map(|x| x as f32).collect()
    }

    /// Every rotation turned by the difference of the means.
    pub fn offset(&self, rotations: &[UnitQuaternion<f64>]) -> Vec<UnitQuaternion<f64>> {
        self.apply(rotations, |turn, q| q * turn.mean_source().inverse() * turn.mean_target())
    }

    /// Every rotation through its joint's affine map.
    pub fn affine(&self, rotations: &[UnitQuaternion<f64>]) -> Vec<UnitQuaternion<f64>> {
        self.apply(rotations, |turn, q| {
            let vector = (turn.mean_source().inverse() * q).scaled_axis();
            turn.mean_target() * UnitQuaternion::from_scaled_axis(turn.slope * vector)
        })
    }

    fn apply(
        &self,
        rotations: &[UnitQuaternion<f64>],
        map: impl Fn(&Turn, UnitQuaternion<f64>) -> UnitQuaternion<f64>,
    ) -> Vec<UnitQuaternion<f64>> {
        let joints = self.0.iter().enumerate().cycle();
        let turn = |(q, (joint, turn)): (&UnitQuaternion<f64>, (usize, &Turn))| {
            let (heading, tilt) = if joint == 0 { split(q) } else { (UnitQuaternion::identity(), *q) };
            heading * map(turn, tilt)
        };
        rotations.iter().zip(joints).map(turn).collect()
    }
}

impl Turn {
    fn fit(source: &[UnitQuaternion<f64>], target: &[UnitQuaternion<f64>]) -> Self {
        let means = [mean(source), mean(target)];
        let vectors = |rows: &[UnitQuaternion<f64>], mean: &UnitQuaternion<f64>| -> Vec<Vector3<f64>> {
            rows.iter().map(|q| (mean.inverse() * q).scaled_axis()).collect()
        };
        let (from, to) = (vectors(source, &means[0]), vectors(target, &means[1]));
        let frames = from.len().max(1) as f64;
        let covariance = |a: &[Vector3<f64>], b: &[Vector3<f64>]| {
            Mat::from_fn(3, 3, |i, j| a.iter().zip(b).map(|(a, b)| a[i] * b[j]).sum::<f64>() / frames)
        };
        let mut normal = covariance(&from, &from);
        (0..3).for_each(|d| normal[(d, d)] += NOISE);
        let slope = match normal.llt(faer::Side::Lower) {
            Ok(cholesky) => {
                let slope = cholesky.solve(&covariance(&from, &to));
                Matrix3::from_fn(|row, column| slope[(column, row)])
            }
            // Turns that are not finite: the mean alone.
            Err(_) => Matrix3::zeros(),
        };
        Self { source: means[0].scaled_axis(), target: means[1].scaled_axis(), slope }
    }

    fn mean_source(&self) -> UnitQuaternion<f64> {
        UnitQuaternion::from_scaled_axis(self.source)
    }

    fn mean_target(&self) -> UnitQuaternion<f64> {
        UnitQuaternion::from_scaled_axis(self.target)
    }
}

/// Heading and tilt of a rotation, `heading * tilt`: the turn about the vertical, and the rest.
fn split(q: &UnitQuaternion<f64>) -> (UnitQuaternion<f64>, UnitQuaternion<f64>) {
    let vertical = Vector3::y() * (2.0 * q.j.atan2(q.w));
    let heading = UnitQuaternion::from_scaled_axis(vertical);
    (heading, heading.inverse() * q)
}

/// The rotation about which the rotation vectors have the mean 0.
fn mean(rotations: &[UnitQuaternion<f64>]) -> UnitQuaternion<f64> {
    let Some(mut mean) = rotations.first().copied() else { return UnitQuaternion::identity() };
    for _ in 0..ROUNDS {
        let sum: Vector3<f64> = rotations.iter().map(|q| (mean.inverse() * q).scaled_axis()).sum();
        mean *= UnitQuaternion::from_scaled_axis(sum / rotations.len() as f64);
    }
    mean
}

#[cfg(test)]
mod tests {
    use super::*;

    fn turn(x: f64, y: f64, z: f64) -> UnitQuaternion<f64> {
        UnitQuaternion::from_scaled_axis(Vector3::new(x, y, z))
    }

    /// A root that tilts and faces every way, and one joint that swings: `[frames x 2]`.
    fn source() -> Vec<UnitQuaternion<f64>> {
        let frame = |t: usize| {
            let t = t as f64;
            let root = turn(0.0, 0.3 * t, 0.0) * turn(0.2 * t.sin(), 0.0, 0.1 * (2.0 * t).cos());
            [root, turn(0.5, 0.4, -0.2) * turn(0.4 * t.sin(), 0.3 * t.cos(), 0.2 * (3.0 * t).sin())]
        };
        (0..400).flat_map(frame).collect()
    }

    fn largest(a: &[UnitQuaternion<f64>], b: &[UnitQuaternion<f64>]) -> f64 {
        a.iter().zip(b).map(|(a, b)| a.angle_to(b)).fold(0.0, f64::max)
    }

    #[test]
    fn an_offset_is_found_and_survives_the_pack() {
        let source = source();
        let by = [turn(0.3, 0.0, 0.1), turn(-0.2, 0.5, 0.7)];
        let target: Vec<_> = source.iter().zip(by.iter().cycle()).map(|(q, by)| q * by).collect();
        let turns = Turns::fit(&source, &target, 2);
        // The root's offset also turns what is its heading a little: its tilt is what counts.
        let found = turns.offset(&source);
        let joint = |rows: &[UnitQuaternion<f64>]| rows.iter().skip(1).step_by(2).copied().collect::<Vec<_>>();
        assert!(largest(&joint(&found), &joint(&target)) < 1e-9);
        let up = |rows: &[UnitQuaternion<f64>]| -> Vec<Vector3<f64>> {
            rows.iter().step_by(2).map(|q| q.inverse() * Vector3::y()).collect()
        };
        let apart =
            |a: &[UnitQuaternion<f64>]| up(a).iter().zip(up(&target)).map(|(a, b)| a.angle(&b)).sum::<f64>() / 400.0;
        assert!(apart(&found) < 0.2 * apart(&source), "{} {}", apart(&found), apart(&source));
        let kept = Turns::from_numbers(&turns.numbers(), 2).unwrap();
        assert!(largest(&kept.offset(&source), &found) < 1e-6);
        assert!(largest(&kept.affine(&source), &turns.affine(&source)) < 1e-6);
        assert_eq!(Turns::from_numbers(&turns.numbers(), 3), None);
        assert_eq!(Turns::from_numbers(&[], 2), None);
    }

    #[test]
    fn an_affine_map_of_rotation_vectors_is_found() {
        let source = source();
        let means = [UnitQuaternion::identity(), turn(0.1, -0.6, 0.3)];
        let from = turn(0.5, 0.4, -0.2);
        let slope = Matrix3::new(0.5, 0.2, 0.0, -0.3, 1.2, 0.1, 0.0, 0.4, -0.7);
        let target: Vec<_> = source
            .as_chunks::<2>()
            .0
            .iter()
            .flat_map(|[root, joint]| {
                let vector = (from.inverse() * joint).scaled_axis();
                [*root, means[1] * UnitQuaternion::from_scaled_axis(slope * vector)]
            })
            .collect();
        let turns = Turns::fit(&source, &target, 2);
        let (offset, affine) = (turns.offset(&source), turns.affine(&source));
        let joint = |rows: &[UnitQuaternion<f64>]| rows.iter().skip(1).step_by(2).copied().collect::<Vec<_>>();
        let error = largest(&joint(&affine), &joint(&target));
        assert!(error < 0.02, "{error} rad");
        assert!(largest(&joint(&offset), &joint(&target)) > 10.0 * error);
    }
}
