//! What a description says of how its links look.

use nalgebra::{Isometry3, Vector3};

/// One solid of a link.
#[derive(Clone, Debug, PartialEq)]
pub struct Shape {
    /// The link.
    pub link: String,
    /// Its frame in the link's.
    pub at: Isometry3<f64>,
    /// What it is.
    pub form: Form,
    /// Red, green, blue, 0 to 1, where they are given.
    pub colour: Option<[f64; 3]>,
}

/// What a solid is; lengths in m. Axes are Z, middles the origin.
#[derive(Clone, Debug, PartialEq)]
pub enum Form {
    /// Whole lengths of its edges.
    Cuboid(Vector3<f64>),
    /// Half lengths of its axes; a sphere has three equal ones.
    Ellipsoid(Vector3<f64>),
    /// Radius, and whole length.
    Cylinder(f64, f64),
    /// Radius, and length of the cylinder between its round ends.
    Capsule(f64, f64),
    /// A file as the description names it, and what its coordinates are multiplied with.
    Mesh(String, Vector3<f64>),
}
