//! BVH that is broken in common ways: read with a note where the meaning is certain, refused with the cause where not.

use std::io::Write;
use std::path::Path;

use kinesic_host::clip::{self, Clip, ReadError, ReadOptions};

/// A sound file; every case below breaks one thing of it.
const SOUND: &str = "\
HIERARCHY
ROOT Hips
{
  OFFSET 0 0 0
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  JOINT Chest
  {
    OFFSET 0 60.5 0
    CHANNELS 3 Zrotation Xrotation Yrotation
    End Site
    {
      OFFSET 0 30 0
    }
  }
  JOINT Leg
  {
    OFFSET 0 -90 0
    CHANNELS 3 Zrotation Xrotation Yrotation
    End Site
    {
      OFFSET 0 0 40
    }
  }
}
MOTION
Frames: 3
Frame Time: 0.033333
0.5 90 0 0 0 0 1 10 0 0 5 0
0.5 90 1 0 0 0 1 11 0 0 6 0
0.5 90 2 0 0 0 1 12 0 -7 -7 0
";

fn written(folder: &Path, name: &str, bytes: &[u8], options: &ReadOptions) -> Result<Clip, ReadError> {
    let path = folder.join(name);
    std::fs::write(&path, bytes).expect("written");
    clip::read_with(&path, options)
}

fn same(a: &Clip, b: &Clip) -> bool {
    let near = a.rotations.iter().zip(&b.rotations).all(|(a, b)| a.angle_to(b) < 1e-9);
    a.frames() == b.frames() && a.root == b.root && near && (a.frame_time - b.frame_time).abs() < 1e-12
}

#[test]
fn common_faults_with_a_certain_meaning_are_read_and_noted() {
    let folder = tempfile::tempdir().expect("a folder");
    let read = |name: &str, bytes: &[u8]| {
        written(folder.path(), name, bytes, &ReadOptions::default()).unwrap_or_else(|e| panic!("{name}: {e}"))
    };
    let sound = read("sound.bvh", SOUND.as_bytes());
    let swap = |from: &str, to: &str| {
        assert!(SOUND.contains(from), "{from}");
        SOUND.replacen(from, to, 1).into_bytes()
    };
    let utf16: Vec<u8> = "\u{feff}".encode_utf16().chain(SOUND.encode_utf16()).flat_map(u16::to_le_bytes).collect();
    let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    packed.write_all(SOUND.as_bytes()).expect("packed");
    let two_bytes = |name: &[u8]| {
        let mut text = SOUND.as_bytes().to_vec();
        let at = SOUND.find("Chest").expect("there");
        text.splice(at..at + 5, name.iter().copied());
        text
    };
    let shift_jis = two_bytes(&[0x8f, 0xe3, b'1']);
    let wrapped = SOUND.replace("0 0 0 1 1", "0 0 0\n1 1");
    let three = "    CHANNELS 3 Zrotation Xrotation Yrotation\n    End Site\n    {\n      OFFSET 0 30";
    let cases: Vec<(&str, Vec<u8>, &str)> = vec![
        ("one frame more", swap("Frames: 3", "Frames: 2"), "declares 2 frames, the file has 3"),
        ("one frame fewer", swap("Frames: 3", "Frames: 4"), "declares 4 frames, the file has 3"),
        ("no count", swap("Frames: 3\n", ""), "not given"),
        ("count 0", swap("Frames: 3", "Frames: 0"), "not given"),
        ("wrapped", wrapped.clone().into_bytes(), "broken over several lines"),
        ("CR", SOUND.replace('\n', "\r").into_bytes(), "CR alone"),
        ("UTF-16", utf16, "UTF-16"),
        ("gzip", packed.finish().expect("packed"), "gzip"),
        ("commas", SOUND.replace('.', ",").into_bytes(), "decimal commas"),
        ("Shift-JIS", shift_jis, "not UTF-8"),
        ("End Site with channels", swap("OFFSET 0 30 0\n", "OFFSET 0 30 0\nCHANNELS 0\n"), ""),
        ("EndSite", swap("End Site", "EndSite"), ""),
        ("no colon", swap("Frames: 3\nFrame Time: 0", "Frames 3\nFrame Time 0"), ""),
        ("name twice", swap("JOINT Leg", "JOINT Chest"), "'Chest_2'"),
        ("CR and a last LF", (SOUND.replace('\n', "\r") + "\n").into_bytes(), "CR alone"),
        ("frame time first", swap("Frames: 3\nFrame Time: 0.033333", "Frame Time: 0.033333\nFrames: 3"), ""),
        ("empty count", swap("Frames: 3", "Frames:"), "not given"),
        ("whole numbers between commas", swap("0.5 90 0 0 0 0 1 10 0 0 5 0", "0.5,90,0,0,0,0,1,10,0,0,5,0"), "between"),
        ("wrapped, one frame more", wrapped.replace("Frames: 3", "Frames: 2").into_bytes(), "over several lines"),
        ("wrapped, no count", wrapped.replace("Frames: 3", "Frames: 0").into_bytes(), "over several lines"),
        ("wrapped and glued", wrapped.replace("0 -7 -7 0", "0-7-7 0").into_bytes(), "without a blank"),
        ("glued OFFSET", swap("OFFSET 0 -90 0", "OFFSET 0.0-90.0 0.0"), "'0.0-90.0' was taken apart"),
        ("Shift-JIS with braces in it", two_bytes(b"\x83\x7b\x83\x7d\x81\x5b"), "not UTF-8"),
        ("GBK with a brace in it", two_bytes(b"\xb0\x7b"), "not UTF-8"),
        ("glued minus", SOUND.replace("0 -7 -7 0", "0-7-7 0").into_bytes(), "without a blank"),
        (
            "scale",
            SOUND
                .replace("6 Xposition", "9 Xscale Yscale Zscale Xposition")
                .replace("\n0.5 90", "\n1 1 1 0.5 90")
                .into_bytes(),
            "Scale",
        ),
    ];
    for (name, bytes, note) in &cases {
        let clip = read(&format!("{name}.bvh"), bytes);
        assert!(same(&clip, &sound), "{name}: {:?}", clip.root);
        assert!(note.is_empty() || clip.notes.iter().any(|n| n.contains(note)), "{name}: {:?}", clip.notes);
    }
    // A number that is missing is no line that was broken.
    let missing = wrapped.replace("Frames: 3", "Frames: 2").replace("0.5 90 1 0", "0.5 90 1");
    let error = written(folder.path(), "missing.bvh", missing.as_bytes(), &ReadOptions::default());
    assert!(error.expect_err("a number is missing").to_string().contains("expected 12"));
    let rigid = swap(three, "    End Site\n    {\n      OFFSET 0 30");
    let rigid = String::from_utf8(rigid)
        .expect("text")
        .replace(" 1 10 0 0", " 0")
        .replace(" 1 11 0 0", " 0")
        .replace(" 1 12 0 -7", " -7");
    let rigid = read("rigid.bvh", rigid.as_bytes());
    assert_eq!(rigid.frames(), 3);
    assert!(rigid.notes.iter().any(|n| n.contains("'Chest' has no CHANNELS")), "{:?}", rigid.notes);
}

