//! Motions in joints as files spell them: what comes in goes out as it was, in every format, with its line where it is refused.

use std::path::Path;

use kinesic_host::moves::{Channel, Format, Moves, Options, Unit, is_moves, parse, read};

const ANGLES: &str = "frame,time_s,Hips_x_m,Hips_y_m,Hips_z_m,Hips_z_deg,Hips_x_deg,Hips_y_deg\n0,0.000000,0.1,0.9,0.0,1.0,2.0,3.0\n\
                      1,0.016667,0.1,0.9,0.01,1.5,2.5,3.5\n2,0.033333,0.1,0.9,0.02,2.0,3.0,4.0\n";
const ROS: &str = "time_from_start,pan,tilt\n0,0.1,0.2\n0.5,0.2,0.3\n";
const LINES: &str = "{\"timestamp\": 0.0, \"frame_index\": 0, \"episode_index\": 3, \"action\": [1.0, 2.0], \"task\": \"wave\"}\n\
                     {\"timestamp\": 0.1, \"frame_index\": 1, \"episode_index\": 3, \"action\": [1.5, 2.5], \"task\": \"wave\"}\n";

fn at(name: &str, text: &str, options: &Options) -> Moves {
    parse(text.as_bytes(), Path::new(name), options).unwrap_or_else(|error| panic!("{name}: {error}"))
}

fn of(name: &str, text: &str) -> Moves {
    at(name, text, &Options::default())
}

fn written(moves: &Moves, name: &str) -> String {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    moves.write(&path).unwrap();
    std::fs::read_to_string(path).unwrap()
}

#[test]
fn files_are_written_as_they_were_spelled() {
    for (name, text) in [
        ("a.csv", "# by hand\ntime_s,eyes,pan_deg,tilt [rad]\n0,open,1.5,0.1\n0.02,\"half, shut\",2.5,0.2\n"),
        ("b.csv", "pan [deg];time_ms;lift_mm\n1,5;0;10\n2,25;20;11\n"),
        ("c.csv", "t\tshoulder_pan.pos\tnote\n0\t1\tx\n0.5\t2\t\n"),
        ("d.csv", "stamp_ns,pan_deg\n0,1\n20000000,2\n"),
        ("e.csv", "frame,pan_deg,time_s\n0,1,0\n1,2,0.1\n"),
        (
            "f.json",
            "{\"name\": \"nod\",\n\"unit\": \"deg\",\n\"fps\": 50.0,\n\"joints\": {\"pan\": [1.0, 2.5],\n\"tilt\": [0.0, -1.0]}}\n",
        ),
        (
            "g.json",
            "{\"times\": [0.0, 0.25],\n\"joint_names\": [\"pan_rad\",\"tilt_rad\"],\n\"frames\": [[0.1, 0.2],\n[0.3, 0.4]]}\n",
        ),
        ("h.json", "[\n{\"time\": 0.0, \"pan_deg\": 1.0, \"led\": \"red\"},\n{\"time\": 0.1, \"pan_deg\": 2.0}\n]\n"),
        ("i.jsonl", "{\"time\": 0.0, \"pan\": 1.0, \"led\": {\"r\":255}}\n{\"time\": 0.1, \"pan\": 2.0}\n"),
        ("j.jsonl", LINES),
        ("k.csv", ROS),
        ("l.csv", "timestamp,action,episode_index\n0,\"[1, 2]\",0\n0.1,\"[1.5, 2.5]\",0\n"),
    ] {
        assert!(is_moves(Path::new(name), text.as_bytes()), "{name}");
        let moves = of(name, text);
        // An episode's number is no joint: it stays.
        assert_eq!(written(&moves, name), text, "{name}");
        assert_eq!(of(name, &written(&moves, name)), moves, "{name}");
    }
}

