//! Contact sheets and short films of motions: stick figures of bodies and of robots.
//!
//! | file | holds |
//! |---|---|
//! | `actor` | [`Actor`]: a clip as figures, turned to face the viewer, on the ground |
//! | `view` | [`View`]: from where figures are seen |
//! | `layout` | [`sheet`], [`Film`]: figures in cells, with names, times and the ground |
//! | `drawing` | [`Drawing`]: lines, discs and texts; as SVG |
//! | `raster` | a drawing as pixels |
//! | `glyphs` | letters made of lines |
//! | `encode` | PNG, GIF and animated PNG |

mod actor;
mod drawing;
mod encode;
mod glyphs;
mod layout;
mod raster;
mod view;

pub use actor::Actor;
pub use drawing::Drawing;
pub use encode::{EncodeError, Moving, animation, png};
pub use layout::{Film, LayoutError, sheet};
pub use view::View;
