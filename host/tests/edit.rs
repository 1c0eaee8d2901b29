//! Clips cut, looped, drawn and played by the folder, by the command as a user meets it.

use std::path::Path;
use std::process::{Command, Output};

use kinesic_host::clip::{self, Clip};
use serde_json::Value;

fn kinesic(args: &[&str], folder: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_kinesic")).args(args).current_dir(folder).output().unwrap()
}

fn succeed(args: &[&str], folder: &Path) -> String {
    let output = kinesic(args, folder);
    assert!(output.status.success(), "{args:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

fn json(args: &[&str], folder: &Path) -> Value {
    serde_json::from_str(&succeed(&[args, &["--json"]].concat(), folder)).unwrap()
}

/// Why a command is refused, without the marks and line ends of reports.
fn refused(args: &[&str], folder: &Path) -> String {
    let output = kinesic(args, folder);
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(matches!(output.status.code(), Some(1 | 2)), "{args:?}: {:?} {message}", output.status);
    message.split_whitespace().filter(|word| *word != "│").collect::<Vec<_>>().join(" ")
}

/// The demo's files in a folder of their own.
fn demo() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    succeed(&["demo", "--out", "."], folder.path());
    folder
}

/// The desk robot and a nod of it.
fn desk(folder: &Path) {
    let servo = |name: &str| format!("[[servo]]\nname = \"{name}\"\nunit = \"deg\"\nmin = -90\nmax = 90\n");
    std::fs::write(folder.join("desk.toml"), format!("name = \"desk\"\n{}{}", servo("pan"), servo("tilt"))).unwrap();
    let row = |frame: usize| {
        let t = frame as f64 / 50.0;
        format!("{t},{},{}\n", 30.0 * (2.1 * t).sin(), 20.0 * (4.2 * t).sin())
    };
    let rows: String = (0..400).map(row).collect();
    std::fs::write(folder.join("nod.csv"), format!("time_s,pan_deg,tilt_deg\n{rows}")).unwrap();
    succeed(&["robot", "import", "desk.toml", "--out", "desk.kin"], folder);
}

fn read(folder: &Path, name: &str) -> Clip {
    clip::read(folder.join(name)).unwrap()
}

/// Largest angle between two poses, rad.
fn apart(a: &Clip, frame: usize, b: &Clip, other: usize) -> f64 {
    a.pose(frame).iter().zip(b.pose(other)).map(|(a, b)| a.angle_to(b)).fold(0.0, f64::max)
}

#[test]
fn a_clip_is_cut_smoothed_looped_and_kept_in_place_on_its_own_skeleton() {
    let folder = demo();
    let at = folder.path();
    let whole = read(at, "unseen.bvh");
    let made = json(&["edit", "unseen.bvh", "--from", "1s", "--to", "120f", "--out", "part.bvh"], at);
    assert_eq!((made["frames"].as_u64(), made["frame_rate"].as_f64().map(f64::round)), (Some(61), Some(60.0)));
    let part = read(at, "part.bvh");
    assert_eq!(part.skeleton, whole.skeleton);
    assert!(apart(&part, 0, &whole, 60) < 1e-6 && apart(&part, 60, &whole, 120) < 1e-6);

    let made =
        json(&["edit", "unseen.bvh", "--loop", "--length", "1.1", "--in-place", "--sway", "--out", "cycle.bvh"], at);
    let (length, way) = (made["cycle"]["length_s"].as_f64().unwrap(), made["way_m"].as_f64().unwrap());
    assert!((0.8..1.4).contains(&length) && way > 0.3, "{made}");
    let cycle = read(at, "cycle.bvh");
    let last = cycle.frames() - 1;
    // But for how far the walk turns in a cycle.
    let turned = made["cycle"]["turn_deg"].as_f64().unwrap().abs().to_radians();
    let (pose, again) = (cycle.pose(0), cycle.pose(last));
    assert!(pose[1..].iter().zip(&again[1..]).all(|(a, b)| a.angle_to(b) < 1e-5));
    assert!((pose[0].angle_to(&again[0]) - turned).abs() < 0.01, "{turned}");
    assert!((cycle.root[last] - cycle.root[0]).norm() < 1e-5);

    succeed(&["edit", "unseen.bvh", "--smooth", "0.4", "--out", "smooth.bvh"], at);
    let smooth = read(at, "smooth.bvh");
    let path = |clip: &Clip| (1..clip.frames()).map(|frame| apart(clip, frame, clip, frame - 1)).sum::<f64>();
    assert!(path(&smooth) < 0.9 * path(&whole) && apart(&smooth, 0, &whole, 0) < 1e-5);
}

#[test]
fn many_clips_go_to_a_folder_and_a_bad_one_stops_no_other() {
    let folder = demo();
    let at = folder.path();
    let text = std::fs::read_to_string(at.join("unseen.bvh")).unwrap();
    std::fs::create_dir(at.join("clips")).unwrap();
    for (name, text) in [("a.bvh", text.clone()), ("b.bvh", text.replacen("Frames", "Fromes", 1)), ("c.bvh", text)] {
        std::fs::write(at.join("clips").join(name), text).unwrap();
    }
    for command in [&["edit", "clips", "--smooth", "0.1"][..], &["apply", "weary.kin", "clips/"]] {
        let output = kinesic(&[command, &["--out", "out/", "--format", "glb"]].concat(), at);
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(1), "{message}");
        assert!(message.contains("failed: clips/b.bvh: line") && message.contains("1 of 3 clips failed"), "{message}");
        let lines = String::from_utf8(output.stdout).unwrap();
        assert!(lines.contains("out/a.glb: 360 frames") && lines.contains("out/c.glb"), "{lines}");
        let mut names: Vec<_> = std::fs::read_dir(at.join("out")).unwrap().map(|e| e.unwrap().file_name()).collect();
        names.sort();
        assert_eq!(names, ["a.glb", "c.glb"]);
        std::fs::remove_dir_all(at.join("out")).unwrap();
    }
    let output = kinesic(&["apply", "weary.kin", "clips", "--out", "out", "--json"], at);
    let told: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((output.status.code(), &told["failed"]), (Some(1), &Value::from(1)));
    assert_eq!(told["clips"][0]["out"], "out/a.bvh");
    assert!(told["clips"][1]["error"].as_str().unwrap().contains("clips/b.bvh"));
    // Where nothing can be made, nothing is left, not even the folder.
    let output = kinesic(&["edit", "clips/b.bvh", "--smooth", "1", "--out", "none/"], at);
    assert!(!output.status.success() && !at.join("none").exists());
}

