//! Motions in joints: every format read, written back equal; every trap refused with its place.

use std::path::Path;

use kinesic_host::moves::{Format, Moves, Options, Unit, is_moves, parse, read};
use kinesic_host::robot::{Defaults, Machine, ServoTable};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

const CSV: &str = "# made by hand\ntime_s,pan_deg,tilt [rad],lift_mm,eyes\n0,1.5,0.1,10,open\n0.02,2.5,0.2,11,\"half, shut\"\n0.04,3.25,0.3,12,shut\n";
const SEMICOLONS: &str = "t;pan_deg;tilt_deg\n0;1,5;2\n0,02;1,75;3\n0,04;2;4\n";
const COLUMNS: &str =
    r#"{"fps": 50, "unit": "deg", "name": "nod", "joints": {"pan": [1, 2.5, 3], "tilt": [0, -1, -2]}}"#;
const ROWS: &str =
    r#"{"joint_names": ["pan_rad", "tilt_rad"], "times": [5, 5.5, 6], "frames": [[0.1, 0.2], [0.3, 0.4], [0.5, 0.6]]}"#;
const RECORDS: &str = r#"[{"time": 0, "pan_deg": 1, "led": "red"}, {"time": 0.1, "pan_deg": 2, "led": "blue"}]"#;
const LINES: &str = "{\"time\": 0, \"pan_deg\": 1}\n{\"time\": 0.1, \"pan_deg\": 2}\n";
const REACHY: &str = r#"{"description": "a nod", "time": [3.0, 3.01, 3.02], "set_target_data": [
  {"head": [[1,0,0,0.01],[0,1,0,0],[0,0,1,0.02],[0,0,0,1]], "antennas": [0.1, -0.2], "body_yaw": 0.5, "check_collision": false},
  {"head": [[0.8660254037844387,-0.5,0,0],[0.5,0.8660254037844387,0,0],[0,0,1,0],[0,0,0,1]], "antennas": [0.2, -0.3], "body_yaw": 0.25, "check_collision": false},
  {"head": [[0.8660254037844387,0,0.5,0],[0,1,0,0],[-0.5,0,0.8660254037844387,0],[0,0,0,1]], "antennas": [0.3, -0.4], "body_yaw": 0, "check_collision": true}]}"#;
const TRAJECTORY: &str = "header:\n  frame_id: base\njoint_names: [pan, tilt]\npoints:\n- positions: [0.1, 0.2]\n  velocities: [0.0, 0.0]\n  \
                          time_from_start: {sec: 0, nanosec: 0}\n- positions: [0.3, 0.4]\n  time_from_start:\n    sec: 1\n    nanosec: 500000000\n";
const LEROBOT: &str = "episode_index,frame_index,timestamp,action\n0,0,0.0,\"[1.0, 2.0]\"\n0,1,0.033,[1.5 2.5]\n1,0,0.0,\"[9, 9]\"\n1,1,0.033,\"[9, 8]\"\n";

const ALL: [(&str, &str); 9] = [
    ("a.csv", CSV),
    ("b.csv", SEMICOLONS),
    ("c.json", COLUMNS),
    ("d.json", ROWS),
    ("e.json", RECORDS),
    ("f.jsonl", LINES),
    ("g.json", REACHY),
    ("h.yaml", TRAJECTORY),
    ("i.csv", LEROBOT),
];

fn of(name: &str, text: &str) -> Moves {
    parse(text.as_bytes(), Path::new(name), &Options::default()).unwrap_or_else(|error| panic!("{name}: {error}"))
}

fn names(moves: &Moves) -> Vec<&str> {
    moves.channels.iter().map(|channel| channel.name.as_str()).collect()
}

#[test]
fn every_format_is_read_and_written_back_equal() {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in ALL {
        assert!(is_moves(Path::new(name), text.as_bytes()), "{name}");
        let moves = of(name, text);
        let path = folder.path().join(name);
        moves.write(&path).unwrap();
        let again = read(&path, &Options::default()).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(names(&again), names(&moves), "{name}");
        assert!(again.times.iter().zip(&moves.times).all(|(a, b)| (a - b).abs() < 1e-9), "{name}");
        let worst = again.values.iter().zip(&moves.values).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(worst < 1e-9, "{name}: {worst}");
        assert_eq!(again.extra, moves.extra, "{name}");
    }
}

