//! Limits of all four kinds on the made gait's skeleton, and the check that they are kept.
#![allow(dead_code, missing_docs, clippy::needless_range_loop, reason = "each test file uses a part")]

use kinesic::Pose;
use kinesic::limit::{JointKind, LimitState, Limiter};
use kinesic_host::limit::{JointLimit, LimitsModel};
use nalgebra::Vector3;

pub const JOINTS: usize = 19;

const X: [f32; 3] = [1.0, 0.0, 0.0];
const Y: [f32; 3] = [0.0, 1.0, 0.0];
const Z: [f32; 3] = [0.0, 0.0, 1.0];

/// Hips free, knees and elbows hinges, thighs and arms chains of servos, the rest balls.
pub fn limits() -> LimitsModel {
    let mut model = LimitsModel::free("robot", 60.0, JOINTS, 6.0, 60.0);
    for (joint, limit) in model.joints.iter_mut().enumerate().skip(1) {
        *limit = match joint {
            2 | 6 => JointLimit::hinge(X, [-0.1, 2.3], 9.0, 110.0),
            14 | 17 => JointLimit::hinge(X, [-2.4, 0.2], 9.0, 110.0),
            1 | 5 | 13 | 16 => JointLimit::chain([X, Y, Z], [-1.6, -0.8, -0.9], [1.3, 0.8, 1.0], 7.0, 90.0),
            _ => JointLimit::ball([Y, Z, X], [-0.7, -0.5, -0.6], [0.7, 0.5, 0.9], 5.0, 60.0),
        };
    }
    // A joint whose zero is not the pose of no rotation.
    model.joints[13].neutral = [0.0, 0.0, 0.382_683_43, 0.923_879_5];
    model
}

/// Steps of the coordinates, of the root and of the hips' rotation.
type Steps = (Vec<[f32; 3]>, Vector3<f32>, Vector3<f32>);

/// Where everything was in the last two frames.
#[derive(Clone, Debug, Default)]
pub struct Watch {
    last: Option<(Vec<[f32; 3]>, Pose<JOINTS>)>,
    went: Option<Steps>,
    /// Largest excess over a rate's step so far, rad or m.
    pub excess: f32,
}

impl Watch {
    /// From a state that stands still.
    pub fn new(limiter: &Limiter<'_, JOINTS>, state: &LimitState<JOINTS>) -> Self {
        let mut watch = Self::default();
        watch.check(limiter, state, &state.pose().clone(), "start");
        watch
    }

    /// Every bound of every coordinate, after any input. Positions hold exactly; rates to the rounding of the position.
    pub fn check(&mut self, limiter: &Limiter<'_, JOINTS>, state: &LimitState<JOINTS>, out: &Pose<JOINTS>, what: &str) {
        let (table, time) = (limiter.table(), 1.0 / 60.0f32);
        let angles: Vec<[f32; 3]> = (0..JOINTS).map(|joint| state.angles(joint)).collect();
        let at = out.root;
        assert!(at.iter().all(|x| x.is_finite()), "{what}: root {at}");
        for (joint, q) in out.rotations.iter().enumerate() {
            assert!((q.coords.norm() - 1.0).abs() < 1e-5, "{what}: joint {joint} {q}");
            let used = JointKind::from_code(table.kinds[joint]).unwrap().coordinates();
            for axis in 0..used {
                let x = angles[joint][axis];
                let range = table.lower[joint][axis]..=table.upper[joint][axis];
                assert!(range.contains(&x), "{what}: joint {joint} axis {axis} at {x}, not in {range:?}");
            }
        }
        let (mut went, mut travel, mut turned) = (vec![[0.0; 3]; JOINTS], Vector3::zeros(), Vector3::zeros());
        if let Some((before, pose)) = self.last.take() {
            travel = at - pose.root;
            turned = turn(&pose, out);
            let scale = 4.0 * f32::EPSILON * at.norm().max(1.0);
            self.rate(travel.norm(), limiter.meta().root_velocity * time, scale, what, "root velocity");
            self.rate(turned.norm(), table.velocity[0][0] * time, 5e-6, what, "hips' velocity");
            for joint in 0..JOINTS {
                for axis in 0..3 {
                    went[joint][axis] = angles[joint][axis] - before[joint][axis];
                    let most = table.velocity[joint][axis] * time;
                    self.rate(went[joint][axis].abs(), most, 2e-6, what, "velocity");
                }
            }
            if let Some((old, old_travel, old_turned)) = self.went.take() {
                let most = limiter.meta().root_acceleration * time * time;
                self.rate((travel - old_travel).norm(), most, 2.0 * scale, what, "root acceleration");
                let most = table.acceleration[0][0] * time * time;
                self.rate((turned - old_turned).norm(), most, 1e-5, what, "hips' acceleration");
                for joint in 0..JOINTS {
                    for axis in 0..3 {
                        let most = table.acceleration[joint][axis] * time * time;
                        let change = (went[joint][axis] - old[joint][axis]).abs();
                        self.rate(change, most, 2e-6, what, "acceleration");
                    }
                }
            }
        }
        // The first is standing still.
        self.went = Some((went, travel, turned));
        self.last = Some((angles, *out));
    }

    fn rate(&mut self, found: f32, most: f32, rounding: f32, what: &str, which: &str) {
        self.excess = self.excess.max(found - most);
        assert!(found <= most + rounding, "{what}: {which} {found} a frame, at most {most}");
    }
}

/// Rotation vector of the hips' turn in a frame, in double precision.
fn turn(from: &Pose<JOINTS>, to: &Pose<JOINTS>) -> Vector3<f32> {
    let turn = to.rotations[0].cast::<f64>() * from.rotations[0].cast::<f64>().inverse();
    turn.scaled_axis().cast()
}

/// A host pose with the capacity of the robot.
pub fn small<const MOST: usize>(pose: &Pose<MOST>) -> Pose<JOINTS> {
    let mut small = Pose::identity();
    small.root = pose.root;
    small.rotations.copy_from_slice(&pose.rotations[..JOINTS]);
    small
}