#[test]
fn every_format_goes_to_every_other() {
    let moves = of("a.csv", "t,pan_deg,tilt_rad,lift_mm\n0,1.5,0.1,3\n0.25,2.5,0.2,4\n0.5,-3.5,0.3,5\n");
    for name in ["b.csv", "b.json", "b.jsonl", "b.yaml"] {
        let again = of(name, &written(&moves, name));
        assert_eq!(again.times, moves.times, "{name}");
        if name == "b.yaml" {
            assert!((again.values[0] - 1.5f64.to_radians()).abs() < 1e-15 && (again.values[2] - 0.003).abs() < 1e-15);
            assert!(again.notes[0].contains("rad and m"));
        } else {
            assert_eq!((again.channels, again.values), (moves.channels.clone(), moves.values.clone()), "{name}");
        }
    }
    let error = moves.write(Path::new("b.xyz")).unwrap_err();
    assert!(error.to_string().contains("b.xyz") && error.help.contains("b.csv"), "{error}");
    // A unit of the whole file is not that of a joint without one.
    let whole = of("a.json", "{\"unit\": \"deg\", \"fps\": 1, \"joints\": {\"pan\": [1, 2]}}");
    let bare = Channel { name: "lift".into(), unit: None };
    let both = whole.with(vec![whole.channels[0].clone(), bare], vec![0.0, 1.0], vec![1.0, 2.0, 3.0, 4.0]);
    assert_eq!(of("a.json", &written(&both, "a.json")).channels, both.channels);
    // A file of another robot than Reachy Mini is none of Reachy Mini's.
    let reachy = Moves { format: Format::Reachy, ..moves };
    assert!(reachy.write(Path::new("r.json")).unwrap_err().to_string().contains("r.json"));
}

#[test]
fn formats_are_told_apart() {
    assert_eq!(of("a.csv", ROS).format, Format::TrajectoryCsv);
    assert_eq!(of("j.jsonl", LINES).format, Format::LeRobot);
    let angles = of("a.csv", ANGLES);
    assert_eq!((angles.format, angles.channels.len(), angles.fps(), angles.is_even()), (Format::Angles, 6, 60.0, true));
    assert_eq!(angles.channels[0].unit, Some(Unit::Metres));
    assert_eq!(angles.channels[5], Channel { name: "Hips_y_deg".into(), unit: Some(Unit::Degrees) });
    assert_eq!(of("b.csv", &written(&angles, "b.csv")).values, angles.values);
    for (name, head) in [
        ("a.csv", "Timestamp,HipCenterX,HipCenterY\n1,2,3\n".to_owned()),
        ("a.csv", format!("frame,timestamp{}\n1,2\n", (0..68).map(|i| format!(",x_{i},y_{i}")).collect::<String>())),
        ("a.json", "{\"asset\": {\"version\": \"2.0\"}, \"joints\": []}".into()),
        ("a.json", "{\"limits\": 3}".into()),
        ("a.bvh", "HIERARCHY\nROOT hips\n".into()),
        ("a.csv", "image,subject,smile\na.png,1,2\n".into()),
    ] {
        assert!(!is_moves(Path::new(name), head.as_bytes()), "{name} {head}");
    }
    for (name, head) in [
        ("a.csv.gz", "time_s,pan_deg\n0,1\n".to_owned()),
        ("a.csv", format!("time_s{}", (0..400).map(|i| format!(",joint_{i}_deg")).collect::<String>())),
        ("a.json", "{\"description\": \"x\", \"time\": [0".into()),
        ("a", "header: 1\njoint_names: [a]\n".into()),
        ("a.parquet", "PAR1".into()),
    ] {
        assert!(is_moves(Path::new(name), head.as_bytes()), "{name}");
    }
}

#[test]
fn a_list_of_lerobot_has_the_names_of_its_data_set() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir_all(folder.path().join("meta")).unwrap();
    std::fs::create_dir_all(folder.path().join("data/chunk-000")).unwrap();
    let info = r#"{"fps": 10, "features": {"action": {"names": ["shoulder_pan.pos", "gripper.pos"]}}}"#;
    std::fs::write(folder.path().join("meta/info.json"), info).unwrap();
    let path = folder.path().join("data/chunk-000/episode.jsonl");
    std::fs::write(&path, LINES).unwrap();
    let moves = read(&path, &Options::default()).unwrap();
    assert_eq!((moves.find("shoulder_pan"), moves.find("gripper")), (Some(0), Some(1)));
    assert!(moves.notes.iter().any(|note| note.contains("names no unit")), "{:?}", moves.notes);
    let error = read(&path, &Options { episode: Some(7), rate: None }).unwrap_err();
    assert!(
        error.to_string().contains("from 3 to 3, expected episode 7") && error.help.contains("--episode"),
        "{error}"
    );
    // Names for another number of joints are not taken, and that is said.
    std::fs::write(folder.path().join("meta/info.json"), info.replace(", \"gripper.pos\"", "")).unwrap();
    let moves = read(&path, &Options::default()).unwrap();
    assert!(moves.find("action_1").is_some() && moves.notes.iter().any(|note| note.contains("1 names for the 2")));
}