#[test]
fn strength_follows_its_keys() {
    let folder = demo();
    let at = folder.path();
    let play = |strength: &str, out: &str| {
        let args = ["apply", "weary.kin", "unseen.bvh", "--on", "pack", "--strength", strength, "--out", out];
        succeed(&args, at);
        read(at, out)
    };
    let (none, full, keyed) = (play("0", "0.bvh"), play("1", "1.bvh"), play("0@1s,1@2s", "keyed.bvh"));
    for frame in [0, 30, 60] {
        assert!(apart(&keyed, frame, &none, frame) < 1e-6, "{frame}");
    }
    for frame in [120, 121, 359] {
        assert!(apart(&keyed, frame, &full, frame) < 1e-6, "{frame}");
    }
    let share = |frame: usize| apart(&keyed, frame, &none, frame) / apart(&full, frame, &none, frame);
    assert!((share(90) - 0.5).abs() < 0.05, "{}", share(90));
    std::fs::write(at.join("curve.csv"), "time,strength\n1,0\n2,1\n").unwrap();
    play("@curve.csv", "table.bvh");
    let bytes = |name: &str| std::fs::read(at.join(name)).unwrap();
    assert!(bytes("table.bvh") == bytes("keyed.bvh"));
    let note = succeed(&["apply", "weary.kin", "unseen.bvh", "--strength", "0@0s,1@60s", "--out", "long.bvh"], at);
    assert!(note.contains("the last key of --strength is at 60 s"), "{note}");
}

