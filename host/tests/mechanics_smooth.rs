//! `kinesic modulate`, `mix` and `blend` on bodies that the pack was not trained on: smooth, on the clip's own skeleton, and with figures.
//!
//! `cargo test --release -p kinesic-host --test mechanics_smooth -- --nocapture` prints the tables of docs/mechanics.md.

mod real;

use std::path::{Path, PathBuf};
use std::process::Command;

use kinesic_host::clip::{self, Clip};
use kinesic_host::gait::{Manner, walk};
use nalgebra::{UnitQuaternion, Vector3};
use serde_json::Value;

/// Jerk of a result over the clip's own, at most.
const ROUGH: f64 = 1.3;

/// Clips of seven skeletons, none of which the pack was trained on.
const CLIPS: [&str; 17] = [
    "xia/neutral_01_000.bvh",
    "xia/angry_13_000.bvh",
    "xia/strutting_16_000.bvh",
    "bandai1/walk_happy_001.bvh",
    "bandai1/dance-short_normal_001.bvh",
    "bandai1/punch_normal_001.bvh",
    "bandai2/walk_feminine_001.bvh",
    "bandai2/wave-both-hands_active_001.bvh",
    "aalto/k_run_fast_k_run_slow_100_000.bvh",
    "m21/content/box-1.bvh",
    "m21/content/swim.bvh",
    "m21/content/jumping-jack.bvh",
    "m21/style/OLD-1.bvh",
    "cmu24cc/06_08.bvh",
    "cmu43daz/09_01.bvh",
    "kindergator/adult/p565_Do-two-jumping-jacks.csv",
    "kindergator/adult/p565_Jump.csv",
];

fn pack() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../models/mechanics.kin")
}

