//! Asynchronous blending: mechanics and expression pass from one motion to another in windows of their own (Boehs 2017).

use nalgebra::UnitQuaternion;

use super::decouple::Decoupled;
use crate::pose::{Pose, nlerp, unit};

/// When a blend begins and ends, in frames or in seconds, whichever the caller counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    /// Until here the first motion alone.
    pub start: f32,
    /// From here the second alone; not after `start` makes a cut.
    pub end: f32,
}

impl Window {
    /// Weight of the second motion at a time, 0..1, with no jump in speed at either end.
    pub fn weight(&self, time: f32) -> f32 {
        let length = self.end - self.start;
        let part = if length > 0.0 { (time - self.start) / length } else { time - self.start + 1.0 };
        // A NaN counts as before the start.
        let x = if part > 0.0 { part.min(1.0) } else { 0.0 };
        x * x * (3.0 - 2.0 * x)
    }
}

/// The two windows of a blend.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blend {
    /// When the mechanics, with root and hips, pass over.
    pub mechanics: Window,
    /// When the expression passes over.
    pub expressive: Window,
}

impl Blend {
    /// One frame of the blend of two decoupled streams at a time. The caller has brought the second one to where the first
    /// is: roots and hips are interpolated as they are. Cost: about 70 multiply-adds a joint.
    pub fn step<const JOINTS: usize>(
        &self,
        time: f32,
        first: &Decoupled<JOINTS>,
        second: &Decoupled<JOINTS>,
        out: &mut Pose<JOINTS>,
    ) {
        let body = self.mechanics.weight(time);
        let expression = self.expressive.weight(time);
        out.root = first.mechanics.root + (second.mechanics.root - first.mechanics.root) * body;
        let bodies = first.mechanics.rotations.iter().zip(&second.mechanics.rotations);
        let expressions = first.expressive.iter().zip(&second.expressive);
        for ((rotation, (body_a, body_b)), (a, b)) in out.rotations.iter_mut().zip(bodies).zip(expressions) {
            let mechanics: UnitQuaternion<f32> = nlerp(body_a, body_b, body);
            *rotation = unit((nlerp(a, b, expression) * mechanics).into_inner());
        }
    }
}
