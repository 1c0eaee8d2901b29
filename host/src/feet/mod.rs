//! Feet: when they stand, how far they slide, whether they keep step, and how they are held where they stand.
//!
//! | file | holds |
//! |---|---|
//! | `contacts` | [`Foot`], when it stands |
//! | `measure` | [`Feet`]: slide, cadence, and whether a result keeps step with its source |
//! | `lock` | [`lock`]: a styled clip whose feet stand where those of its source do |
//! | `live` | [`live`]: the same as the device does it, which does not look ahead |
//! | `leg` | the two bones of a leg, bent so that the ankle reaches a place |

mod contacts;
mod leg;
mod live;
mod lock;
mod measure;

pub use contacts::Foot;
pub use live::live;
pub use lock::lock;
pub use measure::{Feet, IN_STEP, OUT_OF_STEP, kept_step};
