//! Every engine behind the limiter for ten million frames of random valid input, twice.
//!
//! `cargo run --release -p kinesic-tests --example soak [FRAMES [ENGINE]]`

#[path = "../tests/common/engines.rs"]
mod engines;
#[path = "../tests/common/robot.rs"]
mod robot;
#[path = "../tests/common/soak.rs"]
mod soak;

use std::time::Instant;

use engines::{ENGINES, Packs};

fn main() {
    let mut arguments = std::env::args().skip(1);
    let frames: u64 = arguments.next().map_or(10_000_000, |count| count.parse().expect("a number of frames"));
    let only = arguments.next();
    let packs = Packs::new();
    println!(
        "{frames} frames, twice\n\n| engine | norm drift | root from source, at most, m | engine resets | us a frame | same bits |"
    );
    println!("|---|---|---|---|---|---|");
    for engine in ENGINES.into_iter().filter(|engine| only.as_ref().is_none_or(|only| only == engine)) {
        let start = Instant::now();
        let tick = |frame: u64| {
            if frame % 1_000_000 == 999_999 {
                eprintln!("{engine}: {} million frames", (frame + 1) / 1_000_000);
            }
        };
        let first = soak::soak(&packs, engine, frames, tick);
        let time = start.elapsed().as_secs_f64() * 1e6 / frames as f64;
        let second = soak::soak(&packs, engine, frames, tick);
        assert!(first.worst_norm < 1e-5, "{engine}: {first:?}");
        assert_eq!(first, second, "{engine}: the second run differs");
        println!(
            "| {engine} | {:.1e} | {:.2} | {} | {time:.1} | {:016x} |",
            first.worst_norm, first.farthest_root, first.engine_faults, first.hash
        );
    }
}
