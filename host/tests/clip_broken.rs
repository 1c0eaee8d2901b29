//! Broken files: each is refused with a message that names the place and the cause.

use std::path::PathBuf;

use kinesic_host::clip::{self, ReadOptions, Unit};

/// A sound file; every case below breaks one thing. Line numbers in the cases count here.
const SOUND: &str = "HIERARCHY
ROOT Hips
{
  OFFSET 0 0 0
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  JOINT Chest
  {
    OFFSET 0 40 0
    CHANNELS 3 Zrotation Xrotation Yrotation
    End Site
    {
      OFFSET 0 50 0
    }
  }
}
MOTION
Frames: 2
Frame Time: 0.01
0 90 0 1 2 3 4 5 6
0 91 0 1 2 3 4 5 6
";

/// The message for a text; the unit is given, so that nothing but the text can be at fault.
fn message(bytes: &[u8], extension: &str) -> String {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join(format!("broken.{extension}"));
    std::fs::write(&path, bytes).expect("written");
    let options = ReadOptions { units: Some(Unit::Centimetre), ..Default::default() };
    let error = clip::read_with(&path, &options).expect_err("a broken file was read");
    let message = error.to_string();
    assert!(message.contains("broken."), "no file name in: {message}");
    message
}

fn check(name: &str, message: &str, parts: &[&str]) {
    for part in parts {
        assert!(message.contains(part), "{name}: no '{part}' in: {message}");
    }
}

#[test]
fn the_sound_file_is_read() {
    let options = ReadOptions { units: Some(Unit::Centimetre), ..Default::default() };
    let clip = clip::bvh::parse(SOUND.as_bytes(), &options).expect("a sound file");
    assert_eq!((clip.frames(), clip.skeleton.len()), (2, 2));
}

#[test]
fn broken_bvh_is_refused_by_place_and_cause() {
    let swap = |from: &str, to: &str| {
        assert!(SOUND.contains(from), "'{from}' is not in the sound file");
        SOUND.replacen(from, to, 1).into_bytes()
    };
    let offset = "    OFFSET 0 40 0\n";
    let cases: Vec<(&str, Vec<u8>, &[&str])> = vec![
        ("empty", vec![], &["is empty"]),
        ("blank", b" \r\n\t\n".to_vec(), &["is empty"]),
        ("not a BVH", b"solid cube\nfacet".to_vec(), &["line 1", "expected HIERARCHY", "solid"]),
        ("no HIERARCHY", swap("HIERARCHY\n", ""), &["line 1", "HIERARCHY is missing", "ROOT"]),
        ("no ROOT", swap("ROOT Hips", "JOINT Hips"), &["line 2", "expected ROOT", "JOINT"]),
        ("no MOTION", swap("MOTION\n", ""), &["line 16", "expected MOTION", "Frames:"]),
        ("only hierarchy", SOUND.split("MOTION").next().unwrap().into(), &["expected MOTION", "end of the file"]),
        ("brace missing", swap("  }\n}\n", "  }\n"), &["line 15", "not balanced", "Hips", "line 2"]),
        ("brace too many", swap("}\nMOTION", "}\n}\nMOTION"), &["line 16", "'}' too many"]),
        ("open brace missing", swap("Chest\n  {\n", "Chest\n"), &["line 7", "expected '{'", "Chest", "OFFSET"]),
        ("no OFFSET", swap(offset, ""), &["line 6", "Chest", "no OFFSET"]),
        ("two OFFSETs", swap(offset, "OFFSET 0 1 2 OFFSET 0 1 2\n"), &["line 8", "Chest", "second OFFSET"]),
        ("OFFSET of 2", swap("0 40 0", "0 40"), &["line 8", "Chest", "has 2 numbers, expected 3"]),
        ("OFFSET of 4", swap("0 40 0", "0 40 0 7"), &["line 8", "Chest", "has 4 numbers, expected 3"]),
        ("OFFSET of words", swap("0 40 0", "0 fourty 0"), &["line 8", "Chest", "'fourty' is not a finite number"]),
        ("OFFSET NaN", swap("0 40 0", "0 nan 0"), &["line 8", "Chest", "'nan' is not a finite number"]),
        ("too few channels", swap("CHANNELS 3", "CHANNELS 4"), &["line 9", "Chest", "announces 4 channels, found 3"]),
        ("too many channels", swap("CHANNELS 3", "CHANNELS 2"), &["line 9", "Chest", "announces 2 channels, found 3"]),
        ("no channel count", swap("CHANNELS 3 ", "CHANNELS "), &["line 9", "Chest", "'Zrotation' is not a count"]),
        ("channel count 7", swap("CHANNELS 3", "CHANNELS 7"), &["line 9", "Chest", "announces 7 channels, found 3"]),
        ("unknown channel", swap("3 Zrotation", "3 Wrotation"), &["line 9", "Chest", "unknown channel 'Wrotation'"]),
        ("channel twice", swap("3 Zrotation", "3 Xrotation"), &["line 9", "Chest", "'Xrotation' twice"]),
        ("no name", swap("JOINT Chest", "JOINT "), &["line 6", "JOINT without a name"]),
        ("second ROOT broken", swap("MOTION", "ROOT Other\n{\n}\nMOTION"), &["line 16", "Other", "no OFFSET"]),
        ("stray word", swap("End Site", "SCALE 1"), &["line 10", "found 'SCALE'", "Chest"]),
        ("broken end site", swap("OFFSET 0 50 0", "0 50 0"), &["line 12", "End Site of joint 'Chest'"]),
        ("cut in the hierarchy", SOUND[..120].into(), &["ends inside the hierarchy", "line "]),
        ("Frames negative", swap("Frames: 2", "Frames: -2"), &["line 17", "-2", "whole number"]),
        ("Frames garbage", swap("Frames: 2", "Frames: two"), &["line 17", "two"]),
        ("no Frame Time", swap("Frame Time: 0.01\n", ""), &["line 18", "expected 'Frame Time: seconds'"]),
        ("Frame Time zero", swap("Time: 0.01", "Time: 0"), &["line 18", "from 0.00001 to 10"]),
        ("Frame Time negative", swap("Time: 0.01", "Time: -0.01"), &["line 18", "-0.01", "from 0.00001 to 10"]),
        ("Frame Time NaN", swap("Time: 0.01", "Time: NaN"), &["line 18", "NaN", "from 0.00001 to 10"]),
        ("too few values", swap("3 4 5 6\n", "3 4 5\n"), &["line 19", "frame 1 has 8 values, expected 9"]),
        ("too many values", swap("3 4 5 6\n", "3 4 5 6 x 7\n"), &["line 19", "frame 1 has 11 values, expected 9"]),
        ("cut in the last line", SOUND[..SOUND.len() - 6].into(), &["line 20", "frame 2 has 6", "cut off"]),
        (
            "a word",
            swap("0 91 0", "0 9l 0"),
            &["line 20", "frame 2, value 2", "'Hips', Yposition", "'9l' is not a number"],
        ),
        ("NaN", swap("0 91 0", "0 91 nan"), &["line 20", "frame 2, value 3", "Zposition", "'nan' is not finite"]),
        ("infinite", swap("3 4 5 6\n", "3 4 5 1e999\n"), &["line 19", "value 9", "'Chest', Yrotation", "not finite"]),
        ("fewer frames", swap("Frames: 2", "Frames: 4"), &["line 21", "after 2 frames", "line 17 declares 4"]),
        ("huge claim", swap("Frames: 2", "Frames: 18446744073709551615"), &["line 21", "after 2 frames"]),
        (
            "no channels at all",
            b"HIERARCHY ROOT a { OFFSET 0 1 0 CHANNELS 0 } MOTION\nFrames: 1\n".into(),
            &["no joint has a channel"],
        ),
        ("binary", b"HIERARCHY\nROOT \0\x01\x02".to_vec(), &["line 2", "0x00", "not UTF-8"]),
        ("Latin-1", b"HIERARCHY\nROOT H\xfcfte\n{".to_vec(), &["line 2", "0xfc", "not UTF-8"]),
        ("UTF-16", "HIERARCHY".encode_utf16().flat_map(u16::to_le_bytes).collect(), &["line 1", "expected ROOT"]),
        ("too many joints", many(1100, 1), &["J1024", "at most 1024"]),
        ("too deep", many(1100, 1100), &["nested deeper than 256"]),
    ];
    assert!(cases.len() >= 20);
    for (name, bytes, parts) in cases {
        check(name, &message(&bytes, "bvh"), parts);
    }
}

