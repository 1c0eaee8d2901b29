//! The pictures of the README: `docs/pictures.sh` writes them, from the program's own walks and faces.
//!
//! Drawings are compared with the committed ones; screenshots depend on the browser and its fonts, and are made anew only.

mod drawn;

use std::path::Path;
use std::sync::Arc;

use kinesic_firmware_sim::browser::Browser;
use kinesic_host::clip::{Clip, JointMap, ReadOptions};
use kinesic_host::emotion;
use kinesic_host::gait::{Manner, walk};
use kinesic_host::models;
use kinesic_host::pack::{PackFile, Provenance};
use kinesic_host::prepare::Source;
use kinesic_host::report::latency;
use kinesic_host::rig::Rig;
use kinesic_host::robot::Machine;
use kinesic_host::sheet::{self, Actor, sheet};
use kinesic_host::translate::{Settings, play};
use kinesic_host::view::{self, View, ViewClip, ViewPack};

/// Writes a picture with `KINESIC_PICTURES=write`; the committed one must be there.
fn keep(name: &str, made: &[u8]) -> Vec<u8> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/pictures").join(name);
    if std::env::var("KINESIC_PICTURES").as_deref() == Ok("write") {
        std::fs::write(&path, made).unwrap();
    }
    std::fs::read(&path).unwrap()
}

fn drawing(name: &str, svg: &str) {
    assert!(keep(name, svg.as_bytes()) == svg.as_bytes(), "docs/pictures/{name} is out of date: run docs/pictures.sh");
}

/// A walk as in `kinesic demo`.
fn made(manner: &Manner, seed: u64) -> Clip {
    walk(manner, 6.0 * Manner::NEUTRAL.cadence / manner.cadence, 60.0, 0.3, 1000 + seed)
}

#[test]
fn walks_before_and_after() {
    let (source, target) = (made(&Manner::NEUTRAL, 3), made(&Manner::WEARY, 4));
    let file = models::weary();
    let pack = file.pack().unwrap();
    let rig = Rig::from_pack(&pack).unwrap();
    let [source, target] = [source, target].map(|clip| {
        let map = JointMap::detect(&clip.skeleton).unwrap();
        Source::new("made", clip, map).on_rig(&rig, 60.0).unwrap()
    });
    let result = play(&pack, &rig, &source, &Settings::default()).unwrap();
    let rows = [("a walk", &source), ("through models/weary.kin", &result), ("the same walk, weary", &target)];
    let rows = rows.map(|(name, clip)| {
        let actor = Actor::body(name, clip.clone(), JointMap::detect(&clip.skeleton).as_ref());
        let moments = actor.even(8);
        (actor, moments)
    });
    // On white: pages are read on dark grounds too.
    let svg = sheet(&rows, sheet::View::Oblique, 120.0).unwrap().svg().replacen(
        ">\n",
        ">\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n",
        1,
    );
    drawing("walk.svg", &svg);
}

/// Bars: share of 1/60 s by core and workload, on a logarithmic axis from 0.1 to 1000 percent.
#[test]
fn shares_of_a_frame() {
    const COLOURS: [&str; 5] = ["#0072b2", "#56b4e9", "#d55e00", "#e69f00", "#009e73"];
    let workloads: Vec<_> =
        ["translator", "mechanics", "components"].into_iter().flat_map(latency::workloads).collect();
    let (left, width, bar) = (170.0, 520.0, 9.0);
    let x = |percent: f64| left + width * (percent.log10() + 1.0) / 4.0;
    let group = bar * workloads.len() as f64 + 14.0;
    let height = 70.0 + group * latency::CORES.len() as f64;
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"760\" height=\"{height}\" viewBox=\"0 0 760 {height}\" font-family=\"sans-serif\" \
         font-size=\"12\" role=\"img\">\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n"
    );
    for (k, workload) in workloads.iter().enumerate() {
        let at = 20.0 + 145.0 * k as f64;
        svg += &format!("<rect x=\"{at}\" y=\"10\" width=\"11\" height=\"11\" fill=\"{}\"/>", COLOURS[k]);
        svg += &format!("<text x=\"{}\" y=\"20\">{}</text>\n", at + 16.0, workload.name);
    }
    for percent in [0.1, 1.0, 10.0, 100.0, 1000.0] {
        let (at, bottom) = (x(percent), height - 28.0);
        let colour = if percent == 100.0 { "#c00" } else { "#ccc" };
        svg += &format!("<path d=\"M{at:.1} 34V{bottom}\" stroke=\"{colour}\"/>");
        svg += &format!(
            "<text x=\"{at:.1}\" y=\"{}\" text-anchor=\"middle\" fill=\"#555\">{percent} %</text>\n",
            bottom + 16.0
        );
    }
    for (row, core) in latency::CORES.iter().enumerate() {
        let top = 40.0 + group * row as f64;
        let middle = top + group / 2.0 - 3.0;
        svg += &format!("<text x=\"{}\" y=\"{middle:.1}\" text-anchor=\"end\">{core}</text>\n", left - 8.0);
        for (k, workload) in workloads.iter().enumerate() {
            let end = x(f64::from(workload.microseconds[row]) * 60.0 / 1e4);
            let y = top + bar * k as f64;
            svg += &format!(
                "<rect x=\"{left}\" y=\"{y:.1}\" width=\"{:.1}\" height=\"{}\" fill=\"{}\"/>\n",
                end - left,
                bar - 1.0,
                COLOURS[k]
            );
        }
    }
    svg += "</svg>\n";
    drawing("latency.svg", &svg);
}

