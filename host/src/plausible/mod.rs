//! Which strengths are plausible, found by playing them.

mod figures;

pub use figures::{Figures, Stand};