/// A hierarchy of many joints, nested up to a depth.
fn many(joints: usize, depth: usize) -> Vec<u8> {
    let mut text = String::from("HIERARCHY\nROOT J0\n{\nOFFSET 0 0 0\nCHANNELS 0\n");
    for j in 1..joints {
        text += &format!("JOINT J{j}\n{{\nOFFSET 0 1 0\nCHANNELS 0\n{}", if depth == 1 { "}\n" } else { "" });
    }
    text.into_bytes()
}

#[test]
fn no_prefix_of_a_file_panics_or_passes() {
    let options = ReadOptions { units: Some(Unit::Centimetre), ..Default::default() };
    // The last digit, and the line's end, may go: what is left is a whole file.
    for length in 0..SOUND.len() - 2 {
        let result = clip::bvh::parse(&SOUND.as_bytes()[..length], &options);
        // Without the last line whole frames are left, one fewer than declared: read, and said.
        let said = |clip: &clip::Clip| clip.notes.iter().any(|n| n.contains("declares 2 frames, the file has 1"));
        assert!(result.as_ref().map_or(true, said), "the first {length} bytes were read");
    }
}

#[test]
fn paths_that_are_no_clip() {
    let missing = clip::read("no/such/file.bvh").expect_err("missing").to_string();
    check("missing", &missing, &["no/such/file.bvh", "no such file"]);
    let folder = tempfile::tempdir().expect("a folder");
    check("folder", &clip::read(folder.path()).expect_err("folder").to_string(), &["folder", "Name a .bvh"]);
    check("unknown", &message(b"once upon a time", "txt"), &["once upon", ".bvh", ".csv"]);
    check("empty", &message(b"", "mb"), &["an empty file", "BVH"]);
    check("binary", &message(b"\x7fELF\0\0", "mb"), &["binary", "BVH"]);
    let path: PathBuf = folder.path().join("really.txt");
    std::fs::write(&path, SOUND.replace("40", "90")).expect("written");
    // Content goes before extension.
    assert!(clip::read(&path).is_ok());
}

#[test]
fn a_size_that_is_nobody_asks_for_the_unit() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("ant.bvh");
    std::fs::write(&path, SOUND.replace("40", "0.004").replace("50", "0.003")).expect("written");
    let message = clip::read(&path).expect_err("no unit fits").to_string();
    check("ant", &message, &["ant.bvh", "unit of length", "0.0070", "--units"]);
    let options = ReadOptions { units: Some(Unit::Metre), ..Default::default() };
    let clip = clip::read_with(&path, &options).expect("the unit is given");
    assert_eq!(clip.skeleton.joints[1].offset.y, 0.004);
}