#[test]
fn what_the_formats_say_is_understood() {
    let csv = of("a.csv", CSV);
    let units: Vec<Option<Unit>> = csv.channels.iter().map(|channel| channel.unit).collect();
    assert_eq!(names(&csv), ["pan", "tilt", "lift"]);
    assert_eq!(units, [Some(Unit::Degrees), Some(Unit::Radians), Some(Unit::Millimetres)]);
    assert_eq!((csv.fps(), csv.is_even(), csv.extra.columns.as_slice()), (50.0, true, &["eyes".to_owned()][..]));
    assert_eq!(csv.extra.rows[1][0], "half, shut");
    assert_eq!(of("b.csv", SEMICOLONS).frame(1), [1.75, 3.0]);
    let columns = of("c.json", COLUMNS);
    assert_eq!((columns.times[2], columns.channels[0].unit), (0.04, Some(Unit::Degrees)));
    assert_eq!(of("d.json", ROWS).times, [0.0, 0.5, 1.0]);
    assert_eq!(of("f.jsonl", LINES).format, Format::JsonLines);
    let reachy = of("g.json", REACHY);
    assert_eq!((reachy.format, reachy.channels.len()), (Format::Reachy, 9));
    let yaw = reachy.frame(1)[reachy.find("head_yaw").unwrap()];
    let pitch = reachy.frame(2)[reachy.find("head_pitch").unwrap()];
    assert!((yaw - 30f64.to_radians()).abs() < 1e-9 && (pitch - 30f64.to_radians()).abs() < 1e-9, "{yaw} {pitch}");
    assert_eq!(reachy.frame(0)[reachy.find("right_antenna").unwrap()], 0.1);
    assert_eq!(of("h.yaml", TRAJECTORY).times, [0.0, 1.5]);
    let table = of("i.csv", LEROBOT);
    assert_eq!((names(&table), table.frame(1)), (vec!["action_0", "action_1"], &[1.5, 2.5][..]));
    assert!(table.notes.iter().any(|note| note.contains("several episodes")), "{:?}", table.notes);
    let second = parse(LEROBOT.as_bytes(), Path::new("i.csv"), &Options { episode: Some(1), rate: None }).unwrap();
    assert_eq!(second.frame(1), [9.0, 8.0]);
}

#[test]
fn the_table_that_kinesic_writes_of_a_body_is_read() {
    let clip = kinesic_host::gait::walk(&kinesic_host::gait::Manner::NEUTRAL, 1.0, 60.0, 0.0, 1);
    let text = clip.to_angles().unwrap();
    assert!(is_moves(Path::new("walk.csv"), text.as_bytes()));
    let moves = of("walk.csv", &text);
    assert_eq!((moves.frames(), moves.channels.len()), (60, 3 + 3 * clip.skeleton.len()));
    assert_eq!(moves.channels[3].unit, Some(Unit::Degrees));
}

