//! What is done with hostile bytes: one function a target. None may panic, hang or ask for memory without bound, whatever the
//! bytes are.
//!
//! libFuzzer calls them (`./ci.sh fuzz`), and so does `tests/tests/fuzz.rs`, which includes this file and runs the corpus and
//! all that was ever found.

mod clips;
mod engines;
mod frames;
mod machines;
mod packs;
mod robots;

pub use clips::{bvh, csv, fbx, gltf, map};
pub use machines::{limbs, moves, robot, servos};
pub use packs::pack;
pub use robots::urdf;
