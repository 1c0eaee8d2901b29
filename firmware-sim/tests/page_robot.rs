//! Robots on the page of `kinesic view`, in headless Chromium: bits, links, solids.

mod visit;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use kinesic_firmware_sim::browser::Browser;
use kinesic_host::clip::{Clip, ReadOptions};
use kinesic_host::moves;
use kinesic_host::pack::{PackFile, Provenance};
use kinesic_host::prepare::Source;
use kinesic_host::robot::look::Look;
use kinesic_host::robot::{Defaults, Machine, Robot, ServoTable};
use kinesic_host::translate::{TrainOptions, TrainPair, train};
use kinesic_host::view::{self, View, ViewClip, ViewPack};
use serde_json::json;
use visit::{apart, dark, fits, pose, set, shot, state, well};

/// A mast that slides, a head that turns on it, a follower of that.
const CRANE: &str = r#"<robot name="crane"><link name="base"><visual><geometry><box size="0.2 0.2 0.1"/></geometry></visual></link>
  <link name="mast"><visual><geometry><cylinder radius="0.02" length="0.4"/></geometry></visual></link>
  <link name="head"><visual><geometry><box size="0.1 0.1 0.1"/></geometry><material name="red"><color rgba="1 0 0 1"/></material></visual></link>
  <link name="flag"><visual><origin xyz="0.1 0 0"/><geometry><box size="0.2 0.01 0.1"/></geometry></visual></link>
  <joint name="lift" type="prismatic"><parent link="base"/><child link="mast"/><origin xyz="0 0 0.2"/><axis xyz="0 0 1"/>
    <limit lower="0" upper="0.3" velocity="1" effort="1"/></joint>
  <joint name="turn" type="revolute"><parent link="mast"/><child link="head"/><origin xyz="0 0 0.2" rpy="0.2 0 0"/><axis xyz="0 0 1"/>
    <limit lower="-2" upper="2" velocity="3" effort="1"/></joint>
  <joint name="wave" type="revolute"><parent link="head"/><child link="flag"/><origin xyz="0.05 0 0"/><axis xyz="0 0 1"/>
    <limit lower="-9" upper="9" velocity="3" effort="1"/><mimic joint="turn" multiplier="2" offset="0.1"/></joint></robot>"#;

/// A page of a pack that plays these moves of a robot, and of the look of it.
fn robot_page(folder: &Path, file: PackFile, look: Option<Look>, moves: &str) -> PathBuf {
    let machine = Machine::from_pack(&file.pack().unwrap()).unwrap().unwrap();
    std::fs::write(folder.join("m.csv"), moves).unwrap();
    let options = ReadOptions { machine: Some(Arc::new(machine)), ..ReadOptions::default() };
    let source = Source::read(&folder.join("m.csv"), &options).unwrap();
    let packs = vec![ViewPack { name: "lively".to_owned(), file, look }];
    let clips = vec![ViewClip { name: "a move".to_owned(), source, target: None }];
    let shown = View { packs, clips, ..View::default() };
    let path = folder.join("page.html");
    std::fs::write(&path, view::page("kinesic", "made by a test", &shown, view::WASM).unwrap()).unwrap();
    path
}

/// A style from one move to another, in a pack with the machine.
fn pack(machine: &Machine, [calm, lively]: [&str; 2]) -> PackFile {
    let clip = |text: &str| -> Clip {
        let read = moves::parse(text.as_bytes(), Path::new("m.csv"), &moves::Options::default());
        machine.clip(&read.unwrap(), None).unwrap()
    };
    let [source, target] = [calm, lively].map(|moves| machine.rig.locals_of(&clip(moves)));
    let [source_name, target_name] = ["calm", "lively"].map(str::to_owned);
    let pair = TrainPair { source_name, target_name, source, target };
    let trained = train(&machine.rig, &[pair], "lively", 50.0, &TrainOptions::default(), &|_| {}).unwrap();
    let style = PackFile::from_bytes(&trained.model.pack(&machine.rig, &Provenance::default()));
    PackFile::from_bytes(&machine.pack(Some(&style.pack().unwrap()), &Provenance::default()).unwrap())
}