fn screenshot(name: &str, shown: &View, script: &str, size: [u32; 2]) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("page.html");
    std::fs::write(&path, view::page("kinesic", "made for the README", shown, view::WASM).unwrap()).unwrap();
    let mut at = Browser::open(&path, size, false).unwrap();
    at.wait("typeof kinesic === 'object' && kinesic.compared").unwrap();
    at.value(script).unwrap();
    at.wait("kinesic.results.every((r) => r.done === r.frames && !r.changed) && !kinesic.face?.waiting").unwrap();
    // What was drawn before this is old.
    at.value("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))").unwrap();
    let picture = at.screenshot().unwrap();
    assert!(at.errors.is_empty() && picture.len() > 10_000);
    assert!(keep(name, &picture).starts_with(b"\x89PNG"));
}

#[test]
#[ignore = "needs chromium: firmware-sim/setup.sh"]
fn the_live_page() {
    let source = |manner: &Manner, seed: u64| {
        let clip = made(manner, seed);
        let map = JointMap::detect(&clip.skeleton).unwrap();
        Source::new("made", clip, map)
    };
    let packs = [("weary", models::weary()), ("mechanics", models::mechanics())];
    let clip = ViewClip {
        name: "a made-up walk".to_owned(),
        source: source(&Manner::NEUTRAL, 3),
        target: Some(source(&Manner::WEARY, 4)),
    };
    let packs = packs.map(|(name, file)| ViewPack { name: name.to_owned(), file, look: None }).to_vec();
    let shown = View { packs, clips: vec![clip], ..View::default() };
    screenshot("page.png", &shown, "document.getElementById('play').click(); seek(2.1)", [1200, 860]);
}

/// The desk robot of `docs/robot.md`.
#[test]
#[ignore = "needs chromium: firmware-sim/setup.sh"]
fn a_desk_robot() {
    let pack = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/board/examples/desk/lively.kin");
    let file = PackFile::read(&pack).unwrap();
    let machine = Machine::from_pack(&file.pack().unwrap()).unwrap();
    let row = |at: u32| {
        let t = f64::from(at) / 50.0;
        let swing = |rate: f64, most: f64| most * (rate * t).sin();
        let angles = [swing(1.1, 25.0), swing(1.7, 10.0), swing(2.3, 20.0), swing(3.1, -20.0)];
        format!("{t},{}\n", angles.map(|angle| angle.to_string()).join(","))
    };
    let rows: String = (0..400).map(row).collect();
    let moves = tempfile::Builder::new().suffix(".csv").tempfile().unwrap();
    let text = format!("time_s,pan_deg,tilt_deg,left_antenna_deg,right_antenna_deg\n{rows}");
    std::fs::write(moves.path(), text).unwrap();
    let options = ReadOptions { machine: machine.map(Arc::new), ..ReadOptions::default() };
    let source = Source::read(moves.path(), &options).unwrap();
    let packs = vec![ViewPack { name: "lively".to_owned(), file, look: None }];
    let clips = vec![ViewClip { name: "a calm move".to_owned(), source, target: None }];
    let shown = View { packs, clips, ..View::default() };
    screenshot("robot.png", &shown, "document.getElementById('play').click(); seek(4.4)", [1100, 620]);
}

#[test]
#[ignore = "needs chromium: firmware-sim/setup.sh"]
fn emotions() {
    let (model, rig) = emotion::synthetic::model(2);
    let file = PackFile::from_bytes(&model.pack(&rig, &Provenance::default()));
    let emotions = vec![ViewPack { name: "moods".to_owned(), file, look: None }];
    let shown = View { emotions, ..View::default() };
    let script = "play(false); const moved = document.getElementById('emotion-0-1'); moved.value = 1; \
        moved.dispatchEvent(new Event('input')); seek(0.78)";
    screenshot("emotion.png", &shown, script, [1000, 600]);
}

#[test]
#[ignore = "needs chromium: firmware-sim/setup.sh"]
fn a_drawn_face() {
    let (file, faces) = drawn::faces();
    let face_packs = vec![ViewPack { name: "smile".to_owned(), file, look: None }];
    let shown = View { face_packs, faces: faces[..1].to_vec(), ..View::default() };
    screenshot("face.png", &shown, "kinesic.face.turn(0.9)", [1000, 640]);
}
