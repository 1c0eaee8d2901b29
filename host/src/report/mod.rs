//! Reports: one self-contained HTML page of what a training did, to open from disk.
//!
//! | file | holds |
//! |---|---|
//! | `page` | title, paragraphs, tables, charts, figures, as HTML |
//! | `chart` | curves as SVG |
//! | `figures` | stick figures of clips as SVG |

mod chart;
mod figures;
mod page;

pub use chart::{Chart, Line};
pub use figures::figures;
pub use page::{Report, Table};
