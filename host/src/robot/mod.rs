//! Robots: what a description says of their joints.
//!
//! | file | holds |
//! |---|---|
//! | `description` | [`Robot`]: joints in a tree, in the frame of the root link |
//! | `urdf` | [`Robot::parse`]: from a URDF |
//! | `error` | [`RobotError`]: place, what was found, what to do |

mod description;
mod error;
mod urdf;

pub use description::{Mimic, Motion, Robot, RobotJoint};
pub use error::RobotError;
