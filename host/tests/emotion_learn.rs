//! Emotion strength of bodies: made walks of known weariness, then real clips of known blends and styles.

use std::path::Path;

use kinesic::Pose;
use kinesic_host::clip::{JointMap, ReadOptions};
use kinesic_host::emotion::evaluate::{Scorer, evaluate, mean};
use kinesic_host::emotion::features::features;
use kinesic_host::emotion::keyframes::Keyframes;
use kinesic_host::emotion::labels::{self, Attribute, Labelled};
use kinesic_host::emotion::motions::{self, Example};
use kinesic_host::emotion::play::{Settings, play};
use kinesic_host::emotion::segment::{Cut, FRAME_RATE, cut};
use kinesic_host::emotion::{TrainError, TrainOptions, Trained, train};
use kinesic_host::gait::{Manner, skeleton, walk};
use kinesic_host::learn::spearman;
use kinesic_host::pack::{PackFile, Provenance};
use kinesic_host::rig::{MAX_JOINTS, Rig};
use kinesic_tests::{data, table};
use nalgebra::{UnitQuaternion, Vector4};

fn rig() -> Rig {
    let skeleton = skeleton();
    Rig::new(&skeleton, &JointMap::detect(&skeleton).unwrap()).unwrap()
}

/// A walk of this weariness.
fn manner(weary: f64) -> Manner {
    let between = |a: f64, b: f64| a + weary * (b - a);
    let (a, b) = (Manner::NEUTRAL, Manner::WEARY);
    Manner {
        cadence: between(a.cadence, b.cadence),
        stride: between(a.stride, b.stride),
        knee: between(a.knee, b.knee),
        arms: between(a.arms, b.arms),
        elbows: between(a.elbows, b.elbows),
        stoop: between(a.stoop, b.stoop),
        nod: between(a.nod, b.nod),
        sway: between(a.sway, b.sway),
    }
}

fn examples(levels: &[f64], seed: u64) -> Vec<Example> {
    let one = |(index, level): (usize, &f64)| {
        let seed = seed + index as u64;
        let clip = walk(&manner(*level), 8.0, FRAME_RATE, 0.13 * seed as f64 % 1.0, seed);
        Example { name: format!("walk {index}"), clip, levels: vec![Some(*level)], group: 0, take: index }
    };
    levels.iter().enumerate().map(one).collect()
}

const LEVELS: [f64; 9] = [0.0, 0.0, 0.0, 0.5, 0.5, 0.5, 1.0, 1.0, 1.0];

fn trained() -> Trained {
    train(&rig(), "walk", &["weary".to_owned()], &examples(&LEVELS, 1), &TrainOptions::default()).unwrap()
}

fn packed(trained: &Trained) -> PackFile {
    PackFile::from_bytes(&trained.model.pack(&trained.rig, &Provenance::default()))
}

#[test]
fn unseen_walks_are_read_and_what_is_asked_for_is_played() {
    let trained = trained();
    assert_eq!(trained.cut, Cut::Cycles);
    assert!(trained.keyframe_error < 0.02 && trained.network_error < 0.05, "{trained:?}");
    let file = packed(&trained);
    let pack = file.pack().unwrap();
    let scorer = Scorer::load(&pack).unwrap();
    let others = examples(&[0.1, 0.25, 0.4, 0.6, 0.75, 0.9], 50);
    let report = evaluate(&scorer, &others);
    assert!(report.pair_accuracy > 0.95 && report.spearman > 0.95 && report.pairs == 15, "{report:?}");
    for example in &others {
        let strength = mean(&scorer.read(&example.clip))[0];
        assert!((strength - example.levels[0].unwrap()).abs() < 0.15, "{} {strength}", example.levels[0].unwrap());
    }
    let (mut asked, mut read) = (Vec::new(), Vec::new());
    for step in 0..=10 {
        let strength = 0.1 * step as f32;
        let asks = [strength, 0.0, 0.0, 0.0];
        let played = play(&pack, &Settings { from: asks, to: asks, fps: FRAME_RATE, seconds: Some(8.0) }).unwrap();
        asked.push(f64::from(strength));
        read.push(mean(&scorer.read(&played.clip))[0]);
    }
    assert!(spearman(&asked, &read) > 0.99, "{read:?}");
    assert!(asked.iter().zip(&read).all(|(a, b)| (a - b).abs() < 0.15), "{read:?}");
}

