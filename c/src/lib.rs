//! C interface of kinesic. The header `include/kinesic.h` is made of this crate by `./ci.sh header`.
//!
//! Everything is the caller's: there is no heap and no hidden state. A model borrows the pack's bytes, which must stay where they
//! are, aligned to 16. After a successful load nothing can fail. Functions take valid pointers or null; with a null pointer a load
//! returns `KINESIC_STATUS_NULL`, and everything else does nothing.
#![no_std]

mod components;
mod mechanics;
mod pipeline;
mod playing;
mod pose;
mod status;
mod storage;
mod translator;

pub use components::*;
pub use mechanics::*;
pub use pipeline::*;
pub use pose::*;
pub use status::*;
pub use translator::*;

/// Joints that a pose holds; a pack with more is refused.
pub const KINESIC_JOINTS: usize = 32;
/// Rows of coordinates, three to a row: that of the root, and one per joint.
pub const KINESIC_ROWS: usize = 33;
/// Filter states of a translator, and its principal coordinates.
pub const KINESIC_STATES: usize = 1280;
/// Style components.
pub const KINESIC_COMPONENTS: usize = 64;
/// Units of the hidden layer and the code of body mechanics together.
pub const KINESIC_UNITS: usize = 600;
/// Frames of memory of body mechanics: a third of the frame rate.
pub const KINESIC_WINDOW: usize = 20;

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    // Core has no road to here; `firmware-sim` proves it by the symbols of its images.
    loop {}
}
