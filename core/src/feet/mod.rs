//! Feet held where they stand, frame by frame: behind a [`Pipeline`](crate::Pipeline), for whoever asks for it.
//!
//! | file | holds |
//! |---|---|
//! | `model` | [`Feet`]: the legs of a pack's skeleton |
//! | `state` | [`FeetState`]: what is remembered of each foot, and of the root |
//! | `step` | one frame: which foot stands, what the root and the legs make of it |
//! | `leg` | the two bones of a leg, bent so that the ankle is moved |
//!
//! A style changes steps, so a foot that stands in the source slides in the result. First the root goes as the feet that stand want it; what is
//! left is the legs' part. Both are blended in where a foot of the source comes to stand, and out where it leaves. Nothing looks ahead.

mod leg;
mod model;
mod state;
mod step;

pub use model::Feet;
pub use state::FeetState;
