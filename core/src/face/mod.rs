//! Strength of a facial expression: how strong is it, and which landmarks move by how much to change it.
//!
//! 68 landmarks in, an offset for each out (Chan, Shum, Wang, Yi, Wei, Ho 2019, the face part). The contour of the jaw says
//! how the head is turned: the nearest of a few clusters of head pose holds a ranking function (shape -> strength) and a
//! network (strength -> shape). The contour itself stays where it is.
//!
//! Landmarks are in the order of the iBUG 300-W scheme, in pixels or any other unit, x to the right and y *down*: 0-16 contour,
//! 17-26 brows, 27-35 nose, 36-47 eyes, 48-67 mouth.

mod frame;
mod model;
mod step;

pub use frame::{FaceFrame, INNER, Shape};
pub use model::FaceSynth;
pub use step::{FaceState, Reading};

/// Landmarks of a face.
pub const POINTS: usize = 68;
/// Landmarks of the contour, the first ones.
pub const CONTOUR: usize = 17;
/// Landmarks that an expression moves: eyes with brows 11 and 11, nose 9, mouth 18.
pub const MOVING: usize = 49;
/// Numbers of a shape.
pub const FEATURES: usize = 2 * MOVING;

/// The landmarks of a face, `[x, y]`.
pub type Landmarks = [[f32; 2]; POINTS];
