//! Feet held as the device holds them, on real walks: they stand as the clip's do, and nothing shakes.

mod real;

use std::path::{Path, PathBuf};
use std::process::Command;

use real::data;
use serde_json::Value;

fn kinesic(arguments: &[&std::ffi::OsStr]) -> Value {
    let output = Command::new(env!("CARGO_BIN_EXE_kinesic")).args(arguments).output().unwrap();
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// What `kinesic apply --on pack` says of a clip: `[source, styled]`, slide in cm/s and jerk in m/s^3.
fn applied(pack: &Path, clip: &Path, feet: &str, out: &Path) -> [[f64; 2]; 2] {
    let of = |path: &Path| path.as_os_str().to_owned();
    let words =
        ["apply", "--on", "pack", "--json", "--overwrite", "--feet", feet, "--out"].map(std::ffi::OsString::from);
    let arguments: Vec<_> = words.into_iter().chain([of(out), of(pack), of(clip)]).collect();
    let said = kinesic(&arguments.iter().map(AsRef::as_ref).collect::<Vec<_>>());
    ["source", "styled"].map(|who| ["foot_slide_cm_s", "jerk_m_s3"].map(|what| said[who][what].as_f64().unwrap()))
}

#[test]
fn held_feet_slide_no_more_than_the_clips_and_nothing_shakes() {
    let Some(data) = data("held feet on real walks") else { return };
    let folder = tempfile::tempdir().unwrap();
    let mut packs = vec![PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../models/weary.kin")];
    for style in ["angry", "old", "strutting"] {
        let pack = folder.path().join(format!("{style}.kin"));
        let pair = ["neutral", style].map(|style| data.join(format!("xia/{style}_01_000.bvh")));
        let [neutral, styled] = pair.each_ref().map(|path| path.as_os_str());
        let words = ["train", "translate", "--json", "--pair"].map(std::ffi::OsStr::new);
        let arguments: Vec<_> =
            words.into_iter().chain([neutral, styled, "--out".as_ref(), pack.as_os_str()]).collect();
        kinesic(&arguments);
        packs.push(pack);
    }
    let out = folder.path().join("out.bvh");
    println!("| pack | clip | slide, cm/s | free | live | lock | jerk, m/s^3: free | live | lock |");
    println!("|---|---|---|---|---|---|---|---|---|");
    for pack in &packs {
        for clip in ["cmu31/07_01", "cmu31/08_01", "cmu31/35_01", "m21/style/DEPRESSED"] {
            let path = data.join(format!("{clip}.bvh"));
            let [free, live, lock] = ["free", "live", "lock"].map(|feet| applied(pack, &path, feet, &out));
            let ([[slide, _], [free, rough]], [_, [live, shaken]], [_, [lock, locked]]) = (free, live, lock);
            let name = pack.file_stem().unwrap().to_string_lossy();
            println!(
                "| {name} | {clip} | {slide:.1} | {free:.1} | {live:.1} | {lock:.1} | {rough:.0} | {shaken:.0} | {locked:.0} |"
            );
            assert!(free > 1.3 * slide, "{name}, {clip}: free feet slide at {free}, the clip's at {slide}");
            assert!(live < 1.1 * slide, "{name}, {clip}: held feet slide at {live}, the clip's at {slide}");
            assert!(shaken < 1.3 * rough, "{name}, {clip}: jerk {shaken}, of the free one {rough}");
        }
    }
}
