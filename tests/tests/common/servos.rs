//! Machines of servos, and how they move in two manners: seeded, on one clock.
#![allow(dead_code, missing_docs, reason = "each test file uses a part")]

use kinesic::rig::JointKind;
use kinesic_host::clip::{Joint, Skeleton};
use kinesic_host::rig::{JointCoordinates, Locals, Rig};
use nalgebra::Vector3;
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

/// Frames per second.
pub const FPS: f64 = 50.0;

/// Angles of all servos, rad, `[frames][servos]`: calm, and lively on the same clock.
pub type Take = [Vec<Vec<f64>>; 2];

/// One servo: where it hangs, and about which axis it turns.
pub struct Servo {
    pub name: &'static str,
    parent: Option<usize>,
    offset: [f64; 3],
    axis: [f32; 3],
    /// Angle about which it moves, and how far, rad.
    about: f64,
    range: f64,
    /// What the lively manner makes of it.
    lively: Lively,
}

/// How a lively servo differs from a calm one.
#[derive(Clone, Copy)]
struct Lively {
    amplitude: f64,
    /// rad.
    offset: f64,
    /// Speed of reaction, rad/s, and its damping: it swings over.
    reaction: f64,
    damping: f64,
    /// What it takes of another servo's speed: servo, s.
    follows: Option<(usize, f64)>,
}

const BRISK: Lively = Lively { amplitude: 1.4, offset: 0.1, reaction: 9.0, damping: 0.6, follows: None };

/// A machine: its servos in order.
pub struct Machine {
    pub name: &'static str,
    pub servos: Vec<Servo>,
}

const X: [f32; 3] = [1.0, 0.0, 0.0];
const Y: [f32; 3] = [0.0, 1.0, 0.0];
const Z: [f32; 3] = [0.0, 0.0, 1.0];

fn servo(name: &'static str, parent: usize, up: f64, axis: [f32; 3], range: f64, lively: Lively) -> Servo {
    // The first one stands on the table.
    let parent = (name != "pan" && name != "base yaw").then_some(parent);
    Servo { name, parent, offset: [0.0, up, 0.0], axis, about: 0.1, range, lively }
}

/// Pan and tilt; the lively head nods into every turn.
pub fn head() -> Machine {
    let nod = Lively { follows: Some((0, 0.12)), offset: -0.15, ..BRISK };
    Machine {
        name: "pan-tilt head",
        servos: vec![servo("pan", 0, 0.1, Y, 0.8, BRISK), servo("tilt", 0, 0.05, X, 0.3, nod)],
    }
}

/// Five servos one after the other.
pub fn lamp() -> Machine {
    let quick = |reaction, amplitude| Lively { reaction, amplitude, ..BRISK };
    Machine {
        name: "lamp",
        servos: vec![
            servo("base yaw", 0, 0.05, Y, 0.7, quick(7.0, 1.3)),
            servo("shoulder", 0, 0.05, X, 0.4, Lively { offset: -0.2, ..quick(6.0, 1.2) }),
            servo("elbow", 1, 0.2, X, 0.5, quick(8.0, 1.5)),
            servo("wrist pitch", 2, 0.2, X, 0.4, Lively { follows: Some((0, 0.1)), ..quick(11.0, 1.4) }),
            servo("wrist roll", 3, 0.05, Z, 0.3, Lively { follows: Some((0, -0.08)), ..quick(12.0, 1.1) }),
        ],
    }
}

/// A head with two antennas, which wobble when it is lively: for less than the 0.8 s that training looks back.
pub fn antennas() -> Machine {
    let wobble = |follows| Lively { reaction: 14.0, damping: 0.25, follows: Some(follows), ..BRISK };
    let mut machine = head();
    machine.name = "head with antennas";
    for (name, side, share) in [("left antenna", 0.04, 0.2), ("right antenna", -0.04, -0.2)] {
        let antenna = servo(name, 1, 0.1, Z, 0.2, wobble((0, share)));
        machine.servos.push(Servo { offset: [side, 0.1, 0.0], ..antenna });
    }
    machine
}

impl Machine {
    /// Its rig: every servo a hinge, no hips, no markers.
    pub fn rig(&self) -> Rig {
        let joint = |servo: &Servo| Joint {
            name: servo.name.to_owned(),
            parent: servo.parent,
            offset: Vector3::from(servo.offset),
            end: Some(Vector3::new(0.0, 0.1, 0.0)),
        };
        let hinge = |servo: &Servo| JointCoordinates {
            axes: [servo.axis, [0.0; 3], [0.0; 3]],
            ..JointCoordinates::new(JointKind::Hinge)
        };
        let skeleton = Skeleton { joints: self.servos.iter().map(joint).collect() };
        Rig::machine(&skeleton, &self.servos.iter().map(hinge).collect::<Vec<_>>()).unwrap()
    }

    /// A motion in both manners.
    pub fn take(&self, seed: u64, seconds: f64) -> Take {
        let frames = (seconds * FPS) as usize;
        let calm = self.calm(seed, frames);
        let lively = self.lively(&calm);
        [calm, lively]
    }

    /// Every servo goes to one place after the other, smoothly, at times of its own.
    fn calm(&self, seed: u64, frames: usize) -> Vec<Vec<f64>> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut state: Vec<[f64; 4]> = self.servos.iter().map(|servo| [servo.about, servo.about, 0.0, 0.0]).collect();
        let mut next = |(state, servo): (&mut [f64; 4], &Servo)| {
            let [goal, at, speed, left] = state;
            if *left <= 0.0 {
                *goal = servo.about + servo.range * random.random_range(-1.0..1.0);
                *left = random.random_range(0.5..2.0);
            }
            *left -= 1.0 / FPS;
            // Critically damped, 5 rad/s.
            *speed += (25.0 * (*goal - *at) - 10.0 * *speed) / FPS;
            *at += *speed / FPS;
            *at
        };
        (0..frames).map(|_| state.iter_mut().zip(&self.servos).map(&mut next).collect()).collect()
    }

    /// What the lively manner makes of a calm motion.
    fn lively(&self, calm: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let mut state: Vec<[f64; 2]> =
            self.servos.iter().map(|servo| [servo.about + servo.lively.offset, 0.0]).collect();
        let mut before = &calm[0];
        let mut rows = Vec::with_capacity(calm.len());
        for row in calm {
            for ((servo, [at, speed]), x) in self.servos.iter().zip(&mut state).zip(row) {
                let Lively { amplitude, offset, reaction, damping, follows } = servo.lively;
                let follows = follows.map_or(0.0, |(of, share)| share * (row[of] - before[of]) * FPS);
                let goal = servo.about + offset + amplitude * (x - servo.about) + follows;
                *speed += (reaction * reaction * (goal - *at) - 2.0 * damping * reaction * *speed) / FPS;
                *at += *speed / FPS;
            }
            before = row;
            rows.push(state.iter().map(|[at, _]| *at).collect());
        }
        rows
    }

    /// A motion as training takes it.
    pub fn locals(&self, rig: &Rig, motion: &[Vec<f64>]) -> Locals {
        let row = |angles: &Vec<f64>| {
            let mut row = angles.clone();
            row.resize(3 * rig.rows(), 0.0);
            row
        };
        rig.standing(motion.iter().flat_map(row).collect())
    }
}