#[test]
fn traps_are_refused_with_their_place() {
    let traps: [(&str, &str, &[&str]); 23] = [
        ("a.csv", "pan_deg,tilt_deg\n1,2\n3,4\n", &["--rate"]),
        ("a.csv", "t,pan_deg\n0,1\n0,2\n", &["line 3", "rise"]),
        ("a.csv", "t,pan_deg\n0.1,1\n0,2\n", &["line 3", "0.1"]),
        ("a.csv", "t,pan_deg\n0,1\n1e-8,2\n", &["line 3", "1e-8 s apart", "at least 1e-6", "time_ms"]),
        ("a.csv", "t,pan_deg,pan_deg\n0,1,2\n1,2,3\n", &["pan", "twice"]),
        ("a.csv", "t,pan_deg\n0,1\n1,2,3\n", &["line 3", "3 cells", "expected 2"]),
        ("a.csv", "t,pan_deg\n0,1\n1,NaN\n2,3\n", &["line 3", "pan_deg", "NaN", "finite"]),
        ("a.csv", "t,pan_deg\n0,1\n1,left\n2,3\n", &["line 3", "pan_deg", "left"]),
        ("a.csv", "t,pan_deg\n", &["header without rows"]),
        ("a.csv", "t,pan_deg\n0,1\n", &["1 frames", "at least 2"]),
        ("a.csv", "0,1\n1,2\n", &["line 1", "names of the joints"]),
        ("a.csv", "  \n", &["empty"]),
        ("a.csv", "t,pan_rad\n0,1\n1,90\n", &["line 3", "pan", "90", "degrees"]),
        ("a.json", r#"{"joints": {"pan": [1, 2]}}"#, &["--rate"]),
        ("a.json", r#"{"fps": -50, "joints": {"pan": [1, 2]}}"#, &["-50", "above 0"]),
        ("a.json", r#"{"fps": 50, "joints": {"pan": [1, 2], "tilt": [1]}}"#, &["tilt", "1 numbers", "expected 2"]),
        ("a.json", r#"{"fps": 50, "joint_names": ["a", "b"], "frames": [[1, 2], [1]]}"#, &["frame 1", "expected 2"]),
        ("a.json", r#"{"fps": 50, "joints": {"pan": [1, "x"]}}"#, &["pan, frame 1", "x"]),
        ("a.json", r#"[{"time": 0, "pan": 1}, {"time": 1}]"#, &["frame 1", "pan"]),
        ("a.json", "{\"fps\": 50, \"joints\": {\"pan\": [1,\n 2", &["line 2", "not JSON"]),
        (
            "a.json",
            r#"{"time": [0, 1], "set_target_data": [{"head": [[2,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]], "antennas": [0, 0]}, {}]}"#,
            &["frame 0", "no rotation"],
        ),
        (
            "a.yaml",
            "joint_names: [a, b]\npoints:\n- positions: [1]\n  time_from_start: {sec: 0, nanosec: 0}\n",
            &["point 0", "expected 2"],
        ),
        ("a.yaml", "joint_names: [a]\npoints:\n- positions: [1]\n- positions: [2]\n", &["point 0", "time_from_start"]),
    ];
    for (name, text, words) in traps {
        let error = parse(text.as_bytes(), Path::new(name), &Options::default()).expect_err(text);
        let said = format!("{error} {}", error.help);
        assert!(words.iter().all(|word| said.contains(word)) && said.contains(name), "{text}: {said}");
    }
    let bytes = [&b"t,pan\n0,1\n"[..], &[0xff, 0xfe]].concat();
    let error = parse(&bytes, Path::new("a.csv"), &Options::default()).unwrap_err().to_string();
    assert!(error.contains("line 3") && error.contains("UTF-8"), "{error}");
    let error = parse(b"PAR1....", Path::new("a.parquet"), &Options::default()).unwrap_err();
    assert!(error.help.contains("to_json"), "{error}");
}

#[test]
fn other_rates_keep_the_motion_and_what_is_beside_it() {
    let moves = of("a.csv", CSV).resample(100.0).unwrap();
    assert_eq!(moves.frames(), 5);
    assert_eq!(moves.frame(1), [2.0, 0.15000000000000002, 10.5]);
    assert_eq!(moves.extra.rows[1][0], "open");
    assert!(of("a.csv", CSV).resample(f64::NAN).is_err());
    // A pause of a year is no reason for a year of frames.
    let long = parse(b"t,pan_deg\n0,1\n31536000,2\n", Path::new("a.csv"), &Options::default()).unwrap();
    assert!(long.resample(50.0).unwrap_err().to_string().contains("frames"));
}

#[test]
fn a_name_with_another_separator_is_read_as_it_was_written() {
    let text = r#"{"fps": 50, "joints": {"a;b;c;d;e_deg": [1, 2], "d\te": [3, 4]}}"#;
    let moves = of("a.json", text);
    let again = of("b.csv", &moves.to_csv());
    assert_eq!((&again.channels, &again.values), (&moves.channels, &moves.values), "{}", moves.to_csv());
    assert!(is_moves(Path::new("b.csv"), moves.to_csv().as_bytes()));
}

#[test]
fn no_bytes_make_it_panic() {
    let mut random = ChaCha8Rng::seed_from_u64(5);
    for (name, text) in ALL {
        for _ in 0..2_000 {
            let mut bytes = text.as_bytes().to_vec();
            for _ in 0..random.random_range(1..4) {
                let at = random.random_range(0..bytes.len());
                match random.random_range(0..4) {
                    0 => bytes[at] = random.random_range(0..=255),
                    1 => bytes.truncate(at.max(1)),
                    2 => bytes.insert(at, *b"0,[{\"\n-e.:"[..].get(random.random_range(0..10)).unwrap()),
                    _ => {
                        bytes.remove(at.min(bytes.len() - 1));
                    }
                }
                if bytes.is_empty() {
                    break;
                }
            }
            let _ = is_moves(Path::new(name), &bytes);
            if let Ok(moves) = parse(&bytes, Path::new(name), &Options { rate: Some(50.0), episode: None }) {
                let _ = (moves.summary(), moves.to_csv(), moves.resample(30.0));
            }
        }
    }
}

#[test]
fn other_files_are_no_moves_and_packed_ones_are() {
    for (name, text) in [
        ("package.json", r#"{"name": "x", "version": "1.0"}"#),
        ("config.yaml", "name: x\nvalues: [1, 2]\n"),
        ("scene.json", r#"{"asset": {"version": "2.0"}, "time": 1}"#),
        ("kinect.csv", "Timestamp,HipCenterX,HipCenterY\n0,1,2\n"),
        ("notes.txt", "t,pan_deg\n0,1\n"),
    ] {
        assert!(!is_moves(Path::new(name), text.as_bytes()), "{name}");
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("nod.csv.gz");
    let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    std::io::Write::write_all(&mut packed, CSV.as_bytes()).unwrap();
    std::fs::write(&path, packed.finish().unwrap()).unwrap();
    assert!(is_moves(&path, CSV.as_bytes()));
    assert_eq!(read(&path, &Options::default()).unwrap(), of("nod.csv", CSV));
}

#[test]
fn lines_are_the_file_s_own() {
    for (text, line) in [
        ("t,pan_deg\n0,1\n# a pause\n\n1,x\n2,3\n", "line 5"),
        ("# head\nt,pan_deg\n0,1\n1,2\n2,x", "line 5"),
        ("t,pan_deg\n0,1\n1,2\n2,x\n", "line 4"),
    ] {
        let error = parse(text.as_bytes(), Path::new("a.csv"), &Options::default()).unwrap_err().to_string();
        assert!(error.contains(line), "{text}: {error}");
    }
}

#[test]
fn members_of_the_first_record_alone_are_no_bomb() {
    let many: String = (0..4000).map(|key| format!(",\"k{key}\":\"\"")).collect();
    let rest: String = (1..12_000).map(|t| format!(",{{\"t\":{t},\"p\":1}}")).collect();
    let text = format!("[{{\"t\":0,\"p\":1{many}}}{rest}]");
    let error = parse(text.as_bytes(), Path::new("a.json"), &Options::default()).unwrap_err().to_string();
    assert!(error.contains("frame 0") && error.contains("4002"), "{error}");
    let nothing = of("a.csv", CSV).slice(0..0);
    assert_eq!(nothing.resample(50.0).unwrap().frames(), 0);
}

/// A robot of servos with these names, in degrees.
fn robot(names: &[&str]) -> Machine {
    let servo = |name: &&str| format!("[[servo]]\nname = {name:?}\nunit = \"deg\"\nmin = -90\nmax = 90\n");
    let table = ServoTable::parse(&names.iter().map(servo).collect::<String>()).unwrap();
    Machine::of_table(&table, 50.0, Defaults::default()).unwrap()
}

#[test]
fn two_columns_for_one_joint_are_refused_with_both_names() {
    let machine = robot(&["shoulder_pan"]);
    for (name, text, first, second) in [
        ("a.csv", "t,shoulder_pan_deg,Shoulder Pan_deg\n0,1,2\n1,2,3\n", "shoulder_pan_deg", "Shoulder Pan_deg"),
        ("a.csv", "t,shoulder_pan_deg,shoulder_pan_rad\n0,1,2\n1,2,3\n", "shoulder_pan_deg", "shoulder_pan_rad"),
        ("a.csv", "t,shoulder_pan,shoulder_pan_deg\n0,1,2\n1,2,3\n", "shoulder_pan", "shoulder_pan_deg"),
        ("a.csv", "t,Shoulder Pan_rad,shoulder_pan_deg\n0,1,2\n1,2,3\n", "Shoulder Pan_rad", "shoulder_pan_deg"),
        (
            "a.json",
            r#"{"fps": 50, "joints": {"shoulder_pan": [1, 2], "Shoulder-Pan": [1, 2]}}"#,
            "Shoulder-Pan",
            "shoulder_pan",
        ),
    ] {
        let error = machine.clip(&of(name, text), Some(Unit::Degrees)).expect_err(text).to_string();
        let expected = "joint 'shoulder_pan': found two columns for it";
        assert!(error.contains(expected) && error.contains("expected one"), "{text}: {error}");
        assert!([first, second].iter().all(|name| error.contains(&format!("'{name}'"))), "{text}: {error}");
    }
    // Joints that are told apart by what people leave out keep their own columns.
    let machine = robot(&["joint_11", "joint_1_1"]);
    let clip = machine.clip(&of("a.csv", "t,joint_1_1_deg,joint_11_deg\n0,1,2\n1,2,3\n"), None).unwrap();
    assert!((clip.coordinates(0).unwrap()[0] - 2f64.to_radians()).abs() < 1e-6);
}

#[test]
fn times_in_another_unit_are_asked_about() {
    let notes = |name: &str, text: &str| of(name, text).notes.join(" ");
    for (head, step, words) in [
        ("t", 20.0, "0.05 frames a second: are its times milliseconds? Name the column time_ms."),
        ("t", 20_000.0, "0.00005 frames a second: are its times microseconds? Name the column time_us."),
        ("time_ms", 0.02, "50000 frames a second: are its times seconds? Name the column time_s."),
        ("t", 0.02, ""),
        ("time_ms", 20.0, ""),
    ] {
        let rows: String = (0..4).map(|frame| format!("{},1\n", f64::from(frame) * step)).collect();
        assert_eq!(notes("a.csv", &format!("{head},pan_deg\n{rows}")), words);
    }
    let json = r#"{"times": [0, 20, 40], "joints": {"pan_deg": [1, 2, 3]}}"#;
    assert_eq!(notes("a.json", json), "0.05 frames a second: are its times milliseconds? Give them in seconds.");
}

#[test]
fn what_a_format_cannot_hold_is_refused_with_file_joint_and_unit() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.json");
    let mut moves = of("g.json", REACHY);
    moves.channels[6].unit = Some(Unit::Degrees);
    let error = moves.write(&path).unwrap_err().to_string();
    assert!(error.contains("out.json: joint 'right_antenna': found it in deg, expected rad"), "{error}");
    moves.channels[6].name = "ear".into();
    let error = moves.write(&path).unwrap_err().to_string();
    assert!(error.contains("out.json: found no joint 'right_antenna', expected it in rad"), "{error}");
    moves.channels[6].unit = Some(Unit::Ticks);
    let error = moves.write(&folder.path().join("out.yaml")).unwrap_err().to_string();
    assert!(error.contains("out.yaml: joint 'ear' is in ticks"), "{error}");
    let error = read(&folder.path().join("gone.csv"), &Options::default()).unwrap_err().to_string();
    assert!(error.contains("gone.csv") && !error.starts_with(':'), "{error}");
}
