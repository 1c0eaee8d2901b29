//! Moves played in layers: what a robot does between and during its moves, without a jump.
//!
//! | file | holds |
//! |---|---|
//! | `blend` | [`Blend`]: from one motion into another, by what is left of the first |
//! | `moves` | [`Move`]: a recorded move in flash |
//! | `layer` | [`Layer`]: a move, a live target or rest, with weight, strength and a mask |
//! | `player` | [`Player`]: layers on top of each other, one frame of coordinates a step |
//!
//! A player stands before a pipeline: it gives the frames of coordinates that the engines style and the limiter limits.
//!
//! ```
//! use kinesic::play::{Move, Player};
//!
//! // Two servos: pan and tilt, rad. `kinesic export --rust` writes such arrays.
//! static IDLE: [[f32; 2]; 50] = [[0.1, 0.0]; 50];
//! static NOD: [[f32; 2]; 50] = [[0.0, 0.3]; 50];
//!
//! let mut player = Player::<2, 2>::new([0.0; 2]);
//! player.start([0.4, -0.2], 50);                               // where the robot stands
//! player.layers[0].play(Move::new(&IDLE).unwrap().looped(), 50);
//! player.layers[1].mask([0.0, 1.0], 0);                        // the tilt alone
//! player.layers[1].gesture(Move::new(&NOD).unwrap(), 10);
//! let first = player.step();
//! assert!((first[0] - 0.4).abs() < 0.01 && (first[1] + 0.2).abs() < 0.01);
//! ```
//!
//! # What is continuous
//!
//! Position, velocity and acceleration of what a player gives, whatever is called between two frames, but for [`Player::start`], which says where the robot is, and
//! for a change of [`Layer::mode`]. A move that is begun starts with what is
//! left of the motion before it, and that goes to nothing on a polynomial of degree five (Bollo 2018). Weights and strengths change on
//! such polynomials too. Live targets are sought by three poles in a row. How far and how fast is not bounded: a limiter does that.

mod blend;
mod layer;
mod moves;
mod player;

pub use blend::Blend;
pub use layer::{Layer, Mode};
pub use moves::Move;
pub use player::Player;
