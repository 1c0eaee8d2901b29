//! Host benches: the device's engines with criterion (`benches/`), training jobs beside what is used today
//! (`src/bin`, `peers/`).

pub mod measure;
pub mod synthetic;
