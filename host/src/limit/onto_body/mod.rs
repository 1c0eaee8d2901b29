//! Limits of a body's joints from a robot's description ([`crate::robot`]): a map says which of its joints are which of the skeleton's.
//!
//! | file | holds |
//! |---|---|
//! | `map` | [`RobotMap`]: robot joints of each skeleton joint, and what a URDF does not say |
//! | `zero_pose` | how the skeleton stands when all of the robot's angles are zero |
//! | `rows` | what each robot joint may do, for its followers too |
//! | `import` | both together: [`import()`] |
//!
//! # The geometry
//!
//! A robot joint turns everything beyond it about its axis `w`, root link's frame, all angles zero. Robot joints in a row turn it by
//! `exp(w1 a1) exp(w2 a2) ...`. With `G` the rotation of the skeleton's joint in the pose in which the robot's angles are zero, and
//! `P` its parent's, the joint's local rotation is `P^-1 exp(w1 a1) exp(w2 a2) G = (P^-1 G) exp(G^-1 w1 a1) exp(G^-1 w2 a2)`: a chain
//! with `reference = P^-1 G` and axes `G^-1 w`.

mod import;
mod map;
mod rows;
mod zero_pose;

pub use import::{Import, Rates, import};
pub use map::{Entry, MapKind, RobotMap};

use kinesic::rig::JointKind;

/// Name of a kind in maps and tables.
pub fn kind_name(kind: JointKind) -> &'static str {
    match kind {
        JointKind::Fixed => "fixed",
        JointKind::Hinge => "hinge",
        JointKind::Chain => "chain",
        JointKind::Ball => "ball",
        JointKind::Slider => "slider",
    }
}
