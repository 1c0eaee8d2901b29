//! Iterative motion warping: brings a styled clip onto the clock of its neutral counterpart.
//!
//! [`align`] finds the time warp and the smooth scale and offset between two clips; [`Warp`] holds the result;
//! [`aligned_rms`] measures how far apart two motions are when their timing is taken out. Clips are plain row-major
//! tables, [`Series`].
//!
//! ```
//! use kinesic_host::align::{Series, Settings, align};
//!
//! let neutral: Vec<f64> = (0..60).map(|t| (t as f64 / 8.0).sin()).collect();
//! let styled: Vec<f64> = (0..80).map(|t| 1.5 * (t as f64 / 10.7).sin()).collect();
//! let (u, v) = (Series::new(&neutral, 1)?, Series::new(&styled, 1)?);
//! let warp = align(u, v, &Settings::default())?;
//! for step in warp.history() {
//!     println!("{} {:?} {:.4}", step.iteration, step.half, step.energy.total());
//! }
//! let on_the_neutral_clock = warp.apply(v)?;
//! assert_eq!(on_the_neutral_clock.len(), 60);
//! # Ok::<(), kinesic_host::align::AlignError>(())
//! ```

mod banded;
mod clock;
mod corridor;
mod distance;
mod dtw;
mod error;
mod iterate;
mod row;
mod search;
mod series;
mod settings;
mod space;
mod standard;
mod steps;
mod tiles;
mod warp;

pub use distance::{AlignedDistance, aligned, aligned_distance, aligned_path, aligned_rms};
pub use error::{AlignError, Side};
pub use iterate::{Energy, Half, Progress, align, align_with};
pub use search::Work;
pub use series::Series;
pub use settings::{Ends, Search, Settings, Smoothness};
pub use warp::Warp;
