//! Playback of an emotion pack while its strength changes: agreement of frame rates, jumps, accelerations.
//!
//! `cargo run --release -p kinesic-host --example emotion_sweep -- PACK.kin [PACK.kin ...]`
//!
//! Joint positions are those of the poses that come out, through forward kinematics. "Jump" is what a change of strength alone
//! does to a joint's position, and to its speed (over a tenth of a millisecond), at 500 moments of ten seconds. The last three columns are
//! the largest acceleration of a joint: at 21 strengths that stay, swept from end to end of the range and back every two seconds,
//! leaping from end to end every half second.

use std::path::Path;

use kinesic::model::ATTRIBUTES;
use kinesic::pose::{World, forward};
use kinesic_host::emotion::HostEmotion;
use kinesic_host::emotion::play::{HostState, pose};
use kinesic_host::pack::PackFile;
use kinesic_host::rig::{MAX_JOINTS, Rig};
use nalgebra::Vector3;

type Positions = Vec<Vector3<f32>>;

/// Seconds that are played.
const SECONDS: usize = 10;

fn main() {
    println!(
        "| pack | 30, 60, 120 a second differ by, mm | jump, mm | jump, m/s | fastest joint, m/s | steady, m/s^2 | swept, m/s^2 | leaping, m/s^2 |"
    );
    println!("|---|---:|---:|---:|---:|---:|---:|---:|");
    for path in std::env::args().skip(1) {
        let file = PackFile::read(Path::new(&path)).unwrap_or_else(|error| stop(&error));
        let pack = file.pack().unwrap_or_else(|error| stop(&error));
        let emotion = HostEmotion::load(&pack).unwrap_or_else(|error| stop(&error));
        let rig = Rig::from_pack(&pack).unwrap_or_else(|error| stop(&error));
        row(&path, &Motion { emotion, rig });
    }
}

fn stop(error: &dyn std::fmt::Display) -> ! {
    eprintln!("{error}");
    std::process::exit(1);
}

/// A model and its rig.
struct Motion<'a> {
    emotion: HostEmotion<'a>,
    rig: Rig,
}

fn row(path: &str, emotion: &Motion) {
    let rates = [30, 60, 120].map(|rate| play(emotion, rate, &|t| wave(t)));
    let mut differ = 0f32;
    for (at, slow) in rates[0].iter().enumerate() {
        for (fast, step) in [(&rates[1], 2), (&rates[2], 4)] {
            differ = differ.max(apart(slow, &fast[step * at]));
        }
    }
    let steady: Vec<[f32; 2]> = (0..=20).map(|part| extremes(&play(emotion, 240, &|_| part as f32 / 20.0))).collect();
    let largest = |of: &[[f32; 2]], at: usize| of.iter().map(|x| x[at]).fold(0.0, f32::max);
    let swept = extremes(&play(emotion, 240, &wave));
    let leaping = extremes(&play(emotion, 240, &|t| if ((2.0 * t) as usize).is_multiple_of(2) { 0.0 } else { 1.0 }));
    let [moved, faster] = jumps(emotion);
    let name = Path::new(path).file_stem().unwrap_or_default().to_string_lossy();
    println!(
        "| {name} | {:.4} | {:.4} | {faster:.3} | {:.1} | {:.0} | {:.0} | {:.0} |",
        1e3 * differ,
        1e3 * moved,
        largest(&steady, 0).max(swept[0]),
        largest(&steady, 1),
        swept[1],
        leaping[1]
    );
}

/// From 0 to 1 and back within two seconds.
fn wave(time: f32) -> f32 {
    0.5 - 0.5 * (std::f32::consts::PI * time).cos()
}

/// All attributes at a part of their range.
fn strengths(emotion: &Motion, part: f32) -> [f32; ATTRIBUTES] {
    emotion.emotion.meta().attributes.map(|a| a.map_or(0.0, |a| a.strength[0] + part * (a.strength[1] - a.strength[0])))
}

fn start(emotion: &Motion, part: f32) -> Box<HostState> {
    let mut state = Box::new(HostState::new());
    state.strength = strengths(emotion, part);
    state
}

fn step(emotion: &Motion, state: &mut HostState, dt: f32) -> Positions {
    let mut world = World::<MAX_JOINTS>::identity();
    let pose = pose(&emotion.emotion, &emotion.rig.frames(), state, dt);
    forward(&emotion.rig.device(), &pose, &mut world);
    world.positions[..emotion.rig.joints()].to_vec()
}

/// The strengths change at 30 moments a second, whatever the rate.
fn play(emotion: &Motion, rate: usize, part: &dyn Fn(f32) -> f32) -> Vec<Positions> {
    let mut state = start(emotion, part(0.0));
    let frame = |frame: usize| {
        if frame.is_multiple_of(rate / 30) {
            state.strength = strengths(emotion, part(frame as f32 / rate as f32));
        }
        step(emotion, &mut state, 1.0 / rate as f32)
    };
    (0..=SECONDS * rate).map(frame).collect()
}

fn apart(a: &Positions, b: &Positions) -> f32 {
    a.iter().zip(b).map(|(a, b)| (a - b).norm()).fold(0.0, f32::max)
}

/// Largest speed and acceleration of a joint, at 240 frames a second.
fn extremes(frames: &[Positions]) -> [f32; 2] {
    let mut most = [0f32; 2];
    for three in frames.windows(3) {
        for ((first, second), third) in three[0].iter().zip(&three[1]).zip(&three[2]) {
            let (a, b) = (second - first, third - second);
            most = [most[0].max(240.0 * b.norm()), most[1].max(240.0 * 240.0 * (b - a).norm())];
        }
    }
    most
}

fn jumps(emotion: &Motion) -> [f32; 2] {
    const DT: f32 = 1e-4;
    let mut state = start(emotion, 0.0);
    let speeds = |state: &HostState| {
        let mut state = Box::new(*state);
        let [a, b] = [(); 2].map(|()| step(emotion, &mut state, DT));
        b.iter().zip(&a).map(|(b, a)| (b - a) / DT).collect::<Positions>()
    };
    let mut most = [0f32; 2];
    for change in 0..500 {
        step(emotion, &mut state, 0.02);
        let (before, speed) = (step(emotion, &mut state, 0.0), speeds(&state));
        state.strength = strengths(emotion, [1.0, 0.3, 0.8, 0.0][change % 4]);
        emotion.emotion.change(&mut state);
        let (after, speed_after) = (step(emotion, &mut state, 0.0), speeds(&state));
        most = [most[0].max(apart(&before, &after)), most[1].max(apart(&speed, &speed_after))];
    }
    most
}
