//! Clips and skeleton maps.

use std::path::Path;

use kinesic_host::clip::map::suggest;
use kinesic_host::clip::{Clip, JointMap, ReadOptions, SkeletonMap, Unit, UpAxis, WriteOptions};
use kinesic_host::clip::{bvh as reader, fbx as scene, gltf as binary, kinect};
use kinesic_host::gait;
use kinesic_host::retarget::retarget;
use kinesic_host::rig::Rig;

/// Reads the bytes as BVH and takes the clip the way that every command takes: another rate, another skeleton, written and read
/// again.
pub fn bvh(data: &[u8]) {
    let Ok(clip) = reader::parse(data, &ReadOptions::default()) else { return };
    used(&clip);
    // What was read can be written, unless a value is too large for the unit, and then reads back with as many joints and frames.
    let Ok(text) = clip.to_bvh(&WriteOptions::default()) else { return };
    let options = ReadOptions { units: Some(Unit::Centimetre), up: Some(UpAxis::Y), ..ReadOptions::default() };
    let again =
        reader::parse(text.as_bytes(), &options).unwrap_or_else(|error| panic!("what we write is refused: {error}"));
    assert_eq!(again.frames(), clip.frames());
}

/// Reads the bytes as glTF, of text or of the binary kind, with no folder beside them.
pub fn gltf(data: &[u8]) {
    let Ok(clip) = binary::read(data, Path::new(""), &ReadOptions::default()) else { return };
    assert_eq!(clip.rotations.len(), clip.frames() * clip.skeleton.len());
    used(&clip);
    // What is written is read again.
    let Ok(bytes) = clip.to_glb() else { return };
    // Two keys less than the shortest step apart are one time in f32.
    let Ok(again) = binary::parse(&bytes, None) else { return };
    assert_eq!(again.skeleton.len(), clip.skeleton.len());
}

/// Reads the bytes as FBX, of text or of the binary kind.
pub fn fbx(data: &[u8]) {
    let Ok(clip) = scene::read(data, Path::new(""), &ReadOptions::default()) else { return };
    assert_eq!(clip.rotations.len(), clip.frames() * clip.skeleton.len());
    used(&clip);
}

/// Reads the bytes as a Kinect recording.
pub fn csv(data: &[u8]) {
    let Ok(recording) = kinect::parse(data, &kinect::KinectOptions::default()) else { return };
    assert_eq!(recording.positions.len(), recording.clip.frames() * recording.clip.skeleton.len());
    used(&recording.clip);
}

/// Reads the bytes as a skeleton map and looks its joints up.
pub fn map(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else { return };
    let Ok(map) = SkeletonMap::parse(text) else { return };
    let skeleton = gait::skeleton();
    if let Ok(joints) = map.resolve(&skeleton) {
        let _ = Rig::new(&skeleton, &joints);
    }
}

fn used(clip: &Clip) {
    let _ = clip.summary();
    let _ = suggest(clip);
    let Some(map) = JointMap::detect(&clip.skeleton) else { return };
    let Ok(own) = Rig::new(&clip.skeleton, &map) else { return };
    let _ = own.locals(&own.poses(clip));
    let skeleton = gait::skeleton();
    let made = JointMap::detect(&skeleton).expect("the gait's names are known");
    let rig = Rig::new(&skeleton, &made).expect("the gait's skeleton is a rig");
    if let Ok(slower) = clip.resample(24.0) {
        let _ = retarget(&slower, &map, &rig).map(|clip| rig.locals(&rig.poses(&clip)));
    }
}
