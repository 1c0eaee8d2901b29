//! A long run of one engine: what is watched, and a hash of every bit that came out.
#![allow(dead_code, missing_docs, reason = "each test file uses a part")]

use kinesic::Pose;

use crate::engines::{Motion, Packs, State};

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Soaked {
    pub hash: u64,
    pub worst_norm: f32,
    pub farthest_root: f32,
    pub engine_faults: u32,
    pub faulty_frames: u32,
}

/// Runs `frames` frames.
///
/// # Panics
/// Where a number that comes out is not finite.
pub fn soak(packs: &Packs, engine: &str, frames: u64, mut tick: impl FnMut(u64)) -> Soaked {
    let device = packs.device(engine);
    let (mut state, mut motion, mut out) = (State::new(), Motion::new(11), Pose::identity());
    let mut soaked = Soaked { hash: 0xcbf2_9ce4_8422_2325, ..Soaked::default() };
    for frame in 0..frames {
        let input = motion.next();
        device.step(&mut state, Some(&input), &mut out);
        assert!(out.root.iter().all(|x| x.is_finite()), "{engine}: frame {frame}: {}", out.root);
        for q in &out.rotations {
            let norm = (q.coords.dot(&q.coords) - 1.0).abs() * 0.5;
            assert!(norm.is_finite(), "{engine}: frame {frame}: {q}");
            soaked.worst_norm = soaked.worst_norm.max(norm);
            for x in q.coords.iter() {
                soaked.hash = (soaked.hash ^ u64::from(x.to_bits())).wrapping_mul(0x0100_0000_01b3);
            }
        }
        for x in out.root.iter() {
            soaked.hash = (soaked.hash ^ u64::from(x.to_bits())).wrapping_mul(0x0100_0000_01b3);
        }
        soaked.farthest_root = soaked.farthest_root.max((out.root - input.root).norm());
        tick(frame);
    }
    soaked.engine_faults = state.engine_faults();
    soaked.faulty_frames = state.report().faulty_frames;
    soaked
}