#[test]
fn a_robot_s_strength_follows_its_keys_and_its_moves_are_cut_and_looped() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    desk(at);
    let lively = std::fs::read_to_string(at.join("nod.csv")).unwrap();
    let row = |line: &str| {
        let cells: Vec<f64> = line.split(',').filter_map(|cell| cell.parse().ok()).collect();
        format!("{},{},{}\n", cells[0], 1.5 * cells[1], 1.3 * cells[2])
    };
    let rows: String = lively.lines().skip(1).map(row).collect();
    std::fs::write(at.join("lively.csv"), format!("time_s,pan_deg,tilt_deg\n{rows}")).unwrap();
    succeed(
        &[
            "train",
            "translate",
            "--robot",
            "desk.kin",
            "--pair",
            "nod.csv",
            "lively.csv",
            "--out",
            "l.kin",
            "--no-report",
        ],
        at,
    );
    let play = |strength: &str| {
        succeed(&["apply", "l.kin", "nod.csv", "--strength", strength, "--out", "o.csv"], at);
        let text = std::fs::read_to_string(at.join("o.csv")).unwrap();
        text.lines().map(str::to_owned).collect::<Vec<_>>()
    };
    let (none, full, keyed) = (play("0"), play("1"), play("0@2s,1@4s"));
    assert!(keyed[50] == none[50] && keyed[50] != full[50] && keyed[150] != none[150]);
    // Limits that were kept before may still be felt for a moment.
    assert_eq!(keyed[300], full[300]);

    let made = json(&["edit", "nod.csv", "--robot", "desk.kin", "--loop", "--length", "3", "--out", "cycle.csv"], at);
    assert!((made["cycle"]["length_s"].as_f64().unwrap() - 2.99).abs() < 0.1, "{made}");
    let text = std::fs::read_to_string(at.join("cycle.csv")).unwrap();
    let cells = |line: &str| line.split(',').skip(1).map(|cell| cell.parse::<f64>().unwrap()).collect::<Vec<_>>();
    let (first, last) = (text.lines().nth(1).unwrap(), text.lines().last().unwrap());
    assert!(cells(first).iter().zip(cells(last)).all(|(a, b)| (a - b).abs() < 1e-3), "{first} {last}");
    assert!(
        refused(&["edit", "nod.csv", "--robot", "desk.kin", "--in-place", "--out", "p.csv"], at)
            .contains("stays where it is")
    );
    succeed(&["export", "nod.csv", "--robot", "desk.kin", "--out", "nod.positions.csv"], at);
    assert!(std::fs::read_to_string(at.join("nod.positions.csv")).unwrap().starts_with("frame,time_s,base.x"));
    succeed(&["sheet", "nod.csv", "--robot", "desk.kin", "--out", "nod.png"], at);
}

#[test]
fn sheets_and_moving_pictures_open_elsewhere() {
    let folder = demo();
    let at = folder.path();
    let bytes = |name: &str| std::fs::read(at.join(name)).unwrap();
    let made = json(&["sheet", "neutral.bvh", "weary.bvh", "--frames", "5", "--out", "a.png"], at);
    let picture = image::load_from_memory(&bytes("a.png")).unwrap();
    assert_eq!(
        (u64::from(picture.width()), u64::from(picture.height())),
        (made["width"].as_u64().unwrap(), made["height"].as_u64().unwrap())
    );
    assert_eq!(made["pictures"], 10);
    succeed(&["sheet", "neutral.bvh", "--view", "top", "--out", "a.svg"], at);
    let svg = String::from_utf8(bytes("a.svg")).unwrap();
    assert!(roxmltree::Document::parse(&svg).is_ok() && svg.contains("neutral.bvh, 5.98 s"));
    let made = json(&["sheet", "neutral.bvh", "weary.bvh", "--fps", "10", "--size", "60", "--out", "a.gif"], at);
    let mut gif = gif::DecodeOptions::new().read_info(&bytes("a.gif")[..]).map(|_| ());
    assert!(gif.is_ok() && made["pictures"] == 80, "{made} {:?}", gif.as_mut().err());
    succeed(&["sheet", "neutral.bvh", "--fps", "10", "--size", "60", "--out", "a.apng"], at);
    assert!(bytes("a.apng").windows(4).any(|word| word == b"acTL"));
    // Names that no map knows are drawn all the same.
    let text = std::fs::read_to_string(at.join("neutral.bvh")).unwrap();
    let odd = text.replace("Left", "Zig").replace("Right", "Zag").replace("Hips", "Box");
    std::fs::write(at.join("odd.bvh"), odd).unwrap();
    succeed(&["sheet", "odd.bvh", "--out", "odd.png"], at);
}