#[test]
fn what_is_assumed_is_said() {
    let rows: String = (0..12).map(|i| format!("{i},{i},{}\n", if i == 5 { "7" } else { "" })).collect();
    let sparse = format!("t,pan_deg,x\n{rows}");
    for (name, text, words) in [
        ("a.csv", "time,pan_deg\n5,1\n6,2\n", "begin at 5 s"),
        ("a.csv", "timestamp,pan_deg\n0,1\n20,2\n", "milliseconds"),
        ("a.csv", "t,stamp_ns,pan_deg\n0,7,1\n1,8,2\n", "'stamp_ns'"),
        ("a.csv", &sparse, "'x' is no joint: it has text in 11 of 12"),
        ("a.csv", "t,pan_deg\n0,1\n# a pause\n1,2\n", "comment"),
        ("a.json", r#"{"fps": 50, "times": [0, 1], "joints": {"pan": [1, 2]}}"#, "50 frames per second does not fit"),
        (
            "a.yaml",
            "goal:\n  trajectory:\n    joint_names: [a]\n    points:\n    - {positions: [1], effort: [2], time_from_start: {secs: 0, nsecs: 0}}\n    \
          - {positions: [1], time_from_start: {secs: 1, nsecs: 5}}\n---\njoint_names: [b]\npoints: []\n",
            "1 further",
        ),
    ] {
        let notes = of(name, text).notes;
        assert!(notes.iter().any(|note| note.contains(words)), "{text}: {notes:?}");
    }
    let options = Options { rate: Some(10.0), episode: None };
    let gaps = at("a.csv", "frame,pan_deg\n7,1\n8,2\n11,3\n", &options);
    assert_eq!(gaps.times, [0.0, 0.1, 0.4]);
    assert!(gaps.notes[0].contains("gaps"));
}

#[test]
fn traps_name_their_line_and_column() {
    let head = r#"{"time": [0, 1], "set_target_data": [{"head": [[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]], "antennas": [0, 0]},"#;
    let traps: [(&str, &str, &[&str]); 22] = [
        ("a.csv", "# c\nt,pan_deg\n0,1\n\n# d\n1,left\n", &["line 6, column pan_deg", "'left'"]),
        ("a.csv", "t,a,b\n0,1,2\n1,,2\n2,3,4\n", &["line 3, column a", "''"]),
        ("a.csv", "t,a,a\n0,1,2\n1,2,3\n", &["line 1, column 3", "'a' twice"]),
        ("a.csv", "t,a_deg\n0,1\nx,2\n1,3\n", &["line 3, column t", "'x'"]),
        ("a.csv", "t,action\n0,\"[1, 2]\"\n1,\"[1]\"\n", &["line 3, column action", "expected 2 numbers"]),
        ("a.csv", "t,action\n0,\"[1, 2]\"\n1,\"[1, nan]\"\n", &["line 3, column action", "'nan'"]),
        ("a.csv", "frame,action\n0,\"[1, 2]\"\n1,\"[1, 2]\"\n", &["--rate"]),
        ("a.json", "{\"fps\": 0,\n\"joints\": {\"pan\": [1, 2]}}", &["rate 0", "above 0"]),
        ("a.json", "{\"fps\": 50,\n\"joints\": {\"pan\": [1, 2],\n\"pan\": [1, 2]}}", &["'pan' twice"]),
        ("a.json", "{\"fps\": 50,\n\"joints\": {\"pan\": [1,\nNaN]}}", &["line 3, pan, frame 1", "'NaN'", "finite"]),
        ("a.json", "{\"unit\": \"furlong\",\n\"joints\": {\"pan\": [1, 2]}}", &["line 1, unit", "'furlong'", "deg"]),
        ("a.json", "{\"fps\": 50, \"joints\": 3}", &["line 1, joints", "'3'"]),
        ("a.json", "{\"times\": [0, 1, 2], \"joints\": {\"pan\": [1, 2]}}", &["3 times", "2 frames"]),
        ("a.json", "[{\"time\": 0, \"a\": 1},\n{\"a\": 1}]", &["line 2, frame 1", "time"]),
        ("a.jsonl", "{\"time\": 0, \"a\": 1}\n{\"time\": 1, \"a\": \"x\"}\n", &["line 2, a", "'x'"]),
        ("a.jsonl", "{\"time\": 0, \"a\": 1}\n[1]\n", &["line 2", "'a'"]),
        (
            "a.json",
            &format!("{head}\n{{\"head\": [[1,0,0,0],[0,1,0,0],[0,0,1.1,0],[0,0,0,1]], \"antennas\": [0, 0]}}]}}"),
            &["line 2", "frame 1, head", "no rotation"],
        ),
        (
            "a.json",
            &format!("{head}\n{{\"head\": [[1,0,0,0],[0,1,0,0],[0,0,1,0]], \"antennas\": [0, 0]}}]}}"),
            &["line 2", "4 x 4"],
        ),
        (
            "a.json",
            &format!("{head}\n{{\"head\": [[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]], \"antennas\": [0]}}]}}"),
            &["line 2", "antennas", "right, left"],
        ),
        (
            "a.yaml",
            "joint_names: [a]\npoints:\n- positions: [.nan]\n  time_from_start: 0\n",
            &["line 3, point 0, a", "finite"],
        ),
        ("a.yaml", "joint_names: [a]\npoints: &p\n- positions: [1]\nmore: *p\n", &["line 4", "reference"]),
        ("a.yaml", "joint_names: [a]\npoints: {", &["not YAML"]),
    ];
    for (name, text, words) in traps {
        let error = parse(text.as_bytes(), Path::new(name), &Options::default()).expect_err(text);
        let said = format!("{error} {}", error.help);
        assert!(words.iter().all(|word| said.contains(word)) && said.contains(name), "{text}: {said}");
        assert!(!error.help.is_empty(), "{text}");
    }
    for rate in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let options = Options { rate: Some(rate), episode: None };
        assert!(parse(b"frame,a\n0,1\n2,2\n", Path::new("a.csv"), &options).is_err(), "{rate}");
    }
    let error = read(Path::new("nowhere.csv"), &Options::default()).unwrap_err().to_string();
    assert!(error.contains("nowhere.csv"), "{error}");
}

