//! Emotion strength on the page of `kinesic view`, in headless Chromium.

mod visit;

use std::path::{Path, PathBuf};

use kinesic_firmware_sim::browser::Browser;
use kinesic_host::clip::JointMap;
use kinesic_host::emotion::play::{self, HostState};
use kinesic_host::emotion::{EmotionModel, HostEmotion, synthetic};
use kinesic_host::gait::{Manner, walk};
use kinesic_host::models;
use kinesic_host::pack::{PackFile, Provenance};
use kinesic_host::prepare::Source;
use kinesic_host::rig::Rig;
use kinesic_host::view::{self, CHECKED, View, ViewClip, ViewPack};
use serde_json::{Value, json};
use visit::{apart, dark, fits, pose, set, settle, shot, state, well};

fn pack(name: &str, (model, rig): &(EmotionModel, Rig)) -> ViewPack {
    let file = PackFile::from_bytes(&model.pack(rig, &Provenance::default()));
    ViewPack { name: name.to_owned(), file, look: None }
}

/// Weary from 0 to 1, swaying from -1 to 1; a cycle.
fn moods() -> ViewPack {
    pack("moods", &synthetic::model(2))
}

fn open(folder: &Path, shown: &View, size: [u32; 2], phone: bool) -> Browser {
    let path: PathBuf = folder.join("emotion.html");
    std::fs::write(&path, view::page("kinesic: moods", "made by a test", shown, view::WASM).unwrap()).unwrap();
    let mut at = Browser::open(&path, size, phone).unwrap();
    at.wait("typeof kinesic === 'object' && kinesic.compared").unwrap();
    at
}

/// The host's bits of the first frames, with other strengths from frames on.
fn host(of: &ViewPack, changes: &[(usize, [f32; 2])]) -> String {
    let pack = of.file.pack().unwrap();
    let model = HostEmotion::load(&pack).unwrap();
    let rig = Rig::from_pack(&pack).unwrap();
    let mut state = Box::new(HostState::new());
    let dt = 1.0 / pack.metadata().frame_rate;
    let step = |frame| {
        for (_, [weary, swaying]) in changes.iter().filter(|(from, _)| *from == frame) {
            state.strength = [*weary, *swaying, 0.0, 0.0];
        }
        play::pose(&model, &rig.frames(), &mut state, dt)
    };
    view::digest(&(0..CHECKED).map(step).collect::<Vec<_>>(), rig.joints())
}

fn page(at: &mut Browser) -> String {
    settle(at);
    at.value(&format!("kinesic.emotions[0].track.digest({CHECKED})")).unwrap().as_str().unwrap().to_owned()
}

/// Plays for a moment, then sets a slider while it plays and pauses at once; returns the frame of the change.
fn change_in_play(at: &mut Browser, slider: &str, strength: f32) -> usize {
    let begin = at.value("kinesic.time").unwrap();
    at.value("play(true)").unwrap();
    at.wait(&format!("kinesic.time > {begin} + 0.3")).unwrap();
    let script = format!(
        "(() => {{ const e = document.getElementById({slider:?}); e.value = {strength}; e.dispatchEvent(new Event('input')); play(false); \
         return kinesic.state().frame; }})()"
    );
    at.value(&script).unwrap().as_u64().unwrap() as usize
}

