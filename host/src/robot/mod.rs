//! Robots: what a description says of their joints.
//!
//! | file | holds |
//! |---|---|
//! | `description` | [`Robot`]: joints in a tree, in the frame of the root link |
//! | `urdf` | [`Robot::read`], [`Robot::parse`]: from a URDF |
//! | `mjcf` | the same from an MJCF (MuJoCo) |
//! | `shape` | [`Shape`]: what a description says of how its links look |
//! | `look` | what is drawn of a machine: its links in motion, their solids, meshes read from files |
//! | `servos` | [`ServoTable`]: ids, units, zeros, bounds of servos |
//! | `machine` | [`Machine`]: a robot as packs hold it: rig, limits, servos |
//! | `keys` | keys of TOML tables and maps |
//! | `bounds` | what one joint of a machine may do, checked |
//! | `packed` | the robot of a pack as a [`Robot`] |
//! | `retarget` | a person's motion on a robot, within its limits |
//! | `motion` | a motion in the numbers of a file -> coordinates -> what the servos take |
//! | `positions` | where its joints are while it moves |
//! | `error` | [`RobotError`]: place, what was found, what to do |

mod bounds;
mod description;
mod error;
pub(crate) mod keys;
pub mod look;
mod machine;
mod mjcf;
mod motion;
mod packed;
mod positions;
pub mod retarget;
mod servos;
mod shape;
mod urdf;

pub use description::{Mimic, Motion, Robot, RobotJoint};
pub use error::RobotError;
pub use machine::{Defaults, Machine, Servo};
pub use motion::MotionError;
pub use servos::{POSE, PoseEntry, ServoEntry, ServoTable};
pub use shape::{Form, Shape};
