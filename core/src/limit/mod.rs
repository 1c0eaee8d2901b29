//! The last stage: what leaves it never exceeds the coordinates' limits, whatever comes in.
//!
//! | file | holds |
//! |---|---|
//! | `axis` | one coordinate: position, velocity and acceleration limits, with braking distance |
//! | `free` | a vector without position limits: the root's way over the ground |
//! | `model` | [`Limiter`]: a checked view of the tables |
//! | `state`, `step` | what it remembers and reports; one frame |
//!
//! Limits hold for [coordinates](crate::rig): angles of hinges, lengths of sliders, components of a ball's rotation vector, height of the root.
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
//! 2, and 2 over 3. Motion that is itself within the limits passes to rounding. Rates of the root's travel hold for the
//! norm of its velocity; travel and heading have no position limits.

mod axis;
mod free;
mod model;
mod smooth;
mod state;
mod step;
mod stop;

pub use model::{LimitTable, Limiter};
pub use state::{Clamped, LimitReport, LimitState};
