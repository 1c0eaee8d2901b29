//! `kinesic synth` as a user runs it: a made pack in, motions out.

use std::path::Path;
use std::process::Command;

use kinesic_host::clip;
use kinesic_host::emotion::synthetic;
use kinesic_host::pack::Provenance;

/// The JSON that the command prints.
fn synth(folder: &Path, line: &str) -> serde_json::Value {
    let args = line.split_whitespace();
    let output =
        Command::new(env!("CARGO_BIN_EXE_kinesic")).arg("synth").args(args).current_dir(folder).output().unwrap();
    assert!(output.status.success(), "{line}: {}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{line}: {error}"))
}

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, attributes) in [("one.kin", 1), ("two.kin", 2)] {
        let (model, rig) = synthetic::model(attributes);
        std::fs::write(folder.path().join(name), model.pack(&rig, &Provenance::default())).unwrap();
    }
    folder
}

#[test]
fn motions_have_the_strength_length_and_rate_that_were_asked_for() {
    let folder = folder();
    let calm = synth(folder.path(), "one.kin --strength 0 --out calm.bvh --json");
    let weary = synth(folder.path(), "one.kin --strength 0.9 --out weary.bvh --fps 120 --seconds 5 --json");
    assert_eq!((weary["frames"].as_u64(), weary["fps"].as_f64()), (Some(601), Some(120.0)));
    // The weary walk's cadence is lower, its steps are shorter.
    assert!(weary["round_s"][0].as_f64() > calm["round_s"][0].as_f64());
    let speed = |report: &serde_json::Value| report["travel_m"].as_f64().unwrap() / report["seconds"].as_f64().unwrap();
    assert!(speed(&weary) < 0.8 * speed(&calm), "{} {}", speed(&weary), speed(&calm));
    let scores = [&calm, &weary].map(|report| report["attributes"][0]["score"][0].as_f64().unwrap());
    assert!(scores[1] > scores[0] + 0.5, "{scores:?}");
    let read = clip::read(folder.path().join("weary.bvh")).unwrap();
    assert_eq!(read.frames(), 601);
    assert!((read.frame_time - 1.0 / 120.0).abs() < 1e-6);
    // Every format that a motion is written in.
    for name in ["o.glb", "o.gltf", "o.csv"] {
        synth(folder.path(), &format!("one.kin --strength 0.5 --out {name} --json"));
        assert!(folder.path().join(name).metadata().unwrap().len() > 1000, "{name}");
    }
}

#[test]
fn attributes_are_asked_for_by_name_swept_and_held() {
    let folder = folder();
    let report =
        synth(folder.path(), "two.kin --strength swaying=-0.5 --to weary=7,swaying=0.5 --seconds 4 --out o.bvh --json");
    let [weary, swaying] = [0, 1].map(|at| report["attributes"][at].clone());
    assert_eq!((weary["name"].as_str(), weary["asked"][1].as_f64()), (Some("weary"), Some(7.0)));
    assert_eq!(weary["played"], serde_json::json!([0.0, 1.0]), "held inside the range");
    assert_eq!(swaying["played"], serde_json::json!([-0.5, 0.5]));
    // The same line, the same bytes.
    let first = std::fs::read(folder.path().join("o.bvh")).unwrap();
    synth(folder.path(), "two.kin --strength swaying=-0.5 --to weary=7,swaying=0.5 --seconds 4 --out o.bvh --json");
    assert_eq!(first, std::fs::read(folder.path().join("o.bvh")).unwrap());
}

#[test]
fn strengths_follow_keys_and_the_motion_lasts_to_the_last_one() {
    let folder = folder();
    let at = folder.path();
    let report = synth(at, "two.kin --strength weary=0@1s,1@9s,swaying=0.5 --out o.bvh --json");
    let [weary, swaying] = [0, 1].map(|index| report["attributes"][index].clone());
    assert_eq!((weary["asked"].clone(), weary["keys"].as_u64()), (serde_json::json!([0.0, 1.0]), Some(2)));
    assert_eq!((swaying["asked"].clone(), swaying["keys"].as_u64()), (serde_json::json!([0.5, 0.5]), Some(1)));
    assert!((report["seconds"].as_f64().unwrap() - 9.0).abs() < 0.02, "{}", report["seconds"]);
    // Two keys at the ends are what --to does.
    let ends = |line: &str| {
        synth(at, line);
        std::fs::read(at.join("o.bvh")).unwrap()
    };
    let keyed = ends("one.kin --strength 0@0s,0.5@4s --seconds 4 --fps 32 --out o.bvh --json");
    let swept = ends("one.kin --strength 0 --to 0.5 --seconds 4 --fps 32 --out o.bvh --json");
    assert_eq!(keyed, swept);
    std::fs::write(at.join("curve.csv"), "time,strength\n0,0\n4,0.5\n").unwrap();
    assert_eq!(ends("one.kin --strength @curve.csv --seconds 4 --fps 32 --out o.bvh --json"), keyed);
    assert_eq!(
        ends("two.kin --strength weary=@curve.csv,swaying=0 --seconds 4 --fps 32 --out o.bvh --json"),
        ends("two.kin --strength weary=0@0s,0.5@4s --seconds 4 --fps 32 --out o.bvh --json")
    );
}
