//! int8 networks and int16 translators: near the f32 pack on an unseen walk, refused where there is nothing to round, guarded like every pack.

use std::path::Path;

use kinesic_host::clip::{Clip, JointMap};
use kinesic_host::gait::{Manner, walk};
use kinesic_host::pack::{PackFile, Provenance};
use kinesic_host::prepare::Source;
use kinesic_host::quantise::{QuantiseError, difference, to_int8, to_int16, translated_difference};
use kinesic_host::rig::Rig;

fn model(name: &str) -> PackFile {
    PackFile::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../models").join(name)).unwrap()
}

/// A made walk on the pack's body.
fn unseen(file: &PackFile, manner: &Manner) -> Clip {
    let pack = file.pack().unwrap();
    let rig = Rig::from_pack(&pack).unwrap();
    let clip = walk(manner, 6.0, 60.0, 0.0, 5);
    let map = JointMap::detect(&clip.skeleton).unwrap();
    let fps = f64::from(pack.metadata().frame_rate);
    Source::new("made", clip, map).on_rig(&rig, fps).unwrap()
}

#[test]
fn an_int8_network_is_within_half_a_degree() {
    let file = model("mechanics.kin");
    let bytes = to_int8(&file, &Provenance::default()).unwrap();
    assert_eq!(bytes, to_int8(&file, &Provenance::default()).unwrap());
    let rounded = PackFile::from_bytes(&bytes);
    let clip = unseen(&file, &Manner::WEARY);
    let pack = file.pack().unwrap();
    let rig = Rig::from_pack(&pack).unwrap();
    let found = difference(&pack, &rounded.pack().unwrap(), &rig, &[clip]).unwrap();
    println!("{found:?}, {} bytes", bytes.len());
    // Not zero: the weights were really rounded.
    assert!(found.frames > 300 && found.mean_deg > 1e-3 && found.mean_deg < 0.5 && found.worst_deg < 4.0, "{found:?}");
}

#[test]
fn an_int16_translator_is_within_a_tenth_of_a_degree() {
    let file = model("weary.kin");
    let bytes = to_int16(&file, &Provenance::default()).unwrap();
    assert_eq!(bytes, to_int16(&file, &Provenance::default()).unwrap());
    let rounded = PackFile::from_bytes(&bytes);
    let clips = [Manner::NEUTRAL, Manner::WEARY].map(|manner| unseen(&file, &manner));
    let (before, after) = (file.pack().unwrap(), rounded.pack().unwrap());
    let rig = Rig::from_pack(&before).unwrap();
    let found = translated_difference(&before, &after, &rig, &clips).unwrap();
    println!("{found:?}, {} bytes instead of {}", bytes.len(), file.bytes().len());
    assert!(found.frames > 600 && found.mean_deg > 1e-5 && found.mean_deg < 0.1, "{found:?}");
    assert!(bytes.len() < file.bytes().len());
}

#[test]
fn what_cannot_be_rounded_is_refused() {
    let done = to_int8(&model("mechanics.kin"), &Provenance::default()).unwrap();
    let twice = to_int8(&PackFile::from_bytes(&done), &Provenance::default());
    assert!(matches!(twice, Err(QuantiseError::Done { .. })));
    let none = to_int8(&model("weary.kin"), &Provenance::default());
    assert!(matches!(none, Err(QuantiseError::NoNetwork { found }) if found == "translator"));
    let none = to_int16(&model("mechanics.kin"), &Provenance::default());
    assert!(matches!(none, Err(QuantiseError::NoTranslator { found }) if found == "mechanics"));
    let done = PackFile::from_bytes(&to_int16(&model("weary.kin"), &Provenance::default()).unwrap());
    assert!(matches!(to_int16(&done, &Provenance::default()), Err(QuantiseError::Done { .. })));
}

#[test]
fn a_damaged_int8_pack_is_refused() {
    let bytes = to_int8(&model("mechanics.kin"), &Provenance::default()).unwrap();
    for at in (0..bytes.len()).step_by(7) {
        let mut flipped = bytes.clone();
        flipped[at] ^= 1 << (at % 8);
        assert!(PackFile::from_bytes(&flipped).pack().is_err(), "a flipped bit of byte {at}");
        assert!(PackFile::from_bytes(&bytes[..at]).pack().is_err(), "cut at byte {at}");
    }
}
