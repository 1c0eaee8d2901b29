//! The body's heading: the frame in which a motion looks the same wherever it goes.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use crate::kernel::{quadrant_angle, sqrt};

use super::skeleton::Across;
use super::{Skeleton, World, unit};

/// Direction in which the body faces, as a rotation about the vertical.
///
/// The *heading-local* frame has its origin on the ground below the root, Y up and Z forward.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Heading {
    sin: f32,
    cos: f32,
}

impl Default for Heading {
    fn default() -> Self {
        Self::FORWARD
    }
}

impl Heading {
    /// Facing +Z.
    pub const FORWARD: Self = Self { sin: 0.0, cos: 1.0 };

    /// True if it is a direction.
    pub(crate) fn is_sound(self) -> bool {
        (0.9..1.1).contains(&(self.sin * self.sin + self.cos * self.cos))
    }

    /// Heading of a pose: square to the horizontal part of the right-to-left axes (the hips, in most packs).
    ///
    /// Where these axes are vertical or of no length, `self` is kept: a body keeps its heading through a cartwheel.
    pub fn follow<const JOINTS: usize>(self, skeleton: &Skeleton, world: &World<JOINTS>) -> Self {
        self.square_to(across(skeleton.across, &world.positions))
    }

    /// Heading of a body whose right-to-left axis is `across`, world. Where that is vertical or of no length, `self` is kept.
    pub fn square_to(self, across: Vector3<f32>) -> Self {
        let (x, z) = (across.x, across.z);
        let norm = sqrt(x * x + z * z);
        // Forward is across x up: (-z, x) in the ground plane.
        if norm <= 1e-3 || norm.is_nan() {
            return self;
        }
        let inverse = 1.0 / norm;
        Self { sin: -z * inverse, cos: x * inverse }
    }

    /// From the world's axes to the heading's.
    pub fn to_local(self, v: Vector3<f32>) -> Vector3<f32> {
        Vector3::new(self.cos * v.x - self.sin * v.z, v.y, self.sin * v.x + self.cos * v.z)
    }

    /// From the heading's axes to the world's.
    pub fn to_world(self, v: Vector3<f32>) -> Vector3<f32> {
        Vector3::new(self.cos * v.x + self.sin * v.z, v.y, self.cos * v.z - self.sin * v.x)
    }

    /// This heading turned by an angle with this sine and cosine, to the left.
    pub fn turned(self, sin: f32, cos: f32) -> Self {
        let (s, c) = (self.sin * cos + self.cos * sin, self.cos * cos - self.sin * sin);
        let norm = sqrt(s * s + c * c);
        if norm <= 1e-3 || norm.is_nan() {
            return self;
        }
        let inverse = 1.0 / norm;
        Self { sin: s * inverse, cos: c * inverse }
    }

    /// Sine and cosine of the turn from `before` to `self`.
    pub fn turn_from(self, before: Self) -> [f32; 2] {
        [self.sin * before.cos - self.cos * before.sin, self.cos * before.cos + self.sin * before.sin]
    }

    /// Angle of the turn from `before` to `self`, -pi..pi, to the left.
    pub(crate) fn angle_from(self, before: Self) -> f32 {
        let [sin, cos] = self.turn_from(before);
        let angle = quadrant_angle(sin.abs(), cos.abs(), 1.0);
        let angle = if cos < 0.0 { core::f32::consts::PI - angle } else { angle };
        if sin < 0.0 { -angle } else { angle }
    }

    /// The heading as a rotation about the vertical.
    pub fn rotation(self) -> UnitQuaternion<f32> {
        // tan(a / 2) = sin / (1 + cos) = (1 - cos) / sin: the larger pair, so that nothing cancels.
        let (w, y) = if self.cos >= 0.0 { (1.0 + self.cos, self.sin) } else { (self.sin, 1.0 - self.cos) };
        unit(Quaternion::new(w, 0.0, y, 0.0))
    }

    /// Horizontal unit vector in the direction of the heading, world axes.
    pub fn forward(self) -> Vector3<f32> {
        Vector3::new(self.sin, 0.0, self.cos)
    }
}

/// Heading-local position of every joint, m: origin on the ground below the root, Y up, Z forward. The root's is
/// `[0, height, 0]`. Rows past the skeleton's joints are zero. Cost: 4 multiply-adds a joint.
pub fn local_positions<const JOINTS: usize>(
    skeleton: &Skeleton,
    world: &World<JOINTS>,
    heading: Heading,
) -> [[f32; 3]; JOINTS] {
    let mut local = [[0.0; 3]; JOINTS];
    let ground = world.positions.first().map_or_else(Vector3::zeros, |root| Vector3::new(root.x, 0.0, root.z));
    for (local, position) in local.iter_mut().zip(&world.positions).take(skeleton.joints()) {
        *local = heading.to_local(position - ground).into();
    }
    local
}

fn across(pairs: Across, positions: &[Vector3<f32>]) -> Vector3<f32> {
    let mut sum = Vector3::zeros();
    for [left, right] in pairs {
        if let (Some(left), Some(right)) = (positions.get(*left as usize), positions.get(*right as usize)) {
            sum += left - right;
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn left_at_plus_x_faces_plus_z() {
        let skeleton = Skeleton::new(&[0, 0, 0], &[[0.0; 3]; 3], &[[1, 2]]).unwrap();
        let mut world = World::<3>::identity();
        world.positions[1].x = 0.1;
        world.positions[2].x = -0.1;
        let heading = Heading::default().follow(&skeleton, &world);
        assert_eq!(heading.forward(), Vector3::z());
        // A quarter turn to the left: the left hip is at -Z, forward is +X.
        world.positions[1] = Vector3::new(0.0, 0.0, -0.1);
        world.positions[2] = Vector3::new(0.0, 0.0, 0.1);
        let heading = heading.follow(&skeleton, &world);
        assert_eq!(heading.forward(), Vector3::x());
        assert_eq!(heading.to_local(heading.forward()), Vector3::z());
        let v = Vector3::new(1.0, 2.0, 3.0);
        assert_eq!(heading.to_world(heading.to_local(v)), v);
        assert!((heading.rotation() * v - heading.to_world(v)).norm() < 1e-5);
        let [sin, cos] = heading.turn_from(Heading::default());
        assert_eq!(Heading::default().turned(sin, cos), heading);
        let back = heading.turned(sin, cos);
        assert!((back.rotation() * v - back.to_world(v)).norm() < 1e-5);
        // Hips one above the other say nothing: the heading stays.
        world.positions[1] = Vector3::new(0.0, 0.2, 0.0);
        world.positions[2] = Vector3::zeros();
        assert_eq!(heading.follow(&skeleton, &world), heading);
    }
}
