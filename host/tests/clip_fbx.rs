//! FBX: two files of ours, one written by hand, one that Blender made of a walk of ours (fuzz/corpus/fbx).

use kinesic_host::clip::{self, Clip, ReadError, ReadOptions, Unit};
use nalgebra::Vector3;

const TEXT: &[u8] = include_bytes!("../../fuzz/corpus/fbx/text.fbx");
const LEG: &[u8] = include_bytes!("../../fuzz/corpus/fbx/leg.fbx");

/// What Blender was given.
const SOURCE: &str = "HIERARCHY
ROOT Hips { OFFSET 0 0 0 CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
JOINT LeftUpLeg { OFFSET 9 -6 0 CHANNELS 3 Zrotation Xrotation Yrotation
JOINT LeftLeg { OFFSET 0 -42 0 CHANNELS 3 Zrotation Xrotation Yrotation End Site { OFFSET 0 -41 0 } } } }
MOTION
Frames: 5
Frame Time: 0.0333333333
0.0000 90.7761 0.0000 0.6222 0.0000 6.5508 0.0000 -24.4706 0.0000 0.0000 5.1421 0.0000
3.3737 96.1114 18.9150 0.2404 0.0032 3.2550 0.0000 -10.1398 0.0000 0.0000 4.5918 0.0000
4.2834 94.6921 48.1368 -0.3172 -0.0083 -1.7606 0.0000 8.9005 0.0000 0.0000 8.4072 0.0000
6.2985 90.9314 32.5437 -0.6495 -0.0256 -4.3439 0.0000 14.3711 0.0000 0.0000 29.0762 0.0000
4.8337 93.0352 37.4077 -0.5212 -0.0274 -2.2190 0.0000 2.5419 0.0000 0.0000 52.4835 0.0000
";

/// Reads bytes as a file of a name that says nothing.
fn read(bytes: &[u8]) -> Result<Clip, ReadError> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("clip");
    std::fs::write(&path, bytes).expect("written");
    clip::read_with(&path, &ReadOptions::default())
}

#[test]
fn a_text_file_turns_as_it_says() {
    let clip = read(TEXT).expect("it is read");
    let names: Vec<&str> = clip.skeleton.joints.iter().map(|j| j.name.as_str()).collect();
    assert_eq!((names, clip.frames(), clip.fps()), (vec!["Hips", "Head"], 31, 30.0));
    for (frame, angle) in [(0, 0.0f64), (10, 30.0), (30, 90.0)] {
        let (sin, cos) = angle.to_radians().sin_cos();
        let should = [Vector3::new(0.0, 1.0, 0.0), Vector3::new(0.0, 1.0 + 0.6 * cos, 0.6 * sin)];
        for (is, should) in clip.positions(frame).iter().zip(should) {
            assert!((is - should).norm() < 1e-6, "frame {frame}: {is} {should}");
        }
    }
}

#[test]
fn lengths_are_in_metres_whatever_the_unit_of_the_file() {
    let text = std::str::from_utf8(TEXT).expect("text");
    let centimetres =
        text.replace("\"Number\", \"\",100", "\"Number\", \"\",1").replace("\"A\",0,1,0", "\"A\",0,100,0");
    let clip = read(centimetres.replace("\"A\",0,0.6,0", "\"A\",0,60,0").as_bytes()).expect("it is read");
    for (is, should) in clip.positions(0).iter().zip([1.0, 1.6]) {
        assert!((is - Vector3::new(0.0, should, 0.0)).norm() < 1e-6, "{is}");
    }
}

#[test]
fn what_blender_made_of_a_walk_is_that_walk() {
    let options = ReadOptions { units: Some(Unit::Centimetre), ..ReadOptions::default() };
    let source = clip::bvh::parse(SOURCE.as_bytes(), &options).expect("text");
    let clip = read(LEG).expect("it is read");
    assert_eq!((clip.frames(), clip.fps()), (source.frames(), 30.0));
    for frame in 0..source.frames() {
        for (is, should) in clip.positions(frame).iter().zip(source.positions(frame)) {
            assert!((is - should).norm() < 1e-5, "frame {frame}: {is} {should}");
        }
    }
    // The bones are as long at rest.
    for (is, should) in clip.skeleton.joints.iter().zip(&source.skeleton.joints).skip(1) {
        assert!((is.offset.norm() - should.offset.norm()).abs() < 1e-5, "{}: {}", is.name, is.offset);
    }
}

#[test]
fn what_has_no_motion_is_refused_with_the_reason() {
    let text = std::str::from_utf8(TEXT).expect("text");
    for (bytes, reason) in [
        (LEG.get(..LEG.len() / 2).unwrap_or(&[]).to_vec(), "no FBX that can be read"),
        (text.replace("\"LimbNode\"", "\"Mesh\"").into_bytes(), "no bones"),
        (text.replace("AnimationStack", "Nothing").into_bytes(), "no animation"),
        (text.replace("46186158000", "0").into_bytes(), "no length"),
        (text.replace("46186158000", "4618615800000000").into_bytes(), "more than are read"),
    ] {
        let error = read(&bytes).expect_err(reason).to_string();
        assert!(error.contains(reason), "{error}");
    }
}
