//! Skeleton maps without names: every real clip, and the command from an unknown skeleton to a motion in style.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Command, Output};

use kinesic_host::clip::map::{Sure, suggest};
use kinesic_host::clip::{self, Canonical, Clip, JointMap, ReadOptions, Unit, UpAxis, WriteOptions};
use kinesic_tests::{data, table};

fn bare(clip: &Clip) -> Clip {
    let mut bare = clip.clone();
    bare.skeleton.joints.iter_mut().enumerate().for_each(|(at, joint)| joint.name = format!("j{at}"));
    bare
}

/// What became of the clips of one skeleton.
#[derive(Default)]
struct Tally {
    clips: usize,
    right: usize,
    sides: usize,
    unsure: usize,
    refused: usize,
}

#[test]
fn real_clips_are_read_without_their_names() {
    let Some(folder) = data("real_clips_are_read_without_their_names") else { return };
    let mut tallies: BTreeMap<String, Tally> = BTreeMap::new();
    let mut faults = Vec::new();
    for row in table(&folder.join("manifest.tsv")) {
        let file = &row["file"];
        let clip = clip::read(folder.join(file)).unwrap_or_else(|e| panic!("{e}"));
        let known = JointMap::detect(&clip.skeleton).expect("a known layout");
        let tally = tallies.entry(row["skeleton"].clone()).or_default();
        tally.clips += 1;
        let Ok(made) = suggest(&bare(&clip)) else {
            tally.refused += 1;
            faults.push(format!("{file}: refused"));
            continue;
        };
        let differs = |of: &dyn Fn(Canonical) -> Canonical| {
            let differ = |c: &Canonical| known.joint(of(*c)) != made.map.joint(*c);
            Canonical::ALL.into_iter().filter(differ).map(Canonical::name).collect::<Vec<_>>()
        };
        tally.unsure += usize::from(made.sides.sure < Sure::Certain);
        match differs(&|c| c) {
            none if none.is_empty() => tally.right += 1,
            _ if differs(&Canonical::mirrored).is_empty() => {
                tally.sides += 1;
                // A wrong side is allowed only where it was said to be a guess.
                assert_eq!(made.sides.sure, Sure::Open, "{file}: left and right exchanged");
            }
            joints => faults.push(format!("{file}: {}", joints.join(" "))),
        }
    }
    eprintln!(
        "{:<10} {:>6} {:>6} {:>16} {:>14} {:>8}",
        "skeleton", "clips", "right", "sides exchanged", "sides unsure", "refused"
    );
    for (skeleton, t) in &tallies {
        eprintln!("{skeleton:<10} {:>6} {:>6} {:>16} {:>14} {:>8}", t.clips, t.right, t.sides, t.unsure, t.refused);
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    let sum = |of: fn(&Tally) -> usize| tallies.values().map(of).sum::<usize>();
    assert!(sum(|t| t.clips) > 900 && sum(|t| t.sides) <= 2, "{} clips, {}", sum(|t| t.clips), sum(|t| t.sides));
}

fn kinesic(line: &str, folder: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_kinesic")).args(line.split(' ')).current_dir(folder).output().unwrap()
}

fn done(line: &str, folder: &Path) -> (String, String) {
    let output = kinesic(line, folder);
    let [out, err] = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap());
    assert!(output.status.success(), "{line}: {err}");
    (out, err)
}

/// Why a command failed, without the wrapping.
fn refused(line: &str, folder: &Path) -> String {
    let output = kinesic(line, folder);
    assert_eq!(output.status.code(), Some(1), "{line}");
    let text = String::from_utf8(output.stderr).unwrap();
    text.split_whitespace().filter(|word| *word != "│").collect::<Vec<_>>().join(" ")
}

/// The demo's files, and its walk without names.
fn demo() -> (tempfile::TempDir, Clip) {
    let folder = tempfile::tempdir().unwrap();
    done("demo --out .", folder.path());
    let clip = clip::read(folder.path().join("unseen.bvh")).unwrap();
    bare(&clip).write_bvh(folder.path().join("bare.bvh")).unwrap();
    (folder, clip)
}

