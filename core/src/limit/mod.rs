//! The last stage of every pipeline: what leaves it never exceeds the joints' limits, whatever comes in.
//!
//! | file | holds |
//! |---|---|
//! | `guard` | which frames are quarantined: missing, not finite, not unit, far away, frozen |
//! | `chart` | a joint's rotation as up to three coordinates, rad, and back |
//! | `axis` | one coordinate: position, velocity and acceleration limits, with braking distance |
//! | `free` | a vector without position limits: the root's position, rotations of free joints |
//! | `model` | [`Limiter`]: a checked view of the tables |
//! | `state`, `step` | what it remembers and reports; one frame |
//!
//! # The joints
//!
//! Every joint has a [`JointKind`]: a *hinge* (one servo), a *chain* of two or three hinges at right angles (the servos of a
//! shoulder, or Euler angles in any order), a *ball* (swing and twist, for animation), or *free* (the root: rates only).
//! Limits hold for the coordinates: angles of hinges, twist and the two components of the swing's rotation vector.
//!
//! # What is guaranteed
//!
//! For every coordinate `x` of one frame and `w` of the one before, after any sequence of inputs, NaN and missing frames included:
//!
//! 1. `lower <= x <= upper`, always and exactly.
//! 2. `|x' - x| <= velocity dt`, to the rounding of `x`, as long as 1 allows.
//! 3. `|(x'' - x') - (x' - x)| <= acceleration dt^2`, to the rounding of `x`, as long as 1 and 2 allow.
//!
//! A coordinate only goes as fast as it can brake before its bound, so with one table all three hold at once, always: the
//! reachable speed is the exact discrete one, `D(w) = (n + 1) w - n (n + 1) / 2 u <= room` with `u = acceleration dt^2`,
//! `n = floor(w / u)`. They conflict only where the limits change while a joint moves (another pack, same state): then 1 wins over
//! 2, and 2 over 3. Motion that is itself within the limits passes to rounding. Rates of free joints and of the root hold for
//! the norm of the angular velocity and of the velocity.

mod axis;
mod chart;
mod free;
mod guard;
mod model;
mod state;
mod step;

pub use guard::{Fault, Guard};
pub use model::{JointKind, LimitTable, Limiter};
pub use state::{Clamped, LimitReport, LimitState};
