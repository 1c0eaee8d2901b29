//! Strength of a facial expression on the host (Chan 2019, the face part): read landmarks, learn, pack, play, warp pictures.
//!
//! | file | holds |
//! |---|---|
//! | `landmarks` | tables of landmarks |
//! | `shape` | regions, and the numbers that a ranking function sees |
//! | `strength` | ranking functions: one for all, then one a cluster that may differ from it |
//! | [`train()`], `model` | from a table to a pack |
//! | `synthetic` | faces for tests and the firmware workload |
//! | `evaluate` | reads every face through the device's code; pair accuracy, rank correlation |
//! | [`photo`] | pictures from files, whole or refused |
//! | [`edit()`], `warp/` | offsets for a change of strength; moves the landmarks of a picture |

mod edit;
mod evaluate;
pub mod landmarks;
mod model;
pub mod photo;
mod shape;
mod strength;
pub mod synthetic;
mod train;
pub mod warp;

pub use edit::{Edit, Wish, edit};
pub use evaluate::{ClusterReport, Read, Report, evaluate, pair_accuracy, read_all};
pub use landmarks::{Face, LandmarksError, LandmarksFault};
pub use model::{ClusterModel, FaceModel, HostFace, MAX_UNITS};
pub use shape::{REGIONS, numbers, region_local};
pub use train::{TrainError, TrainOptions, Trained, hold_out, train};
