//! Writing and reading packs (`.kin`), the files that the device runs. The format is in `docs/pack.md`.

mod file;
pub(crate) mod layout;
mod provenance;
mod write;

pub use file::{PackFile, ReadPackError};
pub use layout::IntegerLayer;
pub use provenance::{Baselines, InputFile, Metric, Provenance};
pub use write::PackWriter;
