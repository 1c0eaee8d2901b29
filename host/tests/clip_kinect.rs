//! Kinect CSV: a made figure, and everything that can be wrong with a recording.

use kinesic_host::clip::kinect::{KinectOptions, parse};
use kinesic_host::clip::{self, Canonical, JointMap, ReadError};
use nalgebra::Vector3;

/// Names and places of a standing figure in camera coordinates, 3 m away, facing the camera, right arm at +X.
const FIGURE: [(&str, [f64; 3]); 20] = [
    ("HipCenter", [0.0, 0.1, 3.0]),
    ("Spine", [0.0, 0.16, 3.04]),
    ("ShoulderCenter", [0.0, 0.5, 3.05]),
    ("Head", [0.0, 0.7, 3.0]),
    ("ShoulderLeft", [-0.17, 0.4, 3.02]),
    ("ElbowLeft", [-0.2, 0.14, 3.02]),
    ("WristLeft", [-0.2, -0.06, 2.92]),
    ("HandLeft", [-0.2, -0.14, 2.88]),
    ("ShoulderRight", [0.17, 0.4, 3.02]),
    ("ElbowRight", [0.2, 0.14, 3.02]),
    ("WristRight", [0.2, -0.06, 2.92]),
    ("HandRight", [0.2, -0.14, 2.88]),
    ("HipLeft", [-0.08, 0.03, 3.0]),
    ("KneeLeft", [-0.09, -0.4, 2.98]),
    ("AnkleLeft", [-0.09, -0.75, 3.02]),
    ("FootLeft", [-0.09, -0.82, 2.95]),
    ("HipRight", [0.08, 0.03, 3.0]),
    ("KneeRight", [0.09, -0.4, 2.98]),
    ("AnkleRight", [0.09, -0.75, 3.02]),
    ("FootRight", [0.09, -0.82, 2.95]),
];

/// A recording at the given times, ms; the whole figure moves to its right by 1 m/s, the right forearm rises.
fn recording(times: &[f64]) -> String {
    let mut text = String::from("Timestamp");
    for (name, _) in FIGURE {
        text += &format!(",{name}X,{name}Y,{name}Z");
    }
    text += ",User-ID,Action,\n";
    for time in times {
        text += &format!("{}", 36914937.025 + time);
        let seconds = time / 1000.0;
        let elbow = Vector3::from(FIGURE[9].1);
        for (joint, (_, place)) in FIGURE.iter().enumerate() {
            let mut p = Vector3::from(*place);
            if joint == 10 || joint == 11 {
                p = elbow + nalgebra::Rotation3::from_axis_angle(&Vector3::x_axis(), 1.5 * seconds) * (p - elbow);
            }
            text += &format!(",{:.6},{:.6},{:.6}", p.x + seconds, p.y, p.z);
        }
        text += ",565,Wave,\n";
    }
    text
}

const UNEVEN: [f64; 8] = [0.0, 31.0, 65.0, 101.0, 132.0, 180.0, 201.0, 233.4];

#[test]
fn the_figure_is_fitted_and_faces_plus_z() {
    let recording = parse(recording(&UNEVEN).as_bytes(), &KinectOptions::default()).expect("a recording");
    let clip = &recording.clip;
    assert_eq!((clip.frames(), clip.skeleton.len()), (8, 20));
    assert!((clip.fps() - 30.0).abs() < 1e-9);
    assert_eq!(recording.positions.len(), 8 * 20);
    // Straight lines between rows cut the forearm's arc by less than a millimetre.
    assert!(recording.residual_cm < 0.1, "{}", recording.residual_cm);
    let map = JointMap::detect(&clip.skeleton).expect("kinect20");
    assert_eq!(map.layout(), "kinect20");
    let at = |frame: usize, c| clip.positions(frame)[map.joint(c).expect("a joint")];
    assert!(at(0, Canonical::LShoulder).x > 0.1 && at(0, Canonical::RShoulder).x < -0.1);
    assert!(at(0, Canonical::LToe).z > at(0, Canonical::LAnkle).z, "toes point to +Z");
    assert!(at(0, Canonical::LToe).y.abs() < 1e-3 && at(0, Canonical::Head).y > 1.4);
    assert!((at(0, Canonical::Pelvis) - Vector3::new(0.0, 0.92, 0.0)).norm() < 1e-6);
    // By timestamp, not by row: 1 m/s to the own right, which is -X.
    assert!((at(7, Canonical::Pelvis).x + 7.0 / 30.0).abs() < 1e-5);
    // The rest pose stands with its arms out.
    let rest = clip.skeleton.rest_positions();
    let hand = rest[clip.skeleton.find("HandLeft").expect("a hand")];
    assert!(hand.x > 0.6 && hand.y.abs() < 0.6 && rest[3].y > 0.5 && rest[14].y < -0.7, "{rest:?}");
    for word in ["Uneven clock", "resampled to 30 fps", "Camera coordinates", "rms"] {
        assert!(clip.notes.iter().any(|n| n.contains(word)), "{word}: {:?}", clip.notes);
    }
}