#[test]
fn a_pack_reads_as_the_training_did() {
    let trained = trained();
    let file = packed(&trained);
    let pack = file.pack().unwrap();
    let scorer = Scorer::load(&pack).unwrap();
    let clip = &examples(&LEVELS, 1)[4].clip;
    let reading = &trained.model.reading;
    let keyframes = Keyframes { parts: reading.parts.clone(), postures: reading.postures.clone() };
    let read = scorer.read(clip);
    assert!(!read.is_empty());
    for (motion, read) in cut(&rig(), clip, Cut::Cycles).iter().zip(&read) {
        let features = features(motion, &keyframes).unwrap();
        let sum: f64 = reading.rank.iter().zip(&features).map(|(w, x)| w * x).sum();
        assert!((sum + reading.bias[0] - read[0]).abs() < 1e-3, "{sum} {read:?}");
    }
    // A whole clip of known weariness is read about so.
    assert!((mean(&read)[0] - 0.5).abs() < 0.15, "{read:?}");
}

/// The network's motions turn heads, hands and twists as the clips do: no joint is left where it was.
#[test]
fn every_joint_that_turns_in_the_clips_turns_with_the_strength() {
    let trained = trained();
    let file = packed(&trained);
    let pack = file.pack().unwrap();
    let mean_turn = |poses: &[Pose<MAX_JOINTS>], others: &[Pose<MAX_JOINTS>], joint: usize| {
        let sum = |poses: &[Pose<MAX_JOINTS>]| {
            let first = poses[0].rotations[joint];
            let sign = |q: &UnitQuaternion<f32>| if q.coords.dot(&first.coords) < 0.0 { -q.coords } else { q.coords };
            poses.iter().map(|pose| sign(&pose.rotations[joint])).fold(Vector4::zeros(), |a, b| a + b)
        };
        let [a, b] = [sum(poses), sum(others)].map(|sum| UnitQuaternion::new_normalize(sum.into()));
        a.angle_to(&b).to_degrees()
    };
    let played = [0.0, 1.0].map(|strength| {
        let asked = [strength, 0.0, 0.0, 0.0];
        play(&pack, &Settings { from: asked, to: asked, fps: FRAME_RATE, seconds: None }).unwrap().clip
    });
    let rig = rig();
    let played = played.map(|clip| rig.poses(&clip));
    let clips = [0.0, 1.0].map(|weary| rig.poses(&walk(&manner(weary), 8.0, FRAME_RATE, 0.1, 77)));
    let mut turned = 0;
    for joint in 1..rig.joints() {
        let [made, real] = [&played, &clips].map(|[from, to]| mean_turn(from, to, joint));
        assert!((made - real).abs() < 1.5 + 0.15 * real, "joint {joint}: {made} of {real} degrees");
        turned += usize::from(real > 3.0);
    }
    assert!(turned >= 3, "{turned} joints turn");
}

#[test]
fn the_same_seed_gives_the_same_bytes() {
    assert!(packed(&trained()).bytes() == packed(&trained()).bytes());
}

#[test]
fn what_teaches_nothing_is_refused() {
    let rig = rig();
    let all = |examples: &[Example], options: &TrainOptions| {
        train(&rig, "walk", &["weary".to_owned()], examples, options).unwrap_err()
    };
    let walks = examples(&LEVELS, 1);
    let wrong = TrainOptions { keyframes: 2, ..TrainOptions::default() };
    assert!(matches!(all(&walks, &wrong), TrainError::Option { what: "keyframes", found: 2, .. }));
    let options = TrainOptions::default();
    assert!(matches!(all(&walks[..3], &options), TrainError::Alike { .. }));
    assert!(matches!(all(&[], &options), TrainError::Few { found: 0, .. }));
    assert!(matches!(train(&rig, "walk", &[], &walks, &options).unwrap_err(), TrainError::Attributes { found: 0 }));
    // A stride of three frames is no motion of thirteen keyframes.
    let mut short = walks;
    short.iter_mut().for_each(|example| example.clip = example.clip.slice(0..10));
    assert!(matches!(all(&short, &options), TrainError::Few { .. }));
}