#[test]
fn one_of_several_figures_is_chosen_by_its_root() {
    let folder = tempfile::tempdir().expect("a folder");
    let (hierarchy, motion) = SOUND.split_once("MOTION").expect("both");
    let figure = hierarchy.strip_prefix("HIERARCHY\n").expect("there");
    let second =
        figure.replace("Hips", "Hips2").replace("Chest", "Chest2").replace("Leg", "Leg2").replace("60.5", "61");
    let lines: String = motion
        .lines()
        .map(
            |l| if l.starts_with("0.5") { format!("{l} {}\n", l.replacen("0.5", "0.75", 1)) } else { format!("{l}\n") },
        )
        .collect();
    let both = format!("HIERARCHY\n{figure}{second}MOTION{lines}");
    let first = written(folder.path(), "two.bvh", both.as_bytes(), &ReadOptions::default()).expect("the first");
    assert_eq!((first.skeleton.joints[0].name.as_str(), first.frames(), first.skeleton.len()), ("Hips", 3, 3));
    assert!(first.notes.iter().any(|n| n.contains("2 figures")), "{:?}", first.notes);
    // Two figures of one kind: the names of their joints are no names given twice.
    let twins = format!("HIERARCHY\n{figure}{figure}MOTION{lines}");
    let second = ReadOptions { root: Some("Hips_2".into()), ..Default::default() };
    let second = written(folder.path(), "twins.bvh", twins.as_bytes(), &second).expect("the second");
    assert_eq!(second.skeleton.joints[1].name, "Chest");
    assert_eq!(second.notes.iter().filter(|n| n.contains("was used")).count(), 1, "{:?}", second.notes);
    let named = |root: &str| ReadOptions { root: Some(root.into()), ..Default::default() };
    let second = written(folder.path(), "two.bvh", both.as_bytes(), &named("Hips2")).expect("the second");
    assert_eq!(second.skeleton.joints[1].name, "Chest2");
    assert!((second.root[0].x / first.root[0].x - 1.5).abs() < 1e-9);
    let error =
        written(folder.path(), "two.bvh", both.as_bytes(), &named("Hips3")).expect_err("no such root").to_string();
    assert!(error.contains("'Hips', 'Hips2'"), "{error}");
}

#[test]
fn strictness_refuses_an_assumption_and_takes_what_is_given() {
    let folder = tempfile::tempdir().expect("a folder");
    let strict = ReadOptions { strict: true, ..Default::default() };
    let error = written(folder.path(), "a.bvh", SOUND.as_bytes(), &strict).expect_err("assumed").to_string();
    assert!(error.contains("--strict") && error.contains("Units"), "{error}");
}