#[test]
fn pieces_and_rates_keep_what_is_beside_the_joints() {
    let moves = of("a.csv", "t,pan_deg,eyes\n0,0,open\n0.1,1,open\n0.2,2,shut\n0.3,3,shut\n");
    let piece = moves.slice(1..3);
    assert_eq!((piece.times.as_slice(), piece.values.as_slice()), (&[0.0, 0.1][..], &[1.0, 2.0][..]));
    assert_eq!(piece.extra.rows[1][0], "shut");
    assert_eq!(moves.slice(9..12).frames(), 0);
    assert_eq!(moves.slice(0..0).resample(50.0).unwrap().frames(), 0);
    let tilt = vec![Channel { name: "tilt".into(), unit: Some(Unit::Radians) }];
    let other = moves.with(tilt, vec![0.0, 0.25], vec![0.5, 0.6]);
    assert_eq!(written(&other, "a.csv"), "t,eyes,tilt_rad\n0,open,0.5\n0.25,shut,0.6\n");
    // Channels keep the order that the caller gives them.
    let both = of("a.csv", "t,pan,x,tilt\n0,1,a,2\n1,3,b,4\n");
    let turned = both.with(vec![both.channels[1].clone(), both.channels[0].clone()], vec![0.0], vec![2.0, 1.0]);
    assert_eq!(written(&turned, "a.csv"), "t,tilt,x,pan\n0,2,a,1\n");
    let summary = moves.summary();
    assert!((summary.channels[0].speed - 10.0).abs() < 1e-9 && summary.even && summary.fps == 10.0);
    assert!(serde_json::to_string(&summary).unwrap().contains("\"unit\":\"deg\""));
    let television: String = (0..300).map(|i| format!("{},1\n", f64::from(i) / 29.97)).collect();
    let television = of("a.csv", &format!("t,a\n{television}"));
    assert!((television.fps() - 29.97).abs() < 1e-6 && television.is_even());
    // A column that is not there in the first table comes where there is room.
    let milliseconds: String = (0..300).map(|i| format!("{:.3},1\n", f64::from(i) / 60.0)).collect();
    let milliseconds = of("a.csv", &format!("t,a\n{milliseconds}"));
    assert!(milliseconds.fps() == 60.0 && milliseconds.is_even());
}