#[test]
fn the_commands_work_together() {
    let folder = tempfile::tempdir().unwrap();
    let kinesic = |args: &str| {
        let run = std::process::Command::new(env!("CARGO_BIN_EXE_kinesic"))
            .args(args.split(' '))
            .current_dir(folder.path())
            .output()
            .unwrap();
        (run.status.success(), String::from_utf8(run.stdout).unwrap() + &String::from_utf8(run.stderr).unwrap())
    };
    let succeed = |args: &str| {
        let (success, text) = kinesic(args);
        assert!(success, "{args}: {text}");
        text
    };
    let mut rows = String::from("file\tlabel\tweariness\n");
    for (index, example) in examples(&LEVELS, 1).iter().enumerate() {
        example.clip.write(folder.path().join(format!("{index}.bvh"))).unwrap();
        let level = example.levels[0].unwrap();
        let label = if level < 0.3 {
            "fresh"
        } else if level < 0.7 {
            "calm"
        } else {
            "weary"
        };
        rows += &format!("{index}.bvh\t{label}\t{level}\n");
    }
    std::fs::write(folder.path().join("walks.tsv"), rows).unwrap();
    let text = succeed("train emotion --labels walks.tsv --order weary>calm>fresh --out walk.kin");
    assert!(text.contains("held out, weary") && text.contains("every stride"), "{text}");
    assert!(folder.path().join("walk.report.html").exists());
    // The pack knows its order.
    let json = |args: &str| serde_json::from_str::<serde_json::Value>(&succeed(args)).unwrap();
    let report = json("eval emotion walk.kin --labels walks.tsv --json");
    assert!(report["pair_accuracy"].as_f64().unwrap() > 0.95 && report["pairs"] == 27, "{report}");
    assert!(report["spearman"].as_f64().unwrap() > 0.9);
    let scores = json("score walk.kin 0.bvh 8.bvh --json");
    let of = |clip: usize| scores["clips"][clip]["strength"][0].as_f64().unwrap();
    assert!(of(0) < 0.3 && of(1) > 0.7, "{scores}");
    assert!(succeed("score walk.kin 0.bvh").contains("0.bvh"));
    succeed("synth walk.kin --strength 0.5 --out half.bvh");
    let half = json("score walk.kin half.bvh --json")["clips"][0]["strength"][0].as_f64().unwrap();
    assert!((half - 0.5).abs() < 0.15, "{half}");
    succeed("train emotion --labels walks.tsv --attribute weariness --hold-out 0 --no-report --out column.kin --json");
    assert!(succeed("eval emotion column.kin --labels walks.tsv").contains("weariness"));
    for (args, why) in [
        ("train emotion --labels walks.tsv --out a.kin", "--order"),
        ("train emotion --labels walks.tsv --order weary>gloomy --out a.kin", "gloomy"),
        ("train emotion --labels walks.tsv --order weary>weary --out a.kin", "twice"),
        ("train emotion --labels walks.tsv --attribute mood --out a.kin", "mood"),
        ("train emotion --labels walks.tsv --attribute label --out a.kin", "walks.tsv:2"),
        ("train emotion --labels walks.tsv --order weary>calm --keyframes 99 --out a.kin", "99 keyframes"),
        ("eval emotion walk.kin --labels walks.tsv --order calm>fresh", "weary"),
    ] {
        let (success, text) = kinesic(args);
        let squeezed: String = text.chars().filter(|c| !c.is_whitespace() && *c != '│').collect();
        let why: String = why.chars().filter(|c| !c.is_whitespace()).collect();
        assert!(!success && squeezed.contains(&why), "{args}: {text}");
    }
    assert!(!folder.path().join("a.kin").exists());
}