#[test]
#[ignore = "needs chromium: firmware-sim/setup.sh"]
fn a_robot_s_style_has_the_bits_of_the_host() {
    let folder = tempfile::tempdir().unwrap();
    let desk = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/board/examples/desk/lively.kin");
    let rows: String =
        (0..200).map(|at| format!("{},{},{},9,-9\n", f64::from(at) / 50.0, at % 60 - 30, (at / 7) % 20)).collect();
    let moves = format!("time_s,pan_deg,tilt_deg,left_antenna_deg,right_antenna_deg\n{rows}");
    let path = robot_page(folder.path(), PackFile::read(&desk).unwrap(), None, &moves);
    let mut browser = Browser::open(&path, [1000, 800], false).unwrap();
    browser.wait("typeof kinesic === 'object' && kinesic.compared").unwrap();
    let bits = state(&mut browser)["bits"].clone();
    assert_eq!((bits.as_array().unwrap().len(), bits[0]["frames"].as_u64()), (1, Some(200)));
    assert_eq!(bits[0]["here"], bits[0]["host"], "{bits}");
    // A person's plots and buttons are not there, and the base, which never moves, is not listed.
    assert_eq!(
        browser.value("[$('feet-plot').hidden, $('angle-caption').textContent, $('joint').options.length]").unwrap(),
        json!([true, "Coordinate, degrees", 4])
    );
    assert_eq!(
        browser
            .value("document.getElementById('upper-0') === null && document.querySelectorAll('.mask input').length")
            .unwrap(),
        4
    );
    set(&mut browser, "mask-0-1", "0", "input");
    let shown = state(&mut browser);
    assert_eq!(pose(&shown, 0)[0], pose(&shown, 1)[0], "pan is masked");
    shot(&mut browser, "robot.png");
    well(&mut browser);
}

#[test]
#[ignore = "needs chromium: firmware-sim/setup.sh"]
fn links_of_a_robot_are_where_the_host_puts_them() {
    let folder = tempfile::tempdir().unwrap();
    let robot = Robot::parse(CRANE).unwrap();
    let machine = Machine::of_robot(&robot, &ServoTable::default(), 50.0, Defaults::default()).unwrap();
    let look = Look::of_robot(&machine, &robot, folder.path(), &[]).unwrap();
    assert!(look.notes.is_empty(), "{:?}", look.notes);
    // It lifts and turns twice as far.
    let frames = |size: f64| {
        (0..150)
            .map(move |at| f64::from(at) / 50.0)
            .map(move |t| [size * (0.05 + 0.04 * (3.0 * t).sin()), size * 0.4 * (2.0 * t).cos()])
    };
    let moves = |size: f64| {
        let rows = frames(size).enumerate().map(|(at, [lift, turn])| format!("{},{lift},{turn}\n", at as f64 / 50.0));
        format!("time_s,lift_m,turn_rad\n{}", rows.collect::<String>())
    };
    let path = robot_page(folder.path(), pack(&machine, [&moves(1.0), &moves(2.0)]), Some(look.clone()), &moves(1.0));
    let mut browser = Browser::open(&path, [1000, 800], false).unwrap();
    browser.wait("typeof kinesic === 'object' && kinesic.compared").unwrap();
    let bits = state(&mut browser)["bits"].clone();
    assert_eq!(bits[0]["here"], bits[0]["host"], "{bits}");
    for values in [[0.0, 0.0], [0.25, 0.0], [0.1, 1.3], [0.3, -2.0]] {
        let script = format!("[...kinesic.data.packs[0].machine.place({values:?})]");
        let found: Vec<f64> = serde_json::from_value(browser.value(&script).unwrap()).unwrap();
        let expected = look.placed(&values);
        assert_eq!(found.len(), 7 * expected.len());
        for (found, expected) in found.chunks_exact(7).zip(expected) {
            let [x, y, z] = expected.translation.vector.into();
            assert!(apart(&found[..3], &[x, y, z]) < 1e-9, "{found:?} {expected}");
            let dot: f64 = found[3..].iter().zip(expected.rotation.coords.iter()).map(|(a, b)| a * b).sum();
            assert!(dot.abs() > 1.0 - 1e-12, "{found:?} {expected}");
        }
    }
    // The head is red, also where the figure is not.
    let red = "const { width, height } = $('scene'); const all = $('scene').getContext('2d').getImageData(0, 0, width, height).data; \
        let red = 0; for (let k = 0; k < all.length; k += 4) if (all[k] > 90 && all[k + 1] < 60 && all[k + 2] < 60 && all[k + 3] > 250) red += 1; red";
    assert!(
        browser
            .value(&format!("(() => {{ {} return red; }})()", red.trim_end_matches("red")))
            .unwrap()
            .as_f64()
            .unwrap()
            > 100.0
    );
    dark(&mut browser);
    fits(&mut browser);
    shot(&mut browser, "crane.png");
    let cost = state(&mut browser)["cost"].clone();
    println!("a picture of two robots of {} links takes {cost} ms", look.links.len());
    well(&mut browser);
}