#[test]
fn repeated_rows_and_short_gaps_are_mended_with_a_note() {
    let mut times = UNEVEN.to_vec();
    times.insert(3, times[2]);
    let mut text = recording(&times);
    // The first joint's X of the second row goes missing.
    let row = text.lines().nth(2).expect("a row").to_owned();
    let mut cells: Vec<&str> = row.split(',').collect();
    cells[1] = "";
    text = text.replace(&row, &cells.join(","));
    let mended = parse(text.as_bytes(), &KinectOptions::default()).expect("mended").clip;
    let whole = parse(recording(&UNEVEN).as_bytes(), &KinectOptions::default()).expect("whole").clip;
    let notes = mended.notes.join("\n");
    assert!(notes.contains("1 row(s) that repeat a timestamp") && notes.contains("1 row(s) were bridged"), "{notes}");
    for (a, b) in mended.root.iter().zip(&whole.root) {
        assert!((a - b).norm() < 1e-5);
    }
}

/// The recording with its clock and its coordinates written otherwise.
fn written(clock: impl Fn(f64) -> f64, place: impl Fn(usize, [f64; 3]) -> [f64; 3]) -> String {
    let mut text = recording(&UNEVEN);
    let header = text.lines().next().expect("a header").to_owned();
    let rows = text.lines().skip(1).enumerate().map(|(row, line)| {
        let cells: Vec<&str> = line.split(',').collect();
        let numbers: Vec<f64> = cells[..61].iter().map(|cell| cell.parse().expect("a number")).collect();
        let places = numbers[1..].chunks(3).flat_map(|p| place(row, [p[0], p[1], p[2]]));
        let places = places.map(|x| format!("{x:.7}")).collect::<Vec<_>>().join(",");
        format!("{:.7},{places},{}\n", clock(numbers[0]), cells[61..].join(","))
    });
    text = header + "\n" + &rows.collect::<String>();
    text
}

#[test]
fn clocks_units_and_axes_of_other_recorders_are_told() {
    let plain = |_: usize, p: [f64; 3]| p;
    let read = |text: &str| parse(text.as_bytes(), &KinectOptions::default()).unwrap_or_else(|e| panic!("{e}")).clip;
    let sound = read(&recording(&UNEVEN));
    let scaled = |by: f64| move |_: usize, p: [f64; 3]| p.map(|x| x * by);
    let cases = [
        ("seconds", written(|t| t / 1000.0, plain), "counts seconds"),
        ("microseconds", written(|t| t * 1000.0, plain), "counts microseconds"),
        ("ticks", written(|t| t * 1e4, plain), "100 ns"),
        ("millimetres", written(|t| t, scaled(1000.0)), "Units: mm assumed"),
        ("centimetres", written(|t| t, scaled(100.0)), "Units: cm assumed"),
        ("nanoseconds", written(|t| t * 1e6, plain), "counts nanoseconds"),
        ("feet", written(|t| t, scaled(1.0 / 0.3048)), "Units: foot assumed"),
        ("decimetres", written(|t| t, scaled(10.0)), "Units: dm assumed"),
        ("Y down", written(|t| t, |_, [x, y, z]| [-x, -y, z]), "-Y up found"),
    ];
    for (name, text, note) in cases {
        let clip = read(&text);
        assert!(clip.notes.iter().any(|n| n.contains(note)), "{name}: {:?}", clip.notes);
        assert_eq!(clip.frames(), sound.frames(), "{name}");
        let off =
            clip.all_positions().iter().zip(sound.all_positions()).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
        assert!(off < 2e-3, "{name}: {off} m");
    }
    // Frame numbers have no length of their own: 30 of them are a second.
    let numbers =
        written(|t| UNEVEN.iter().position(|own| (own + 36914937.025 - t).abs() < 1e-3).unwrap() as f64, plain);
    let clip = read(&numbers);
    assert!(clip.notes.iter().any(|n| n.contains("frame numbers")), "{:?}", clip.notes);
    assert_eq!((clip.frames(), clip.fps().round()), (UNEVEN.len(), 30.0));
    // A clock of hours makes one frame of everything.
    let hours = written(|t| t / 3.6e6, plain);
    let error = parse(hours.as_bytes(), &KinectOptions::default()).expect_err("one frame").to_string();
    assert!(error.contains("counts in another unit"), "{error}");
}