fn run(args: &[&str]) -> Value {
    let output = Command::new(env!("CARGO_BIN_EXE_kinesic")).args(args).arg("--json").output().unwrap();
    assert!(output.status.success(), "{args:?}: {}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn number(value: &Value, path: &str) -> f64 {
    value.pointer(path).and_then(Value::as_f64).unwrap_or_else(|| panic!("no {path} in {value}"))
}

fn read(path: &Path) -> Clip {
    clip::read(path).unwrap()
}

#[test]
fn more_and_less_expression_is_smooth_on_any_body() {
    let Some(data) = real::data("mechanics_smooth") else { return };
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out.bvh");
    let [pack, out] = [pack(), out].map(|path| path.display().to_string());
    println!(
        "jerk over the clip's at 0, .5, 1.5, 2; frame by frame (--on pack) at 0 and 2; slide of clip, of results, cm/s; new, %"
    );
    let mut rough = Vec::new();
    for name in CLIPS {
        let path = data.join(name).display().to_string();
        let at = |amount: &str, on: &str| {
            run(&["modulate", &pack, &path, "--amount", amount, "--on", on, "--overwrite", "--out", &out])
        };
        let results = ["0", "0.5", "1.5", "2"].map(|amount| at(amount, "clip"));
        let ratios = results.each_ref().map(|result| number(result, "/jerk_ratio"));
        let slides = results.each_ref().map(|result| number(result, "/styled/foot_slide_cm_s"));
        // Nothing but motion is the result's own.
        let (was, is) = (read(Path::new(&path)), read(Path::new(&out)));
        assert!(is.frames() == was.frames() && is.skeleton.joints.len() == was.skeleton.joints.len(), "{name}");
        let device = ["0", "2"].map(|amount| number(&at(amount, "pack"), "/jerk_ratio"));
        println!(
            "{name:<48} {ratios:.2?}  {device:.1?} slide {:.1} {slides:.1?} new {:.0}",
            number(&results[0], "/source/foot_slide_cm_s"),
            number(&results[0], "/new_percent")
        );
        rough.extend(ratios.iter().filter(|ratio| **ratio > ROUGH).map(|ratio| format!("{name} {ratio:.2}")));
    }
    assert!(rough.is_empty(), "{rough:?}");
}

/// Pairs of clips: (mechanics or first, expression or second).
const PAIRS: [[&str; 2]; 8] = [
    ["xia/neutral_01_000.bvh", "bandai1/punch_normal_001.bvh"],
    ["bandai1/walk_happy_001.bvh", "aalto/k_run_fast_k_run_slow_100_000.bvh"],
    ["bandai1/punch_normal_001.bvh", "bandai2/walk_feminine_001.bvh"],
    ["bandai2/wave-both-hands_active_001.bvh", "bandai1/dance-short_normal_001.bvh"],
    ["aalto/k_run_fast_k_run_slow_100_000.bvh", "xia/neutral_01_000.bvh"],
    ["m21/content/jumping-jack.bvh", "cmu24cc/06_08.bvh"],
    ["cmu24cc/06_08.bvh", "bandai2/walk_feminine_001.bvh"],
    ["kindergator/adult/p565_Jump.csv", "xia/angry_13_000.bvh"],
];

#[test]
fn mixes_and_blends_of_two_bodies_are_smooth() {
    let Some(data) = real::data("mechanics_smooth") else { return };
    let folder = tempfile::tempdir().unwrap();
    let [pack, out] = [pack(), folder.path().join("out.bvh")].map(|path| path.display().to_string());
    println!("jerk: mixed over that of the mechanics; blended (1..1.5 s, 1.5..2 s) over the rougher one's");
    let mut rough = Vec::new();
    for pair in PAIRS {
        let [a, b] = pair.map(|name| data.join(name).display().to_string());
        let mixed = run(&["mix", &pack, "--mechanics", &a, "--expressive", &b, "--overwrite", "--out", &out]);
        let mut args = vec!["blend", &pack, &a, &b, "--overwrite", "--out", &out];
        args.extend(["--mechanics-window", "1..1.5", "--expressive-window", "1.5..2"]);
        let ratios = [mixed, run(&args)].map(|result| number(&result, "/jerk_ratio"));
        println!("{pair:?} {ratios:.2?}");
        rough.extend(ratios.iter().filter(|ratio| **ratio > ROUGH).map(|ratio| format!("{pair:?} {ratio:.2}")));
    }
    assert!(rough.is_empty(), "{rough:?}");
}

/// Greatest speed of a joint, m/s.
fn top_speed(clip: &Clip) -> f64 {
    let (positions, joints) = (clip.all_positions(), clip.skeleton.len());
    let steps = positions.iter().zip(positions.iter().skip(joints)).map(|(a, b)| (a - b).norm());
    steps.fold(0.0, f64::max) * clip.fps()
}

#[test]
fn a_frame_that_leaps_passes_as_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let [from, out] = ["spiked.bvh", "out.bvh"].map(|name| folder.path().join(name));
    for joint in ["Spine", "LeftArm", "RightForeArm", "Head", "LeftUpLeg", "RightLeg", "Hips"] {
        let mut clip = walk(&Manner::WEARY, 3.0, 60.0, 0.0, 2);
        let Some(at) = clip.skeleton.find(joint) else { panic!("{joint}: {:?}", clip.skeleton) };
        let turn = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), 40f64.to_radians());
        clip.rotations[90 * clip.skeleton.len() + at] *= turn;
        clip.write(&from).unwrap();
        let own = top_speed(&read(&from));
        for amount in ["0", "0.5", "1", "1.5", "2"] {
            let [pack, from, out] = [&pack(), &from, &out].map(|path| path.display().to_string());
            run(&["modulate", &pack, &from, "--amount", amount, "--overwrite", "--out", &out]);
            let times = top_speed(&read(Path::new(&out))) / own;
            println!("{joint} x {amount}: {times:.2} of {own:.1} m/s");
            assert!(times < 1.1 * amount.parse::<f64>().unwrap().max(1.0), "{joint} x {amount}: {times:.2}");
        }
    }
}