/// Examples of a part of the manifest.
fn real(folder: &Path, rows: Vec<Labelled>, rig: Option<Rig>) -> (Rig, Vec<Example>) {
    let (rig, examples) = motions::read(rows, rig, &ReadOptions::default(), &|_| ()).unwrap();
    assert!(!examples.is_empty(), "{}", folder.display());
    (rig.unwrap(), examples)
}

#[test]
fn known_blend_weights_of_real_walks_are_read() {
    let Some(folder) = data("known_blend_weights_of_real_walks_are_read") else { return };
    // `walk_fast:0.0+walk_angry:0.5+walk_regular:0.5`: walks alone. Trained on corners and middles, read between.
    let (mut known, mut between) = (Vec::new(), Vec::new());
    for (take, row) in table(&folder.join("manifest.tsv")).iter().enumerate() {
        if !row["file"].starts_with("aalto/") || row["action"] != "walk" {
            continue;
        }
        let part = |part: &str| part.split_once(':').map(|(n, w)| (n.to_owned(), w.parse::<f64>().unwrap())).unwrap();
        let parts: Vec<(String, f64)> = row["style"].split('+').map(part).collect();
        let of = |name: &str| parts.iter().filter(|(n, _)| n.ends_with(name)).map(|(_, w)| w).sum::<f64>();
        let levels = vec![Some(of("_angry")), Some(of("_sad"))];
        let row = Labelled { path: folder.join(&row["file"]), levels, group: 0, take };
        let inside = parts.iter().any(|(_, weight)| ![0.0, 0.5, 1.0].contains(weight));
        if inside { between.push(row) } else { known.push(row) }
    }
    let (rig, known) = real(&folder, known, None);
    let (rig, between) = real(&folder, between, Some(rig));
    let names = ["angry".to_owned(), "sad".to_owned()];
    let trained = train(&rig, "walk", &names, &known, &TrainOptions::default()).unwrap();
    let file = packed(&trained);
    let pack = file.pack().unwrap();
    let report = evaluate(&Scorer::load(&pack).unwrap(), &between);
    println!("{report:?}");
    assert!(report.unread.is_empty());
    assert!(report.attributes.iter().all(|a| a.spearman > 0.8 && a.pair_accuracy > 0.9), "{report:?}");
}

#[test]
fn styles_of_unseen_takes_are_put_in_order() {
    let Some(folder) = data("styles_of_unseen_takes_are_put_in_order") else { return };
    let order = Attribute::from_order("active>normal>exhausted").unwrap();
    for (action, cut, least) in [("walk", Cut::Cycles, 0.9), ("raise-up-both-hands", Cut::Whole, 0.9)] {
        let list = tempfile::tempdir().unwrap();
        let mut rows = String::from("file\tlabel\n");
        for row in table(&folder.join("manifest.tsv")) {
            if row["file"].starts_with("bandai2/") && row["action"] == action {
                rows += &format!("{}\t{}\n", folder.canonicalize().unwrap().join(&row["file"]).display(), row["style"]);
            }
        }
        let path = list.path().join("labels.tsv");
        std::fs::write(&path, rows).unwrap();
        let rows = labels::read(&path, std::slice::from_ref(&order)).unwrap();
        assert_eq!(rows.len(), 12);
        // Takes 1 and 2 of each style teach, 3 and 4 are read.
        let second = |row: &Labelled| {
            row.path.to_string_lossy().ends_with("3.bvh") || row.path.to_string_lossy().ends_with("4.bvh")
        };
        let (held, kept): (Vec<_>, Vec<_>) = rows.into_iter().partition(second);
        let (rig, kept) = real(&folder, kept, None);
        let (rig, held) = real(&folder, held, Some(rig));
        let trained = train(&rig, action, std::slice::from_ref(&order.name), &kept, &TrainOptions::default()).unwrap();
        assert_eq!(trained.cut, cut, "{action}");
        let file = packed(&trained);
        let pack = file.pack().unwrap();
        let report = evaluate(&Scorer::load(&pack).unwrap(), &held);
        println!("{action}: {report:?}");
        assert!(report.pairs == 12 && report.pair_accuracy > least, "{report:?}");
    }
}
