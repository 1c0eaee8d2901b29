//! Reports: one self-contained HTML page of what a training did, to open from disk.
//!
//! | file | holds |
//! |---|---|
//! | `page` | title, paragraphs, tables, charts, figures, as HTML |
//! | `chart` | curves as SVG |
//! | `faces` | faces from their landmarks as SVG |
//! | [`latency`] | what a frame costs on six cores |

mod chart;
mod faces;
pub mod latency;
mod page;

pub use chart::{Chart, Line};
pub use faces::faces;
pub use page::{Report, Table};
