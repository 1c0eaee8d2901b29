//! Every engine behind the limiter on random valid input, twice: a short run, and a long one that is asked for by name.

#[path = "common/engines.rs"]
mod engines;
#[path = "common/robot.rs"]
mod robot;

use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::time::Instant;

use engines::{ENGINES, Motion, Packs, new_state};
use kinesic::Pose;
use kinesic::rig::REACH;

/// What came of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Soaked {
    /// Of every bit that came out.
    hash: u64,
    worst_norm: f32,
    farthest_root: f32,
    faulty_frames: u32,
}

fn soak(packs: &Packs, engine: &str, frames: u64) -> Soaked {
    let device = packs.device(engine);
    let (mut state, mut motion, mut out) = (new_state(engine), Motion::new(11), Pose::identity());
    let mut soaked = Soaked { hash: 0xcbf2_9ce4_8422_2325, ..Soaked::default() };
    for frame in 0..frames {
        let input = motion.next();
        device.step(&mut state, Some(&input), &mut out);
        assert!(out.root.iter().all(|x| x.is_finite()), "{engine}: frame {frame}: {}", out.root);
        for q in &out.rotations {
            let norm = (q.coords.dot(&q.coords) - 1.0).abs() * 0.5;
            assert!(norm.is_finite(), "{engine}: frame {frame}: {q}");
            soaked.worst_norm = soaked.worst_norm.max(norm);
        }
        for x in out.rotations.iter().flat_map(|q| q.coords.iter()).chain(out.root.iter()) {
            soaked.hash = (soaked.hash ^ u64::from(x.to_bits())).wrapping_mul(0x0100_0000_01b3);
        }
        soaked.farthest_root = soaked.farthest_root.max((out.root - input.root).norm());
    }
    soaked.faulty_frames = state.report().faulty;
    soaked
}

/// Two runs of every engine, as many at a time as there are cores, and a row of the table in `docs/reliability.md`.
fn twice(frames: u64) {
    let packs = Packs::new();
    let before = resident();
    println!(
        "| engine | frames | drift of norms | root from the source's, at most, m | us a frame | hash of all bits, both runs |"
    );
    println!("|---|---|---|---|---|---|");
    let next = AtomicUsize::new(0);
    let runs: [OnceLock<Soaked>; 2 * ENGINES.len()] = std::array::from_fn(|_| OnceLock::new());
    let work = || {
        while let Some((at, run)) = Some(next.fetch_add(1, Relaxed)).and_then(|at| Some((at, runs.get(at)?))) {
            let engine = ENGINES[at / 2];
            let start = Instant::now();
            let found = *run.get_or_init(|| soak(&packs, engine, frames));
            let time = start.elapsed().as_secs_f64() * 1e6 / frames as f64;
            let Soaked { hash, worst_norm, farthest_root, .. } = found;
            println!("| {engine} | {frames} | {worst_norm:.1e} | {farthest_root:.2} | {time:.1} | {hash:016x} |");
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..std::thread::available_parallelism().map_or(1, usize::from) {
            scope.spawn(work);
        }
    });
    for (pair, engine) in runs.chunks(2).zip(ENGINES) {
        let first = pair[0].get().unwrap();
        assert!(first.worst_norm < 1e-5, "{engine}: {first:?}");
        // Limits hold the body back by centimetres, and its height changes.
        assert!(first.farthest_root < REACH + 0.1, "{engine}: {first:?}");
        assert_eq!(first.faulty_frames, 0, "{engine}");
        assert_eq!(pair[1].get(), Some(first), "{engine}: a second run");
    }
    if let (Some(before), Some(after)) = (before, resident()) {
        println!("resident memory: {before} kB before, {after} kB after");
        // Stacks of the threads are in it, and what the allocator keeps of them.
        assert!(after < before + 4096, "memory grew");
    }
}

/// Resident memory of this process, kB, where the system tells.
fn resident() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    status.lines().find_map(|line| line.strip_prefix("VmRSS:"))?.trim().strip_suffix(" kB")?.parse().ok()
}

#[test]
fn every_engine_runs_on_with_the_same_bits() {
    twice(20_000);
}

#[test]
#[ignore = "minutes to hours: KINESIC_SOAK frames an engine, default ten million"]
fn soak_for_long() {
    twice(std::env::var("KINESIC_SOAK").map_or(10_000_000, |frames| frames.parse().expect("a number of frames")));
}