#[test]
fn tables_of_other_programs_are_read() {
    let text = recording(&UNEVEN);
    let (header, rows) = text.split_once('\n').expect("both");
    let utf16 = |text: &str| "\u{feff}".encode_utf16().chain(text.encode_utf16()).flat_map(u16::to_le_bytes).collect();
    let renamed = |from: &str, to: &str| (header.replace(from, to) + "\n" + rows).into_bytes();
    let azure =
        header.replace("HipCenter", "PELVIS_").replace("ShoulderCenter", "NECK_").replace(",Spine", ",SPINE_NAVEL_");
    let second = header
        .replace("HipCenter", "SpineBase")
        .replace("ShoulderCenter", "SpineShoulder")
        .replace(",SpineX", ",SpineMidX");
    let cases: [(&str, Vec<u8>); 8] = [
        ("semicolons", text.replace(',', ";").into_bytes()),
        ("tabs", text.replace(',', "\t").into_bytes()),
        ("decimal commas", text.replace(',', ";").replace('.', ",").into_bytes()),
        ("UTF-16", utf16(&text)),
        ("underscores", renamed("CenterX", "Center_X")),
        ("points", renamed("HipCenterX,HipCenterY", "hipcenter.x,hipcenter.y")),
        ("Azure", (azure + "\n" + rows).into_bytes()),
        ("the second Kinect", (second.replace(",SpineY,SpineZ", ",SpineMidY,SpineMidZ") + "\n" + rows).into_bytes()),
    ];
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("table.csv");
    let sound = parse(text.as_bytes(), &KinectOptions::default()).expect("sound").clip;
    for (name, bytes) in cases {
        std::fs::write(&path, bytes).expect("written");
        let clip = clip::read(&path).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert_eq!(clip.root, sound.root, "{name}");
    }
}

#[test]
fn several_people_are_told_apart_or_said() {
    let text = recording(&UNEVEN);
    let (header, rows) = text.split_once('\n').expect("both");
    let pair = |other: &str| {
        let moved = |cell: &str| cell.parse::<f64>().map_or(cell.to_owned(), |x| (x + 1.0).to_string());
        let row = |line: &str| {
            let (time, cells) = line.split_once(',').unwrap_or_default();
            let cells: Vec<String> =
                cells.split(',').map(|cell| if cell == "565" { other.to_owned() } else { moved(cell) }).collect();
            format!("{line}\n{time},{}\n", cells.join(","))
        };
        format!("{header}\n{}", rows.lines().map(row).collect::<String>())
    };
    let sound = parse(text.as_bytes(), &KinectOptions::default()).expect("sound").clip;
    for (other, note) in [("566", "'565' has the most rows"), ("565", "several people?")] {
        let clip = parse(pair(other).as_bytes(), &KinectOptions::default()).expect("read").clip;
        assert!(clip.notes.iter().any(|n| n.contains(note)), "{:?}", clip.notes);
        assert_eq!(clip.root, sound.root);
    }
}

#[test]
fn a_joint_that_was_never_seen_is_no_origin_and_one_that_leaps_is_named() {
    let at = |joint: usize, place: &dyn Fn(usize, [f64; 3]) -> [f64; 3]| {
        let count = std::cell::Cell::new(0);
        written(|t| t, |row, p| if count.replace(count.get() + 1) % FIGURE.len() == joint { place(row, p) } else { p })
    };
    for (joint, name) in [(11, "HandRight"), (0, "HipCenter")] {
        let error =
            parse(at(joint, &|_, _| [0.0; 3]).as_bytes(), &KinectOptions::default()).expect_err(name).to_string();
        assert!(error.contains(name) && error.contains("never tracked"), "{error}");
    }
    let leaping = at(11, &|row, p| if row == 3 { [-1.0; 3] } else { p });
    let sound = parse(recording(&UNEVEN).as_bytes(), &KinectOptions::default()).expect("sound").clip;
    for repair in [false, true] {
        let clip = parse(leaping.as_bytes(), &KinectOptions { repair, ..Default::default() }).expect("read").clip;
        assert!(clip.notes.iter().any(|n| n.contains("'HandRight' leaps")), "{:?}", clip.notes);
        let off =
            clip.all_positions().iter().zip(sound.all_positions()).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
        assert_eq!(off < 0.06, repair, "{off} m");
    }
}

