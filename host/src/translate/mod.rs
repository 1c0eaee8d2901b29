//! Style translation on the host: train from pairs of clips, play through the device's code, evaluate.
//!
//! | file | holds |
//! |---|---|
//! | `correspond` | which styled moment belongs to which source frame |
//! | `cyclic` | whether a motion is a walk, which is aligned in step |
//! | `dataset` | training sequences: source frames and wanted output |
//! | `dynamics` | candidate dynamics: banks of poles, simulation |
//! | [`identify`] | dynamics from data: impulse response, truncation, modal form |
//! | `gate`, `experts` | how familiar a frame is; output stages for several actions |
//! | `candidate`, `features`, `moments`, `fit` | ridge regression and cross-validation from second moments |
//! | [`train`](train()) | the whole of it |
//! | `model` | a trained translator, and its pack |
//! | `play`, `evaluate`, `baseline` | through the device's code; beside simpler models |

mod baseline;
mod candidate;
mod correspond;
mod cyclic;
mod dataset;
mod dynamics;
mod evaluate;
mod experts;
mod features;
mod fit;
mod gate;
pub mod identify;
mod model;
mod moments;
mod play;
mod simulate;
mod strength;
mod train;

pub use candidate::{AFFINE, Candidate};
pub use correspond::{Alignment, OPEN};
pub use dynamics::{Dynamics, Poles};
pub use evaluate::{Angles, Errors, EvaluateError, NamedPair, PairReport, Report, evaluate};
pub use gate::GateModel;
pub use model::{BankModel, ExpertModel, TimingModel, TranslatorModel};
pub use moments::Base;
pub use play::{HostTranslator, Played, Settings, TIMING_STRENGTH, Timing, play, play_on_clock, unfamiliar_percent};
pub use strength::plausible;
pub use train::{
    DEFAULT_ORDER, FormChoice, Stage, TrainError, TrainOptions, TrainPair, Trained, partners, train, train_kept,
};
