//! `kill -9` at random moments of a training: `--resume` ends with the pack of a training that was never disturbed.
//!
//! `KINESIC_KILLS=20 cargo test --release -p kinesic-host --test resume -- --nocapture` is the run of docs/reliability.md.
#![cfg(unix)]

#[path = "refuse/files.rs"]
mod files;

use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

const KINESIC: &str = env!("CARGO_BIN_EXE_kinesic");

/// A training of about a second.
const TRAIN: &str = "train mechanics --clips walk.bvh weary.bvh --split sample --hidden 96 --epochs 60 --checkpoint-every 0 --out x.kin";
/// The other engines, each for about as long.
const OTHERS: [&str; 2] = [
    "train translate --pair walk.bvh weary.bvh --pair weary.bvh walk.bvh --checkpoint-every 0 --out x.kin",
    "train components --content walk.bvh --style weary.bvh --curve --checkpoint-every 0 --out x.kin",
];

fn command(folder: &Path, line: &str) -> Command {
    let mut command = Command::new(KINESIC);
    command.args(line.split(' ')).current_dir(folder).stdout(Stdio::null()).stderr(Stdio::piped());
    command
}

fn succeed(folder: &Path, line: &str) -> Output {
    let output = command(folder, line).output().unwrap();
    assert!(output.status.success(), "{line}: {}", String::from_utf8_lossy(&output.stderr));
    output
}

/// Pack and report.
fn results(folder: &Path) -> [Option<Vec<u8>>; 2] {
    ["x.kin", "x.report.html"].map(|name| std::fs::read(folder.join(name)).ok())
}

/// Everything but the clips.
fn clean(folder: &Path) {
    for name in ["x.kin", "x.report.html", "x.checkpoint"] {
        let _ = std::fs::remove_file(folder.join(name));
    }
}

/// SIGKILL after `delay`; false if the training was faster.
fn kill_after(mut child: Child, delay: Duration) -> bool {
    std::thread::sleep(delay);
    let early = child.try_wait().unwrap().is_none();
    let _ = child.kill();
    child.wait().unwrap();
    early
}

#[test]
fn a_killed_training_goes_on_to_the_same_pack() {
    killed(TRAIN);
}

#[test]
fn so_do_translators_and_components() {
    OTHERS.into_iter().for_each(killed);
}

/// Kills the training `line` at random moments.
fn killed(line: &str) {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    files::make(at);
    let begun = Instant::now();
    succeed(at, line);
    let whole = begun.elapsed();
    let expected = results(at);
    assert!(expected.iter().all(Option::is_some) && !at.join("x.checkpoint").exists());

    let kills = std::env::var("KINESIC_KILLS").map_or(3, |kills| kills.parse().unwrap());
    let mut random = ChaCha8Rng::seed_from_u64(kills);
    let (mut early, mut went_on) = (0, 0);
    for _ in 0..kills {
        clean(at);
        let delay = whole.mul_f64(random.random_range(0.0..1.0));
        early += u64::from(kill_after(command(at, line).spawn().unwrap(), delay));
        // Whole or not at all, whatever the moment.
        for (left, expected) in results(at).iter().zip(&expected) {
            assert!(left.is_none() || left == expected, "half a file after {delay:?}");
        }
        let resumed = succeed(at, &format!("{line} --resume"));
        went_on += usize::from(String::from_utf8_lossy(&resumed.stderr).contains("going on from here"));
        assert!(results(at) == expected, "another pack after a kill at {delay:?} of {whole:?}");
        assert!(!at.join("x.checkpoint").exists());
    }
    println!("{line}\n{kills} kills within {whole:?}: {early} before the end, {went_on} went on from a checkpoint");

    // Killed again and again: every run begins where the last one has come to.
    clean(at);
    let mut runs = 0;
    while !at.join("x.kin").exists() && runs < 40 {
        kill_after(command(at, &format!("{line} --resume")).spawn().unwrap(), whole.mul_f64(0.5));
        runs += 1;
    }
    succeed(at, &format!("{line} --resume"));
    assert!(results(at) == expected);
    println!("killed every {:?}: done after {runs} runs", whole.mul_f64(0.5));
}

#[test]
fn a_checkpoint_of_another_training_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    files::make(at);
    // Stopped by a kill as soon as there is a checkpoint.
    let long = TRAIN.replace("--epochs 60", "--epochs 9999");
    let mut child = command(at, &long).spawn().unwrap();
    let begun = Instant::now();
    while !at.join("x.checkpoint").exists() && begun.elapsed() < Duration::from_secs(60) {
        std::thread::sleep(Duration::from_millis(5));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    let refused = |line: &str, cause: &str| {
        let output = command(at, line).output().unwrap();
        let message = String::from_utf8_lossy(&output.stderr).split_whitespace().collect::<Vec<_>>().join(" ");
        assert_eq!(output.status.code(), Some(1), "{message}");
        assert!(message.replace("│ ", "").contains(cause), "no '{cause}' in: {message}");
    };
    refused(&format!("{TRAIN} --resume"), "other clips, other options");
    std::fs::copy(at.join("weary.bvh"), at.join("walk.bvh")).unwrap();
    refused(&format!("{long} --resume"), "other clips, other options");
    std::fs::write(at.join("x.checkpoint"), "KNSCKP01 and no more").unwrap();
    refused(&format!("{TRAIN} --resume"), "no whole checkpoint");
    refused(&TRAIN.replace("every 0", "every -1"), "expected seconds from 0 up");
    // Without --resume it is told, left alone, and replaced.
    let output = succeed(at, &TRAIN.replace("--epochs 60", "--epochs 1 --force"));
    assert!(String::from_utf8_lossy(&output.stderr).contains("left by a stopped training"));
}