#[test]
#[ignore = "needs chromium: firmware-sim/setup.sh"]
fn sliders_of_emotions_change_the_motion_as_the_host_does() {
    let folder = tempfile::tempdir().unwrap();
    let moods = moods();
    let shown = View { emotions: vec![moods.clone()], ..View::default() };
    let mut at = open(folder.path(), &shown, [1400, 1000], false);
    let first = state(&mut at);
    let steady = host(&moods, &[(0, [0.5, 0.0])]);
    let changed = host(&moods, &[(0, [0.5, 0.0]), (CHECKED / 2, [1.0, 1.0])]);
    let expected = [("start", &steady), ("changed", &changed)]
        .map(|(what, bits)| json!({"pack": "moods", "emotion": what, "steps": CHECKED, "here": bits, "host": bits}));
    assert_eq!(first["bits"], json!(expected));
    assert_ne!(steady, changed);
    let names: Vec<_> = first["figures"].as_array().unwrap().iter().map(|figure| figure["name"].clone()).collect();
    assert_eq!(names, ["start", "moods"]);
    assert_eq!([&first["duration"], &first["playing"]], [&json!(10), &json!(true)]);
    assert_eq!(at.value("document.getElementById('clip').closest('label').hidden").unwrap(), true);
    at.wait("kinesic.drawn > 150").unwrap();
    let cost = state(&mut at)["cost"].clone();
    let frame = "(() => { const { track } = kinesic.emotions[0]; const begin = performance.now(); track.begin(); track.advance(Infinity); \
        return (performance.now() - begin) / track.frames; })()";
    let [_, frame] = [frame; 2].map(|frame| at.value(frame).unwrap());
    println!(
        "a picture of two skeletons takes {} ms, a frame of the core and its kinematics {frame} ms",
        cost["picture"]
    );
    // At first both figures are at the same strengths.
    at.key(" ").unwrap();
    set(&mut at, "time", "200", "input");
    let before = state(&mut at);
    assert_eq!(pose(&before, 0), pose(&before, 1));
    assert_eq!(page(&mut at), steady);
    // Each slider: its own strength and the motion, not the figure of the start.
    let mut poses = Vec::new();
    for (slider, asked) in [("emotion-0-0", [1.0, 0.0]), ("emotion-0-1", [0.5, -0.75])] {
        let value = if slider.ends_with("-0") { asked[0] } else { asked[1] };
        set(&mut at, slider, &value.to_string(), "input");
        let now = state(&mut at);
        let [set, played] = ["strength", "playing"].map(|of| f64s(&now["emotions"][0][of]));
        assert_eq!([set, played], [asked, asked]);
        assert_eq!(pose(&now, 0), pose(&before, 0));
        assert!(apart(&pose(&now, 1), &pose(&before, 1)) > 0.02);
        assert_eq!(page(&mut at), host(&moods, &[(0, asked.map(|x| x as f32))]));
        poses.push(pose(&now, 1));
        at.click("emotion-start-0").unwrap();
        assert_eq!(page(&mut at), steady, "back at the start, the same bits");
        assert_eq!(pose(&state(&mut at), 1), pose(&before, 1));
    }
    assert!(apart(&poses[0], &poses[1]) > 0.02);
    // Arrow keys move a slider, not the time.
    at.value("document.getElementById('emotion-0-0').focus()").unwrap();
    at.key("ArrowRight").unwrap();
    let keyed = state(&mut at);
    assert_eq!(keyed["frame"], 200);
    assert!(keyed["emotions"][0]["strength"][0].as_f64().unwrap() > 0.5);
    at.click("emotion-start-0").unwrap();
    // Feet of a walk stand part of the time, of both figures.
    for figure in 0..2 {
        let contacts = state(&mut at)["figures"][figure]["contacts"][0].as_str().unwrap().to_owned();
        let share = contacts.matches('1').count() as f64 / contacts.len() as f64;
        assert!(share > 0.1 && share < 0.9, "{share}");
    }
    shot(&mut at, "emotion.png");
    well(&mut at);
}

#[test]
#[ignore = "needs chromium: firmware-sim/setup.sh"]
fn strengths_change_in_mid_play_as_on_the_host() {
    let folder = tempfile::tempdir().unwrap();
    let moods = moods();
    let shown = View { emotions: vec![moods.clone()], ..View::default() };
    let mut at = open(folder.path(), &shown, [1400, 1000], false);
    at.value("play(false); document.getElementById('speed').value = '0.25'; seek(0)").unwrap();
    let mut now = [0.5, 0.0];
    let mut changes = vec![(0, now)];
    // Weary, back, swaying: each goes on from the one before.
    for (slider, value) in [("emotion-0-0", 1.0), ("emotion-0-0", 0.125), ("emotion-0-1", -1.0)] {
        now[usize::from(slider.ends_with("-1"))] = value;
        let frame = change_in_play(&mut at, slider, value);
        assert!(changes.last().unwrap().0 < frame && frame < 280, "{changes:?}, {frame}");
        changes.push((frame, now));
        assert_eq!(page(&mut at), host(&moods, &changes), "{changes:?}");
        assert_eq!(state(&mut at)["emotions"][0]["from"], frame);
    }
    // Steps after the change show it; before it the motion is made again as the sliders are.
    at.click("next").unwrap();
    assert_eq!(page(&mut at), host(&moods, &changes));
    at.click("start").unwrap();
    let replayed = host(&moods, &[(0, now)]);
    assert_eq!(page(&mut at), replayed);
    assert_ne!(replayed, host(&moods, &changes));
    // So is the next round.
    changes = vec![(0, now), (change_in_play(&mut at, "emotion-0-0", 1.0), [1.0, now[1]])];
    assert_eq!(page(&mut at), host(&moods, &changes));
    set(&mut at, "time", "598", "input");
    at.value("play(true)").unwrap();
    at.wait("kinesic.time < 9").unwrap();
    at.value("play(false)").unwrap();
    assert_eq!(page(&mut at), host(&moods, &[(0, [1.0, now[1]])]));
    well(&mut at);
}

fn f64s(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
}

/// Where figures stand in the picture along their way, m.
fn ahead(at: &mut Browser) -> Vec<f64> {
    let script = "kinesic.figures.map((figure) => { const frame = figure.track.frame(kinesic.time); const shift = \
        document.getElementById('follow').checked && figure.carried ? carried(figure, frame) : figure.shift; \
        return figure.track.place(frame)[2] + shift[1]; })";
    f64s(&at.value(script).unwrap())
}

