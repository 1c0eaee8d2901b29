//! Body mechanics on the host: features and poses from clips, training, the applications through the device's code, evaluation.
//!
//! | file | holds |
//! |---|---|
//! | `body` | sizes, feet and thighs of a rig; how high ankle and toes are in a flat foot |
//! | `dataset` | one row a frame: features and pose, computed by the device's code |
//! | `network` | small multilayer perceptrons: forward, gradient, Adam |
//! | `linear` | the baseline: ridge regression from features to pose |
//! | [`train`](train()), `stages` | autoencoder, feature network, stacking, fine-tuning; what a checkpoint keeps of them |
//! | `model` | a trained model, and its pack |
//! | `play` | decouple and modulate frame by frame, as the device does |
//! | `expressive` | expression of a whole clip as a smooth motion |
//! | `clips` | modulate, mix and blend clips with it |
//! | `evaluate` | geodesic errors and what is left as expression, clip by clip |
//! | `propose` | which clips look non-expressive |

mod body;
mod clips;
mod dataset;
mod evaluate;
mod expressive;
mod linear;
mod model;
pub mod network;
mod play;
mod propose;
mod stages;
mod train;

pub use body::{BodyError, body, measured};
pub use clips::{Parted, Passage, blend_clips, mix_clip, modulate_clip};
pub use dataset::{Rows, signed, signs};
pub use evaluate::{ClipReport, Distances, Report, evaluate};
pub use expressive::{Expressive, NEW};
pub use linear::Linear;
pub use model::MechanicsModel;
pub use play::{HostMechanics, Overlap, blend, decouple, mix, modulate};
pub use propose::{Proposal, propose};
pub use train::{Figures, NamedClip, Progress, Split, TrainError, TrainOptions, Trained, train, train_kept};