#[test]
fn content_has_the_name_of_its_file_and_positions_are_those_of_the_joints() {
    let folder = demo();
    let at = folder.path();
    for name in ["slow walk.glb", "slow walk.gltf"] {
        succeed(&["export", "weary.bvh", "--out", name], at);
        let gltf = gltf::Gltf::open(at.join(name)).unwrap();
        assert_eq!(gltf.animations().next().unwrap().name(), Some("slow walk"));
        assert_eq!(gltf.default_scene().unwrap().name(), Some("slow walk"));
    }
    succeed(&["export", "weary.bvh", "--out", "w.positions.csv"], at);
    let clip = read(at, "weary.bvh");
    let mut table = csv::Reader::from_path(at.join("w.positions.csv")).unwrap();
    let head = table.headers().unwrap().clone();
    let column = head.iter().position(|name| name == "Head.y").unwrap();
    let joint = clip.skeleton.find("Head").unwrap();
    for (frame, row) in table.records().enumerate() {
        let found: f64 = row.unwrap()[column].parse().unwrap();
        assert!((found - clip.positions(frame)[joint].y).abs() < 1e-5, "{frame}");
    }
}

#[test]
fn what_cannot_be_done_is_refused_and_nothing_is_left() {
    let folder = demo();
    let at = folder.path();
    let cases: [(&[&str], &str); 17] = [
        (&["edit", "unseen.bvh", "--out", "o.bvh"], "expected at least one edit"),
        (&["edit", "unseen.bvh", "--from", "9s", "--out", "o.bvh"], "unseen.bvh"),
        (&["edit", "unseen.bvh", "--from", "9s", "--out", "o.bvh"], "the clip ends at 5.983 s (frame 359)"),
        (&["edit", "unseen.bvh", "--from", "2s", "--to", "1s", "--out", "o.bvh"], "give a later --to"),
        (&["edit", "unseen.bvh", "--from", "x", "--out", "o.bvh"], "as 36f"),
        (&["edit", "unseen.bvh", "--smooth", "-1", "--out", "o.bvh"], "above 0, at most 10"),
        (&["edit", "unseen.bvh", "--loop", "--length", "20", "--out", "o.bvh"], "Ask for a shorter --length"),
        (&["edit", "unseen.bvh", "--sway", "--smooth", "1", "--out", "o.bvh"], "--in-place"),
        (&["edit", "unseen.bvh", "neutral.bvh", "--smooth", "1", "--out", "o.bvh"], "name a folder: --out o/"),
        (&["edit", "unseen.bvh", "neutral.bvh", "--smooth", "1", "--out", "."], "would be replaced"),
        (&["edit", "unseen.bvh", "--smooth", "1", "--out", "o.bvh", "--format", "glb"], "says its format itself"),
        (&["sheet", "unseen.bvh", "--out", "o.txt"], "name it o.png"),
        (&["sheet", "unseen.bvh", "--out", "o.gif", "--frames", "3"], "expected --fps"),
        (&["sheet", "unseen.bvh", "--out", "o.png", "--fps", "3"], "expected --frames"),
        (&["sheet", "gone.bvh", "--out", "o.png"], "gone.bvh"),
        (&["apply", "weary.kin", "unseen.bvh", "--out", "o.bvh", "--strength", "0@0s,1@x"], "key 2, '1@x'"),
        (
            &["apply", "weary.kin", "unseen.bvh", "--out", "o.bvh", "--strength", "@gone.csv"],
            "gone.csv: cannot be read",
        ),
    ];
    let names = || std::fs::read_dir(at).unwrap().map(|entry| entry.unwrap().file_name()).collect::<Vec<_>>();
    let before = names();
    for (args, cause) in cases {
        let message = refused(args, at);
        assert!(message.contains(cause), "{args:?}: {message}");
    }
    assert_eq!(names(), before);
}
