//! Learned motion style on a microcontroller: `no_std`, no heap, no panic, one infallible [`step`] per frame.
//!
//! The host crate learns *how* a motion is performed and writes a pack (`.kin`); this crate holds the pack in flash and
//! performs it, frame by frame. A frame walks through the rooms in this order:
//!
//! | room | holds | source |
//! |---|---|---|
//! | [`model`] | the pack: header check, typed views into borrowed bytes, errors | `docs/pack.md` |
//! | [`pose`] | skeleton, pose, forward kinematics, heading, joint positions -> rotations | |
//! | [`rig`] | coordinates: hinges, balls, sliders; pose -> frame of coordinates -> pose | |
//! | [`engine`] | the seam: engines in series, side by side, between pose and pose; bad frames kept out | |
//! | [`translate`] | style translation by linear time-invariant state-space models | Dong 2018 after Hsu 2005 |
//! | [`mechanics`] | what the body must do, what is expression: decouple, modulate, mix, blend | Boehs 2017 |
//! | [`components`] | style components applied to a live pose or to a stored stream of weights | Phong 2018 |
//! | [`emotion`] | strength of an emotion -> keyframes -> spline -> pose | Chan 2019 |
//! | [`face`] | strength of a facial expression -> landmarks | Chan 2019 |
//! | [`play`] | moves in layers: what a robot's engines are given, without a jump | Bollo 2018 |
//! | [`feet`] | feet held where they stand, behind a pipeline | |
//! | [`limit`] | the last stage: position, velocity, acceleration and jerk limits | |
//! | [`servo`] | a coordinate as the number that a servo takes | |
//! | [`kernel`] | the few inner loops: matrix x vector, modal recursion, activations | |
//!
//! Units are metres, radians, seconds and frames; right-handed, Y up; a person who faces +Z has the left hand at +X.
//!
//! Configuration and state are two types: a model is an immutable view of flash ([`Pipeline`], [`Translator`]), a state is owned by
//! the caller ([`PipelineState`], [`TranslatorState`]), can be copied and reset. Sizes are const-generic capacities; the file gives the
//! actual shape, and a mismatch is an error at load time. After a successful load nothing can fail.
//!
//! ```
//! use kinesic::{Pack, Pipeline, PipelineState, Pose, Translator};
//!
//! # fn read_pose() -> Option<Pose<19>> { None }
//! # fn write_pose(_: &Pose<19>) {}
//! fn run(bytes: &'static [u8]) -> Result<(), kinesic::LoadError> {
//!     let pack = Pack::load(bytes)?;
//!     let pipeline = Pipeline::<Translator<20, 60>, 20>::load(&pack)?;
//!     let mut state = PipelineState::new();
//!     let mut styled = Pose::identity();
//!     for _ in 0..100 {
//!         pipeline.step(&mut state, read_pose().as_ref(), &mut styled);
//!         write_pose(&styled);
//!     }
//!     Ok(())
//! }
//! # assert!(run(&[]).is_err());
//! ```
//!
//! A robot whose servos are the [coordinates](rig) leaves poses out: [`Pipeline::step_coordinates`]. Joint limits are one more engine:
//! `Pipeline::<(Translator<20, 60>, Limiter<20>), 20>`.
//!
//! [`step`]: Pipeline::step
#![no_std]

#[cfg(not(target_endian = "little"))]
compile_error!("packs are little-endian and used in place: kinesic needs a little-endian target");

pub mod components;
pub mod emotion;
pub mod engine;
pub mod face;
pub mod feet;
pub mod kernel;
pub mod limit;
pub mod mechanics;
pub mod model;
pub mod play;
pub mod pose;
pub mod rig;
pub mod servo;
pub mod translate;

pub use components::{Components, ComponentsState};
pub use emotion::{Emotion, EmotionState};
pub use engine::{Engine, Pipeline, PipelineState};
pub use face::{FaceState, FaceSynth};
pub use feet::{Feet, FeetState};
pub use limit::{LimitState, LimitTable, Limiter, SmoothLimitState, SmoothLimiter};
pub use mechanics::{BodyMechanics, MechanicsState};
pub use model::{LoadError, Pack};
pub use play::Player;
pub use pose::{Pose, Skeleton};
pub use rig::{Frame, Rig};
pub use servo::Servos;
pub use translate::{Translator, TranslatorState};

/// The vectors and quaternions of poses.
pub use nalgebra;