#[test]
#[ignore = "needs chromium: firmware-sim/setup.sh"]
fn emotions_stand_beside_other_packs_and_each_other() {
    let folder = tempfile::tempdir().unwrap();
    let (mut model, rig) = synthetic::model(1);
    model.cycle = false;
    let emotions = vec![moods(), pack("once", &(model, rig))];
    let shown = View { emotions: emotions.clone(), ..View::default() };
    let mut at = open(folder.path(), &shown, [1400, 1000], false);
    at.value("play(false)").unwrap();
    let names = |state: &Value| {
        let figures = state["figures"].as_array().unwrap();
        figures.iter().map(|figure| figure["name"].as_str().unwrap().to_owned()).collect::<Vec<_>>()
    };
    assert_eq!(names(&state(&mut at)), ["moods: start", "moods", "once: start", "once"]);
    // The one that ends stands; the weary one walks slower, and is carried along as long as the picture follows.
    let frames = |at: &mut Browser, time: &str| {
        set(at, "time", time, "input");
        state(at)
    };
    let [ended, later] = ["400", "500"].map(|time| frames(&mut at, time));
    assert_eq!(pose(&ended, 3), pose(&later, 3));
    assert!(apart(&pose(&ended, 1), &pose(&later, 1)) > 0.02);
    set(&mut at, "emotion-0-0", "1", "input");
    let side_by_side = ahead(&mut at);
    at.click("follow").unwrap();
    let apart_by = ahead(&mut at);
    assert!((side_by_side[0] - side_by_side[1]).abs() < 0.2, "{side_by_side:?}");
    assert!(apart_by[0] - apart_by[1] > 0.5, "{apart_by:?}");
    // Without figures there is no picture: the first pack's stay.
    at.click("emotion-shown-0").unwrap();
    assert_eq!(names(&state(&mut at)), ["once: start", "once"]);
    assert_eq!(state(&mut at)["emotions"][0]["shown"], false);
    at.click("emotion-shown-1").unwrap();
    assert_eq!(names(&state(&mut at)), ["moods: start", "moods"]);
    well(&mut at);
    // With a clip that other packs play: as long as that, and its sliders do not disturb the others.
    let clip = walk(&Manner::NEUTRAL, 6.0, 60.0, 0.3, 3);
    let map = JointMap::detect(&clip.skeleton).unwrap();
    let source = Source::new("made", clip, map);
    let shown = View {
        packs: vec![ViewPack { name: "weary".to_owned(), file: models::weary(), look: None }],
        clips: vec![ViewClip { name: "a walk".to_owned(), source, target: None }],
        emotions: emotions[..1].to_vec(),
        ..View::default()
    };
    let mut at = open(folder.path(), &shown, [1400, 1000], false);
    at.value("play(false)").unwrap();
    settle(&mut at);
    let first = frames(&mut at, "200");
    assert_eq!(names(&first), ["source", "weary", "start", "moods"]);
    let bits = first["bits"].as_array().unwrap();
    assert!(bits.len() == 3 && bits.iter().all(|each| each["here"] == each["host"]), "{bits:?}");
    assert!(
        (first["duration"].as_f64().unwrap() - first["figures"][3]["frames"].as_f64().unwrap() / 60.0).abs() < 0.02
    );
    set(&mut at, "emotion-0-1", "1", "input");
    set(&mut at, "strength-0", "0", "input");
    let now = state(&mut at);
    let moved: Vec<bool> = (0..4).map(|figure| apart(&pose(&first, figure), &pose(&now, figure)) > 0.02).collect();
    assert_eq!(moved, [false, true, false, true]);
    assert_eq!(page(&mut at), host(&emotions[0], &[(0, [0.5, 1.0])]));
    at.click("emotion-shown-0").unwrap();
    assert_eq!(names(&state(&mut at)), ["source", "weary"]);
    shot(&mut at, "emotion-and-style.png");
    well(&mut at);
}

#[test]
#[ignore = "needs chromium: firmware-sim/setup.sh"]
fn emotions_fit_a_phone() {
    let folder = tempfile::tempdir().unwrap();
    let shown = View { emotions: vec![moods()], ..View::default() };
    let mut at = open(folder.path(), &shown, [390, 844], true);
    dark(&mut at);
    set(&mut at, "emotion-0-1", "1", "input");
    at.wait("kinesic.drawn > 30").unwrap();
    shot(&mut at, "emotion-phone.png");
    at.value("document.querySelector('.controls').scrollIntoView()").unwrap();
    shot(&mut at, "emotion-phone-controls.png");
    fits(&mut at);
    well(&mut at);
}
