//! The last stage: what leaves it never exceeds the coordinates' limits, whatever comes in.
//!
//! | file | holds |
//! |---|---|
//! | `axis` | [`Plain`]: one coordinate: position, velocity and acceleration limits, with braking distance |
//! | `smooth` | [`Smooth`]: one coordinate with a jerk limit beside them: which step it makes |
//! | `stop`, `land` | plans to stop within all four; ways that end on the target |
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
//! 4. The difference of two of the differences in 3 is at most `jerk dt^3`, to the rounding of `x`, for a coordinate that has a jerk limit.
//!
//! A coordinate only goes as fast as it can brake before its bound, so with one table 1 to 3 hold at once, always: the
//! reachable speed is the exact discrete one, `D(w) = (n + 1) w - n (n + 1) / 2 u <= room` with `u = acceleration dt^2`,
//! `n = floor(w / u)`.
//!
//! With a jerk limit a stop takes its time, so every step leaves a plan behind: whole numbers of frames in which the acceleration goes to a
//! middle value, stays there, and goes to 0, and with it the speed, within all four bounds. A step that leaves no such plan is not made; the plan of
//! the step before goes on instead, and what is left of a plan is a plan. So all four hold by induction, whatever the target does. A target that jumps and
//! stands is reached exactly, in the time of the fastest motion within the limits and two frames, without overshoot.
//!
//! The guarantees conflict only where the limits change while a joint moves (another pack, same state): then 1 wins over
//! 2, and 2 over 3. With a jerk limit a new velocity or acceleration that is less than the coordinate's own is reached by its plan to stop, and a coordinate that is put back to
//! a new bound stands there at once. Motion that is itself within the limits passes to rounding. Rates of the root's travel hold for the
//! norm of its velocity and have no jerk limit; travel and heading have no position limits.

mod axis;
mod free;
mod land;
mod model;
mod smooth;
mod state;
mod step;
mod stop;

pub use axis::{Axis, Plain, stop_frames};
pub use model::{LONGEST_STOP, LimitTable, Limiter, LimiterOf, STEPS, SmoothLimiter};
pub use smooth::Smooth;
pub use state::{Clamped, LimitReport, LimitState, LimitStateOf, SmoothLimitState};
