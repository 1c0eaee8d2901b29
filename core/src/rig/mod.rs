//! The rig: a machine or a body as a vector of coordinates, and the two ways in and out of it.
//!
//! | file | holds |
//! |---|---|
//! | `rotation` | rotation vectors of quaternions, and back |
//! | `joint` | [`JointKind`], the coordinates of one joint's rotation |
//! | `frame` | [`Frame`]: all coordinates of one moment |
//! | `model` | [`Rig`]: a checked view of the pack's tables |
//! | `convert` | pose -> frame, frame -> pose |
//! | `reach` | how far a body may be carried from where its source stands |
//!
//! # Coordinates
//!
//! A joint has up to three coordinates: a *hinge* one angle, rad; a *chain* of hinges two or three; a *ball* the rotation vector
//! from its reference, rad; a *slider* one length, m; a *fixed* joint none. Engines, mixes and limits work on coordinates alone.
//! A robot whose servos are its coordinates never meets a quaternion.
//!
//! # Rows
//!
//! Coordinates stand in rows of three, joints in order. A ball or a chain begins a row of its own. Hinges and sliders fill rows one
//! after the other, so that the servos of a limb share a row. What is left of a row is 0.
//!
//! A rig that *travels* (a body that walks) has one more row, the first: `[travel to the left, height, travel forward]` of the
//! root, m; travel is per frame, in the direction of the heading. Joint 0 is then turned against the heading, not against the
//! world. Heading and place on the ground are beside the coordinates, since no engine may depend on them.

mod convert;
mod frame;
mod joint;
mod model;
mod reach;
mod rotation;

pub use convert::Drift;
pub use frame::Frame;
pub use joint::JointKind;
pub use model::Rig;
pub use reach::REACH;
pub(crate) use reach::carried;
pub use rotation::{exp, log};
