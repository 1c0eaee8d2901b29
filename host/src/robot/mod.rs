//! Robots: what a description says of their joints, and how they take a person's motion.
//!
//! | file | holds |
//! |---|---|
//! | `description` | [`Robot`]: joints in a tree, in the frame of the root link |
//! | `read` | [`Robot::read`], [`Robot::parse`]: from a URDF or an MJCF, told by the root element |
//! | `urdf`, `mjcf`, `xml` | the two readers, and what they share |
//! | [`retarget`] | a person's motion on a robot: inverse kinematics of the whole chain within its limits |
//! | `error` | [`RobotError`]: place, what was found, what to do |

mod description;
mod error;
mod mjcf;
mod read;
pub mod retarget;
mod urdf;
mod xml;

pub use description::{Mimic, Motion, Robot, RobotJoint};
pub use error::RobotError;
