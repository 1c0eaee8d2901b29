//! Body mechanics and expressiveness: what a body must do to move as it does, and what it adds (Boehs, Vieira, Pereira 2017).
//!
//! | file | holds |
//! |---|---|
//! | `contact` | which foot stands, over the running ground estimate |
//! | `features` | [`DynamicFeatures`]: hip velocity, contacts, time in the air, hip height, thighs |
//! | `layers` | the network's layers, f32 or int8 |
//! | `network` | [`BodyMechanics`]: features -> code -> pose without expression |
//! | `decouple` | [`Decoupler`]: observed = expressive x mechanics, weighted by the activity index |
//! | `modulate`, `blend` | more or less expression; one's mechanics with another's expression; two motions blended |
//! | `expression` | [`Expression`]: all of it as one engine |
//! | `rotation` | angle and power of a rotation |
//!
//! All stages are streaming: one frame in, one frame out. A dropped or non-finite frame is held, and does not poison
//! later ones.

mod blend;
pub(crate) mod contact;
mod decouple;
mod expression;
mod features;
mod layers;
mod modulate;
mod network;
mod rotation;

pub use blend::{Blend, Window};
pub use contact::{Contacts, Thresholds};
pub use decouple::{Decoupled, Decoupler};
pub use expression::{Expression, ExpressionState};
pub use features::{Body, DynamicFeatures, FEATURES, FeatureState, feature};
pub use layers::{FARTHEST, INPUT_SCALE, OUTPUT_BITS, Precision};
pub use modulate::{Modulation, mix, modulate};
pub use network::{BodyMechanics, MechanicsState};
pub use rotation::{angle, power};
