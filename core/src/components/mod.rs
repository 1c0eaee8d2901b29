//! Style components: a motion is weights times a few basic motions, and a style is other basic motions for the same weights.
//!
//! A frame of coordinates is `mean + w C`, `w` the weights of the `K` components (Phong, Thanh, Yu 2018). The content's
//! components `C_C` say which weights belong to a pose, the learned ones `C_X` what the style makes of them:
//! `M_X = W C_X`. What the components do not explain of a live pose stays as it is. Phong's matrices hold
//! positions; here they hold [coordinates](crate::rig), so that heads, hands and twists are styled and bones keep their length.

mod model;
mod state;
mod step;

pub use model::Components;
pub use state::ComponentsState;
