//! Style components on the host (Phong, Thanh, Yu 2018): factorise two clips, learn, pack, play through the device's code.
//!
//! | file | holds |
//! |---|---|
//! | `matrix` | a clip as a standardised matrix |
//! | `factor` | `M ~ W C`: the penalised objective and its exact block updates |
//! | `gather`, [`pca()`] | two starts: joints gathered into components, principal components (also the baseline) |
//! | `prune`, `refit`, `cholesky` | fewer joints for the same error; least squares on a support; its small systems |
//! | [`sparse()`] | the sparse factorisation as a whole |
//! | `count` | how many components |
//! | `objective`, `learn` | what style learning minimises, with its gradient; Adam from seeded noise |
//! | [`train()`], `model` | from two clips to a pack; the trade-off curve |
//! | `play`, `evaluate`, `measure` | through the device's code; jerk, distances |
//!
//! A matrix holds coordinates times their levers: see [`Motion`]. Its groups, *joint groups* here, are rows of coordinates: a ball's
//! three, or up to three servos.

mod cholesky;
mod count;
mod evaluate;
mod factor;
mod gather;
mod learn;
mod matrix;
mod measure;
mod model;
mod objective;
mod pca;
mod play;
mod prune;
mod refit;
mod sparse;
mod train;

pub use count::{Choice, choose, joint_error};
pub use evaluate::{EvaluateError, RECORDED, RecordedDegrees, Report, ToClip, evaluate, to_clip};
pub use factor::{Descent, Factors, descend};
pub use gather::gather;
pub use learn::{Learned, Optimiser, learn, noise};
pub use matrix::{FRAME_RATE, Motion};
pub use measure::{content_distance, jerk, style_distance};
pub use model::ComponentsModel;
pub use objective::{Objective, Terms, Weights, gram};
pub use pca::pca;
pub use play::{HostComponents, MAX_COMPONENTS, Settings, play, play_stored};
pub use prune::prune;
pub use refit::refit;
pub use sparse::{Sparse, Sparsity, sparse};
pub use train::{TradeOff, TrainError, TrainOptions, Trained, composed, trade_off, train, train_kept};
