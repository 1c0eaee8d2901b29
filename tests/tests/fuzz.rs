//! The fuzz targets on their corpus, on everything that was ever found, and on seeded damage of both: in every test run, without
//! libFuzzer. `./ci.sh fuzz` goes on from here.
//!
//! `KINESIC_CORPUS=write cargo test --release -p kinesic-tests --test fuzz` makes the corpus anew. All of it is ours: made walks,
//! and packs trained on them. FBX alone is not made anew: Blender made one of a walk of ours, one is written by hand.

#[path = "../../fuzz/src/lib.rs"]
mod fuzz;
#[path = "fuzz/machines.rs"]
mod machines;
#[path = "fuzz/corpus.rs"]
mod seeds;

mod common;

use std::path::{Path, PathBuf};

use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

/// A target, and how many damaged inputs a test run gives it.
type Target = (&'static str, fn(&[u8]), usize);

const TARGETS: [Target; 11] = [
    ("pack", fuzz::pack, 6000),
    ("bvh", fuzz::bvh, 2000),
    ("gltf", fuzz::gltf, 5000),
    ("fbx", fuzz::fbx, 2000),
    ("csv", fuzz::csv, 500),
    ("map", fuzz::map, 10_000),
    ("urdf", fuzz::urdf, 10_000),
    ("robot", fuzz::robot, 5000),
    ("servos", fuzz::servos, 5000),
    ("moves", fuzz::moves, 5000),
    ("limbs", fuzz::limbs, 5000),
];

fn folder(kind: &str, target: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../fuzz").join(kind).join(target)
}

/// Files of a folder by name.
fn files(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let Ok(entries) = std::fs::read_dir(folder) else { return Vec::new() };
    let mut files: Vec<_> = entries
        .map(|entry| entry.unwrap())
        .map(|entry| (entry.file_name().into_string().unwrap(), std::fs::read(entry.path()).unwrap()))
        .collect();
    files.sort();
    files
}

#[test]
fn the_corpus_and_all_that_was_ever_found_pass() {
    if std::env::var("KINESIC_CORPUS").as_deref() == Ok("write") {
        seeds::write(&folder("corpus", ""));
    }
    for (target, run, _) in TARGETS {
        let corpus = files(&folder("corpus", target));
        assert!(corpus.len() >= 3, "{target}: {} seeds", corpus.len());
        for (name, bytes) in corpus.into_iter().chain(files(&folder("regressions", target))) {
            println!("{target}/{name}");
            run(&bytes);
        }
    }
}

/// A few bytes changed, cut out, put in or taken from elsewhere.
fn damage(bytes: &mut Vec<u8>, other: &[u8], random: &mut ChaCha8Rng) {
    for _ in 0..random.random_range(1..5) {
        if bytes.is_empty() {
            bytes.push(random.random());
        }
        let at = random.random_range(0..bytes.len());
        match random.random_range(0..6) {
            0 => bytes[at] ^= 1 << random.random_range(0..8),
            1 => bytes[at] = random.random(),
            2 => bytes[at] = [0, 1, 0x7f, 0x80, 0xff][random.random_range(0..5)],
            3 => drop(bytes.drain(at..(at + random.random_range(1..9)).min(bytes.len()))),
            4 => bytes.insert(at, random.random()),
            _ if other.is_empty() => bytes.truncate(at),
            _ => {
                let from = random.random_range(0..other.len());
                let run = &other[from..(from + random.random_range(1..64)).min(other.len())];
                let end = (at + run.len()).min(bytes.len());
                bytes.splice(at..end, run.iter().copied());
            }
        }
    }
}

#[test]
fn damaged_seeds_are_survived() {
    for (target, run, count) in TARGETS {
        let corpus = files(&folder("corpus", target));
        for index in 0..count {
            let mut random = ChaCha8Rng::seed_from_u64(index as u64);
            let mut bytes = corpus[random.random_range(0..corpus.len())].1.clone();
            let other = &corpus[random.random_range(0..corpus.len())].1;
            damage(&mut bytes, other, &mut random);
            run(&bytes);
        }
    }
}
