//! Limits of all kinds of joints on the made gait's skeleton, and the check that they are kept.
#![allow(dead_code, missing_docs, reason = "each test file uses a part")]

use kinesic::limit::Limiter;
use kinesic::{Frame, Pose};
use kinesic_host::clip::JointMap;
use kinesic_host::limit::{JointLimit, LimitsModel, Tables};
use kinesic_host::rig::Rig;
use nalgebra::Vector3;

pub const JOINTS: usize = 19;

/// Capacity in rows of coordinates; the limits below have 18.
pub const ROWS: usize = 20;

/// Frames per second.
pub const RATE: f32 = 60.0;

const X: [f32; 3] = [1.0, 0.0, 0.0];
const Y: [f32; 3] = [0.0, 1.0, 0.0];
const Z: [f32; 3] = [0.0, 0.0, 1.0];

/// The made gait's skeleton, every joint a ball.
pub fn rig() -> Rig {
    let skeleton = kinesic_host::gait::skeleton();
    Rig::new(&skeleton, &JointMap::detect(&skeleton).unwrap()).unwrap()
}

/// Hips free; knees, ankles and elbows hinges, of which knee and ankle share a row; thighs and arms chains of servos; the rest balls.
pub fn limits() -> LimitsModel {
    let mut model = LimitsModel::free("robot", f64::from(RATE), &rig(), 6.0, 60.0);
    for (joint, limit) in model.joints.iter_mut().enumerate().skip(1) {
        *limit = match joint {
            2 | 6 => JointLimit::hinge(X, [-0.1, 2.3], 9.0, 110.0),
            3 | 7 => JointLimit::hinge(X, [-0.6, 0.9], 8.0, 80.0),
            14 | 17 => JointLimit::hinge(X, [-2.4, 0.2], 9.0, 110.0),
            1 | 5 | 13 | 16 => JointLimit::chain([X, Y, Z], [-1.6, -0.8, -0.9], [1.3, 0.8, 1.0], 7.0, 90.0),
            _ => JointLimit::ball([-0.7, -0.5, -0.6], [0.7, 0.5, 0.9], 5.0, 60.0),
        };
    }
    // A joint whose zero is not the pose of no rotation.
    model.joints[13].coordinates.reference = [0.0, 0.0, 0.382_683_43, 0.923_879_5];
    model
}

/// The tables of [`limits`].
pub fn tables() -> Tables {
    limits().tables(&rig()).unwrap()
}

/// Index of a joint's first coordinate.
pub fn first(limiter: &Limiter<'_, ROWS>, joint: usize) -> usize {
    limiter.rig().places().nth(joint).unwrap().1
}

/// Every limited coordinate of a rig, travel apart.
fn limited(limiter: &Limiter<'_, ROWS>) -> Vec<usize> {
    let height = limiter.rig().travels().then_some(1);
    let joints = limiter.rig().places().flat_map(|(kind, first)| first..first + kind.coordinates());
    height.into_iter().chain(joints).collect()
}

/// Steps of the coordinates, of the root over the ground (world), and of the heading.
#[derive(Clone, Debug)]
struct Steps {
    coordinates: Vec<f32>,
    travel: Vector3<f32>,
    turn: f32,
}

/// Where everything was in the last two frames.
#[derive(Clone, Debug)]
pub struct Watch {
    last: Frame<ROWS>,
    went: Steps,
    root: Option<Vector3<f32>>,
    /// How far off the source was in the last frame, m.
    ground: f32,
    /// Largest excess over a rate's step so far, rad or m.
    pub excess: f32,
}

impl Watch {
    /// From a frame that stands still.
    pub fn new(frame: &Frame<ROWS>) -> Self {
        let went = Steps { coordinates: vec![0.0; 3 * ROWS], travel: Vector3::zeros(), turn: 0.0 };
        Self { last: *frame, went, root: None, ground: 0.0, excess: 0.0 }
    }

    /// Every bound of every coordinate in what goes out, after any input. Positions hold exactly; rates to rounding.
    pub fn check(&mut self, limiter: &Limiter<'_, ROWS>, frame: &Frame<ROWS>, what: &str) {
        let (table, time) = (*limiter.table(), 1.0 / RATE);
        let of = |column: &[[f32; 3]], index: usize| column.as_flattened()[index];
        assert!(frame.is_sound(), "{what}: {frame:?}");
        let mut went = self.went.clone();
        for index in limited(limiter) {
            let x = frame.coordinates()[index];
            let range = of(table.lower, index)..=of(table.upper, index);
            assert!(range.contains(&x), "{what}: coordinate {index} at {x}, not in {range:?}");
            went.coordinates[index] = x - self.last.coordinates()[index];
            let change = (went.coordinates[index] - self.went.coordinates[index]).abs();
            self.rate(went.coordinates[index].abs(), of(table.velocity, index) * time, 2e-6, what, "velocity");
            self.rate(change, of(table.acceleration, index) * time * time, 2e-6, what, "acceleration");
        }
        if limiter.rig().travels() {
            let ([x, _, z], meta) = (frame.rows[0], limiter.meta());
            went.travel = frame.heading.to_world(Vector3::new(x, 0.0, z));
            let [sin, cos] = frame.heading.turn_from(self.last.heading);
            went.turn = sin.atan2(cos);
            let (root, heading) = ((went.travel - self.went.travel).norm(), (went.turn - self.went.turn).abs());
            self.rate(went.travel.norm(), meta.root_velocity * time, 1e-6, what, "root velocity");
            self.rate(root, meta.root_acceleration * time * time, 1e-6, what, "root acceleration");
            self.rate(went.turn.abs(), meta.heading_velocity * time, 2e-6, what, "heading velocity");
            self.rate(heading, meta.heading_acceleration * time * time, 2e-6, what, "heading acceleration");
        }
        (self.went, self.last) = (went, *frame);
    }

    /// The same of the pose: rotations of length one, and a root that goes as far as the frame's travel says, to the rounding of
    /// where source and root are and were.
    pub fn check_pose(&mut self, out: &Pose<JOINTS>, source: &Frame<ROWS>, what: &str) {
        for (joint, q) in out.rotations.iter().enumerate() {
            assert!((q.coords.norm() - 1.0).abs() < 1e-5, "{what}: joint {joint} {q}");
        }
        let ground = source.ground.iter().fold(0.0, |far: f32, x| far.max(x.abs()));
        let far = ground.max(std::mem::replace(&mut self.ground, ground));
        let rounding = 16.0 * f32::EPSILON * far.max(out.root.norm()).max(1.0);
        let rounding = rounding + self.root.map_or(0.0, |root| 16.0 * f32::EPSILON * root.norm());
        if let Some(root) = self.root.replace(out.root) {
            let step = Vector3::new(out.root.x - root.x, 0.0, out.root.z - root.z);
            let off = (step - self.went.travel).norm();
            assert!(off <= rounding, "{what}: the root goes {step}, the frame says {}, {off}", self.went.travel);
        }
    }

    fn rate(&mut self, found: f32, most: f32, rounding: f32, what: &str, which: &str) {
        self.excess = self.excess.max(found - most);
        assert!(found <= most + rounding, "{what}: {which} {found} per frame, at most {most}");
    }
}

/// A host pose with the capacity of the robot.
pub fn small<const MOST: usize>(pose: &Pose<MOST>) -> Pose<JOINTS> {
    let mut small = Pose::identity();
    small.root = pose.root;
    small.rotations.copy_from_slice(&pose.rotations[..JOINTS]);
    small
}
