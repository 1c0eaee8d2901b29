//! Good files, and every way to spoil them that the cases name.

use std::path::Path;

use kinesic_host::clip::WriteOptions;
use kinesic_host::gait::{Manner, walk};

/// A made-up walk of two seconds as BVH.
fn good(manner: &Manner, seed: u64) -> String {
    walk(manner, 2.0, 60.0, 0.0, seed).to_bvh(&WriteOptions::default()).unwrap()
}

/// `text` with the first `from` replaced, which must be there.
fn swap(text: &str, from: &str, to: &str) -> String {
    assert!(text.contains(from), "no {from}");
    text.replacen(from, to, 1)
}

/// A Kinect recording of five rows at 30 a second; `cell(row, column)` may say something else.
fn kinect(cell: impl Fn(usize, usize) -> Option<String>) -> String {
    const JOINTS: [&str; 20] = [
        "HipCenter",
        "Spine",
        "ShoulderCenter",
        "Head",
        "ShoulderLeft",
        "ElbowLeft",
        "WristLeft",
        "HandLeft",
        "ShoulderRight",
        "ElbowRight",
        "WristRight",
        "HandRight",
        "HipLeft",
        "KneeLeft",
        "AnkleLeft",
        "FootLeft",
        "HipRight",
        "KneeRight",
        "AnkleRight",
        "FootRight",
    ];
    let mut text = String::from("Timestamp");
    JOINTS.iter().for_each(|joint| ["X", "Y", "Z"].iter().for_each(|axis| text += &format!(",{joint}{axis}")));
    for row in 0..5 {
        let cells = (0..61).map(|column| {
            let number = if column == 0 { 33.0 * row as f64 } else { (0.37 * column as f64).sin() };
            cell(row, column).unwrap_or_else(|| number.to_string())
        });
        text += &format!("\n{}", cells.collect::<Vec<_>>().join(","));
    }
    text + "\n"
}

/// Nested joints, or as many beside each other.
fn joints(count: usize, nested: bool) -> String {
    let open = |index: usize| format!("JOINT j{index} {{\nOFFSET 0 1 0\nCHANNELS 1 Xrotation\n");
    let close = "}\n";
    let inner: String = match nested {
        true => (0..count).map(open).chain((0..count).map(|_| close.to_owned())).collect(),
        false => (0..count).map(|index| open(index) + close).collect(),
    };
    format!(
        "HIERARCHY\nROOT r {{\nOFFSET 0 0 0\nCHANNELS 1 Xrotation\n{inner}}}\nMOTION\nFrames: 1\nFrame Time: 0.1\n0\n"
    )
}

