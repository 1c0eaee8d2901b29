//! Trains kinesic models from motion-capture clips, packs them, previews and applies them.
//!
//! Data flows one way: [`clip`] (read) -> [`rig`] and [`retarget`] (one skeleton for all) -> [`align`] (one clock for a
//! pair) -> [`translate`] (fit) -> [`pack`] (file); the device crate `kinesic` takes it from there, and [`translate::play`]
//! runs that very crate to preview, apply and evaluate.

pub mod align;
mod cells;
pub mod checkpoint;
pub mod clip;
pub mod components;
pub mod edit;
pub mod embed;
pub mod emotion;
pub mod engines;
pub mod face;
pub mod feet;
pub mod files;
pub mod gait;
pub mod learn;
pub mod limit;
pub mod measure;
pub mod mechanics;
pub mod models;
pub mod moves;
pub mod own_body;
pub mod pack;
pub mod plain;
pub mod plausible;
pub mod prepare;
pub mod quality;
pub mod quantise;
mod quietly;
pub mod report;
pub mod retarget;
pub mod rig;
pub mod robot;
pub mod sheet;
mod steady;
pub mod step_cache;
pub mod strength;
pub mod translate;
mod vector;
pub mod view;
