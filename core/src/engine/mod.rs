//! The seam: what makes a frame from a frame, and how such engines are put together.
//!
//! An [`Engine`] is an immutable model; what it remembers is a state of its own, owned by the caller. Engines are put together by
//! types, so that what is not used is neither linked nor stored:
//!
//! | type | does |
//! |---|---|
//! | `(A, B)`, `(A, B, C)`, `(A, B, C, D)` | one after the other |
//! | [`Mix<(A, B)>`](Mix) | side by side, their weighted mean |
//! | `Option<A>` | `A` if it is there |
//! | [`live::Live`] | whatever the pack has |
//! | [`Pipeline<E, ROWS>`](Pipeline) | `E` between pose and pose, bad frames kept out |

mod chain;
mod controls;
mod guard;
pub mod live;
mod mix;
mod pipeline;

pub use controls::Controls;
pub use guard::{Fault, Guard};
pub use mix::{Mix, MixState};
pub use pipeline::{Pipeline, PipelineState};

use crate::model::{LoadError, Pack};
use crate::rig::Frame;

/// Something that makes a frame of coordinates from a frame of coordinates.
///
/// # What every engine keeps
///
/// - `step` never fails, allocates or panics, and every loop has a length fixed at load time.
/// - A sound frame stays sound, whatever came before: see [`Frame::is_sound`]. A frame that is not sound leaves the state sound.
/// - `heading` and `ground` are left alone by all engines but limits.
pub trait Engine<const ROWS: usize> {
    /// What it remembers from frame to frame. The default is at rest.
    type State: Default;

    /// True for an engine that stands where the machine does: in series it starts from the frame itself, not from what engines before it
    /// make of it. A tuple within a tuple starts as a whole from what is made.
    const STANDS: bool = false;

    /// Puts the state where it would be had `frame` always been held.
    fn start(&self, state: &mut Self::State, frame: &Frame<ROWS>);

    /// One frame, in place.
    fn step(&self, state: &mut Self::State, frame: &mut Frame<ROWS>);

    /// No frame came. `frame` is the last one that went out, standing still; what is in it afterwards goes out. Most engines hold.
    fn idle(&self, state: &mut Self::State, frame: &mut Frame<ROWS>) {
        let _ = (state, frame);
    }
}

/// What can be loaded from a pack: engines, and what is put together of them.
pub trait FromPack<'a>: Sized {
    /// Every check that makes the steps infallible. An `Option` is `None` where the pack has no such model.
    fn from_pack(pack: &Pack<'a>) -> Result<Self, LoadError>;
}