#[test]
fn an_unknown_skeleton_is_mapped_and_played() {
    let (folder, clip) = demo();
    let at = folder.path();
    let message = refused("apply weary.kin bare.bvh --out out.bvh", at);
    assert!(message.contains("`kinesic inspect --suggest-map 'bare.bvh' > map.toml`"), "{message}");
    let (toml, notes) = done("inspect --suggest-map bare.bvh", at);
    for part in ["[joints]\npelvis = \"j0\"", "Left and right: certain", "# l_collar: found no joint"] {
        assert!(toml.contains(part), "no {part} in: {toml}");
    }
    for part in ["nothing uses it until", "With this map: Units: cm assumed", "a leg (hip to ankle)"] {
        assert!(notes.contains(part), "no {part} in: {notes}");
    }
    std::fs::write(at.join("map.toml"), &toml).unwrap();
    done("apply weary.kin bare.bvh --map map.toml --out mapped.bvh", at);
    done("apply weary.kin unseen.bvh --out named.bvh", at);
    let [mapped, named] = ["mapped.bvh", "named.bvh"].map(|file| clip::read(at.join(file)).unwrap().all_positions());
    let off = mapped.iter().zip(&named).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
    assert!(mapped.len() == named.len() && off < 1e-4, "{off} m");
    let (json, _) = done("inspect --suggest-map bare.bvh --json", at);
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!((json["joints"][0][1].as_str(), json["limbs"].as_str()), (Some("j0"), Some("certain")));
    assert_eq!(json["map"].as_str(), Some(toml.as_str()));
    // Known names need none, and agree.
    let (_, notes) = done("inspect --suggest-map unseen.bvh", at);
    assert!(notes.contains("known layout") && notes.contains("agrees with it"), "{notes}");
    assert!(JointMap::detect(&clip.skeleton).is_some());
}

#[test]
fn axes_and_units_are_found_with_the_map() {
    let (folder, _) = demo();
    let at = folder.path();
    // Z up, and of a size that no unit makes a person of.
    let read = ReadOptions { units: Some(Unit::Factor(0.025)), up: Some(UpAxis::NegZ), ..ReadOptions::default() };
    let odd = clip::read_with(at.join("bare.bvh"), &read).unwrap();
    let text = odd.to_bvh(&WriteOptions::default()).unwrap();
    std::fs::write(at.join("odd.bvh"), text).unwrap();
    assert!(refused("inspect odd.bvh", at).contains("unit of length cannot be told"));
    let (toml, notes) = done("inspect --suggest-map odd.bvh", at);
    assert!(toml.contains("l_knee = \"j2\"") && toml.contains("r_knee = \"j6\""), "{toml}");
    assert!(notes.contains("unit of length could not be told") && notes.contains("--units"), "{notes}");
    let (_, notes) = done("inspect --suggest-map odd.bvh --units 0.004", at);
    assert!(notes.contains("With this map: Z up found") || notes.contains("With this map: -Z up found"), "{notes}");
}

#[test]
fn what_is_no_body_is_refused() {
    let (folder, clip) = demo();
    let at = folder.path();
    let mut trunk = clip;
    let mut keep: Vec<bool> = trunk.skeleton.joints.iter().map(|j| !j.name.contains("Arm")).collect();
    keep.iter_mut().zip(&trunk.skeleton.joints).for_each(|(k, j)| *k &= !j.name.contains("Hand"));
    trunk = trunk.with_joints(&mut keep);
    trunk.write_bvh(at.join("legs.bvh")).unwrap();
    let cases = [
        ("inspect --suggest-map legs.bvh --units cm", ["legs.bvh", "could be arms", "by hand"]),
        ("inspect --suggest-map weary.kin", ["weary.kin", "found a pack", "name a clip"]),
        ("inspect --suggest-map gone.bvh", ["gone.bvh", "no such file", "path"]),
    ];
    for (line, parts) in cases {
        let message = refused(line, at);
        for part in parts {
            assert!(message.contains(part), "{line}: no {part} in: {message}");
        }
    }
    let both = kinesic("inspect --suggest-map unseen.bvh --map map.toml", at);
    assert_eq!(both.status.code(), Some(2));
}