/// Writes everything that the cases name into `folder`.
pub fn make(folder: &Path) {
    let write = |name: &str, bytes: &[u8]| std::fs::write(folder.join(name), bytes).unwrap();
    let text = |name: &str, text: String| write(name, text.as_bytes());
    let walk = good(&Manner::NEUTRAL, 1);
    text("weary.bvh", good(&Manner::WEARY, 2));
    text("walk.bvh", walk.clone());
    let at_motion = walk.find("MOTION").unwrap();
    let lines: Vec<&str> = walk.lines().collect();
    let rows = lines.iter().position(|l| l.starts_with("Frame Time")).unwrap() + 1;
    let row = |number: usize, change: &dyn Fn(&str) -> String| {
        let changed = |(at, line): (usize, &&str)| if at == rows + number { change(line) } else { (*line).to_owned() };
        lines.iter().enumerate().map(changed).collect::<Vec<_>>().join("\n")
    };
    let head = |frames: usize| swap(&lines[..rows + frames].join("\n"), "Frames: 120", &format!("Frames: {frames}"));

    text("labels.tsv", "file\tlabel\tspeed\nwalk.bvh\tfresh\t1\nweary.bvh\tweary\t1\n".into());
    text("labels-gone.tsv", "file\tlabel\nwalk.bvh\tfresh\ngone.bvh\tweary\n".into());
    text("labels-clip.tsv", "file\tlabel\nwalk.bvh\tfresh\nempty.bvh\tweary\n".into());
    text("labels-nameless.tsv", "file\tlabel\n\tfresh\n".into());

    write("empty.bvh", b"");
    text("words.bvh", "once upon a time".into());
    write("binary.bvh", &[0x89, b'P', b'N', b'G', 0, 1, 2, 3]);
    write("latin1.bvh", &[b"HIERARCHY\nROOT H\xfcfte {\n", walk.as_bytes()].concat());
    text("hierarchy-only.bvh", walk[..at_motion].into());
    text("cut-hierarchy.bvh", walk[..at_motion / 2].into());
    text("cut-motion.bvh", walk[..at_motion + 5000].into());
    text("frames-huge.bvh", swap(&walk, "Frames: 120", "Frames: 18446744073709551615"));
    text("frames-minus.bvh", swap(&walk, "Frames: 120", "Frames: -1"));
    text("time-zero.bvh", swap(&walk, "Frame Time: 0.0", "Frame Time: 0.00 0.0"));
    text("time-nan.bvh", swap(&walk, "Frame Time: 0.0", "Frame Time: nan0.0"));
    text("time-year.bvh", swap(&walk, "Frame Time: 0.0", "Frame Time: 3e7\n0"));
    text("time-long.bvh", swap(&walk, lines[rows - 1], "Frame Time: 31536000"));
    text("word-in-row.bvh", row(3, &|line| swap(line, " ", " left ")));
    text("nan-in-row.bvh", row(4, &|line| format!("nan {}", line.split_once(' ').unwrap().1)));
    text("inf-in-row.bvh", row(4, &|line| format!("1e999 {}", line.split_once(' ').unwrap().1)));
    text("short-row.bvh", row(5, &|line| line.rsplit_once(' ').unwrap().0.into()));
    text("long-row.bvh", row(5, &|line| format!("{line} 1")));
    text("open-brace.bvh", swap(&walk, "}\n", "\n"));
    text("extra-brace.bvh", swap(&walk, "MOTION", "}\nMOTION"));
    text("nameless.bvh", swap(&walk, "JOINT LeftLeg", "JOINT"));
    text("offset-word.bvh", swap(&walk, "OFFSET ", "OFFSET x "));
    text("no-offset.bvh", swap(&walk, "OFFSET", "# OFFSET"));
    text("channels.bvh", swap(&walk, "CHANNELS 3", "CHANNELS 4"));
    text("channel-name.bvh", swap(&walk, "CHANNELS 3 Zrotation", "CHANNELS 3 Wrotation"));
    text("too-many.bvh", joints(1500, false));
    text("too-deep.bvh", joints(400, true));
    text("giant.bvh", walk.replace("OFFSET 0.", "OFFSET 90000."));
    text("two-frames.bvh", head(2));
    text("names.bvh", walk.replace("Left", "Sinister").replace("Right", "Dexter").replace("Hips", "Middle"));

    text("good.csv", kinect(|_, _| None));
    text("header.csv", kinect(|_, _| None).lines().next().unwrap().into());
    text("column.csv", swap(&kinect(|_, _| None), "HeadY", "HatY"));
    text("word.csv", kinect(|row, column| (row == 2 && column == 7).then(|| "left".into())));
    text("backward.csv", kinect(|row, column| (row == 3 && column == 0).then(|| "1".into())));
    text("no-time.csv", kinect(|row, column| (row == 3 && column == 0).then(|| "nan".into())));
    text("gap.csv", kinect(|_, column| (column == 9).then(String::new)));
    text("years.csv", kinect(|row, column| (column == 0).then(|| (1e12 * row as f64).to_string())));
    text("pause.csv", kinect(|row, column| (row > 1 && column == 0).then(|| (24e6 + row as f64).to_string())));
    text("short.csv", swap(&kinect(|_, _| None), "\n66,", "\n66\n99,"));
    text("other.csv", "name,age\nAnn,4\n".into());

    let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models");
    for name in ["weary.kin", "mechanics.kin"] {
        std::fs::copy(models.join(name), folder.join(name)).unwrap();
    }
    let (moods, rig) = kinesic_host::emotion::synthetic::sized(2, [4, 6, 3]);
    write("moods.kin", &moods.pack(&rig, &kinesic_host::pack::Provenance::default()));
    let pack = std::fs::read(folder.join("weary.kin")).unwrap();
    let spoiled = |at: usize, byte: u8| {
        let mut bytes = pack.clone();
        bytes[at] = byte;
        bytes
    };
    write("empty.kin", b"");
    write("cut.kin", &pack[..3000]);
    write("stub.kin", &pack[..7]);
    write("longer.kin", &[&pack[..], b"\n"].concat());
    write("version.kin", &spoiled(4, 9));
    write("kind.kin", &spoiled(7, 9));
    write("flipped.kin", &spoiled(9000, pack[9000] ^ 1));
    text("words.kin", "KNS is not the magic".into());

    let map = |name: &str, body: &str| text(name, body.into());
    map("map-not.toml", "pelvis: Hips\n");
    map("map-key.toml", "joint = 3\n[joints]\npelvis = \"Hips\"\n");
    map("map-canonical.toml", "[joints]\npelvis = \"Hips\"\nl_kne = \"LeftLeg\"\n");
    map("map-number.toml", "[joints]\npelvis = 3\n");
    map("map-pelvis.toml", "[joints]\nhead = \"Head\"\n");
    map("map-missing.toml", "[joints]\npelvis = \"Hip\"\n");
    map("map-units.toml", "units = \"furlong\"\n[joints]\npelvis = \"Hips\"\n");
    map("map-none.toml", "units = \"cm\"\n");
    map("map-hips.toml", "[joints]\npelvis = \"Hips\"\n");
    write("map-binary.toml", &[0xff, 0xfe, 0]);

    map("pairs.tsv", "neutral\tstyled\tstyle\nwalk.bvh\tweary.bvh\tsad\n");
    map("pairs-gone.tsv", "neutral\tstyled\nwalk.bvh\tgone.bvh\n");
    map("pairs-column.tsv", "a\tb\nwalk.bvh\tweary.bvh\n");
    map("pairs-ragged.tsv", "neutral\tstyled\nwalk.bvh\n");
    map("list.tsv", "file\tlabel\nwalk.bvh\tplain\n");
    let robot = "<robot name=\"r\"><link name=\"a\"/><link name=\"b\"/><joint name=\"neck\" type=\"revolute\"><parent link=\"a\"/>\
                 <child link=\"b\"/><limit lower=\"-1\" upper=\"1\" velocity=\"3\"/></joint></robot>";
    map("robot.urdf", robot);
    map("robot-cut.urdf", &robot[..120]);
    map("robot-loop.urdf", &swap(robot, "<child link=\"b\"", "<child link=\"a\""));
    map("robot-free.urdf", &swap(robot, "<limit lower=\"-1\" upper=\"1\" velocity=\"3\"/>", ""));
    write("robot-binary.urdf", &[0xff, 0xfe, 0, 1]);
    map("servos.toml", "[[servo]]\nname = \"pan\"\nunit = \"deg\"\nmin = -90\nmax = 90\n");
    map("robot-map.toml", "acceleration = 20\n[joints]\nhead = \"neck\"\n");
    std::fs::create_dir(folder.join("hollow")).unwrap();
    std::fs::create_dir(folder.join("taken.bvh")).unwrap();
    std::fs::create_dir(folder.join("taken.kin")).unwrap();
}