#[test]
fn joints_in_the_lens_are_not_tracked() {
    // The right hand is lost in two rows, at the place of the sensor.
    let lost = std::cell::Cell::new(0);
    let text = written(
        |t| t,
        |row, p| {
            let joint = lost.replace(lost.get() + 1) % FIGURE.len();
            if (row == 3 || row == 4) && joint == 11 { [0.0; 3] } else { p }
        },
    );
    let clip = parse(text.as_bytes(), &KinectOptions::default()).expect("bridged").clip;
    let sound = parse(recording(&UNEVEN).as_bytes(), &KinectOptions::default()).expect("whole").clip;
    assert!(clip.notes.iter().any(|n| n.contains("not tracked") && n.contains("2 row(s)")), "{:?}", clip.notes);
    let off = clip.all_positions().iter().zip(sound.all_positions()).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
    assert!(off < 0.03, "{off} m");
}

#[test]
fn broken_recordings_are_refused_by_line_and_column() {
    let sound = recording(&UNEVEN);
    let lines: Vec<&str> = sound.lines().collect();
    let edit = |line: usize, cell: usize, value: &str| {
        let mut lines: Vec<String> = lines.iter().map(|l| l.to_string()).collect();
        let mut cells: Vec<&str> = lines[line - 1].split(',').collect();
        cells[cell] = value;
        lines[line - 1] = cells.join(",");
        lines.join("\n")
    };
    let all_nan = lines[0].to_string()
        + "\n"
        + &lines[1..]
            .iter()
            .map(|l| {
                let mut cells: Vec<&str> = l.split(',').collect();
                cells[6] = "NaN";
                cells.join(",") + "\n"
            })
            .collect::<String>();
    let cases: Vec<(String, &[&str])> = vec![
        (String::new(), &["is empty", "Timestamp"]),
        (edit(1, 0, "Stamp"), &["line 1", "'Timestamp' is missing"]),
        (edit(1, 12, "HeadW"), &["line 1", "'HeadZ' is missing"]),
        (edit(3, 6, "1.O2"), &["line 3", "'SpineZ'", "'1.O2' is not a number"]),
        (edit(3, 0, ""), &["line 3", "'Timestamp'"]),
        (edit(4, 0, "36914937.5"), &["line 4", "goes back to 36914937.5", "36914968.025"]),
        (edit(4, 0, "noon"), &["line 4", "'Timestamp'", "noon"]),
        (edit(9, 0, "1e12"), &["more than a day", "milliseconds"]),
        (all_nan, &["'Spine' has no value in any row"]),
        (lines[..2].join("\n"), &["only 1 frame", "at least 2"]),
        (lines[..1].join("\n"), &["only 0 frame"]),
        (format!("{}\n1,2,3\n", lines[..3].join("\n")), &["line 4", "3 cells, expected at least 61"]),
    ];
    for (text, parts) in cases {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("broken.csv");
        std::fs::write(&path, text).expect("written");
        let error = clip::read(&path).expect_err("a broken file was read");
        assert!(matches!(error, ReadError::Kinect { .. }), "{error}");
        let message = error.to_string();
        for part in parts.iter().chain(&["broken.csv"]) {
            assert!(message.contains(part), "no '{part}' in: {message}");
        }
    }
    let gap = KinectOptions { max_gap: 0.01, ..Default::default() };
    let error = parse(edit(4, 6, "").as_bytes(), &gap).expect_err("a gap").to_string();
    assert!(error.contains("line 4") && error.contains("SpineZ") && error.contains("0.01 s"), "{error}");
    for fps in [0.0, -30.0, f64::NAN, 1e9] {
        assert!(parse(sound.as_bytes(), &KinectOptions { fps, ..Default::default() }).is_err());
    }
}
