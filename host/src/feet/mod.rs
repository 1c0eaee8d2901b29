//! Feet: when they stand, how far they slide, whether they keep step, and how they are held where they stand.
//!
//! | file | holds |
//! |---|---|
//! | `contacts` | [`Foot`], when it stands |
//! | `measure` | [`Feet`]: slide, cadence, and whether a result keeps step with its source |
//! | `lock` | [`lock`]: a styled clip whose feet stand where those of its source do |
//! | `knee` | [`keep_knees`]: knees that a change would bend backwards |
//! | `live` | [`live`]: the same as the device does it, which does not look ahead |
//! | `leg` | the two bones of a leg, bent so that the ankle reaches a place |

mod contacts;
mod knee;
mod leg;
mod live;
mod lock;
mod measure;

pub use contacts::Foot;
pub use knee::keep_knees;
pub use live::live;
pub use lock::{Hold, lock};
pub use measure::{Feet, IN_STEP, OUT_OF_STEP, kept_step};
