//! Everything that runs in a frame as one type with one step: engines -> mix -> limit.
//!
//! | stage | what goes on to the next |
//! |---|---|
//! | guard | sound source frames; while there is none the engines stand still, so no NaN gets into their filters |
//! | engines | those that are there, each on the source frame: body mechanics modulated, style translated, style components; and the motion that plays at an emotion's strength, which looks at no frame |
//! | mix | the weighted mean of what they give |
//! | limit | a pose within the joints' limits, whatever came before: [`limit`](crate::limit) |
//!
//! Strengths, masks and weights may change at any frame, and the pipeline itself may be another one (another style, same
//! skeleton) with the same state after [`PipelineState::change_model`]: the limiter carries position and speed across, so nothing
//! jumps. An engine that gives a pose that is not sound, because somebody set its strength to NaN, is reset and counted, and the
//! others go on.
//!
//! A further engine is: a field of [`Pipeline`] and of [`PipelineState`], a weight, and six lines in `step.rs`.

mod mix;
mod model;
mod state;
mod step;

pub use mix::{Mix, Weights};
pub use model::Pipeline;
pub use state::PipelineState;
