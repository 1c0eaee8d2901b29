//! int8 networks: near the f32 pack on an unseen walk, refused where there is nothing to round, guarded like every pack.

use std::path::{Path, PathBuf};

use kinesic_host::clip::JointMap;
use kinesic_host::gait::{Manner, walk};
use kinesic_host::pack::{PackFile, Provenance};
use kinesic_host::prepare::Source;
use kinesic_host::quantise::{QuantiseError, difference, to_int8};
use kinesic_host::rig::Rig;

fn model(name: &str) -> PackFile {
    PackFile::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../models").join(name)).unwrap()
}

#[test]
fn an_int8_network_is_within_half_a_degree() {
    let file = model("mechanics.kin");
    let bytes = to_int8(&file, &Provenance::default()).unwrap();
    assert_eq!(bytes, to_int8(&file, &Provenance::default()).unwrap());
    let rounded = PackFile::from_bytes(&bytes);
    let rig = Rig::from_pack(&file.pack().unwrap()).unwrap();
    let clip = walk(&Manner::WEARY, 6.0, 60.0, 0.0, 5);
    let map = JointMap::detect(&clip.skeleton).unwrap();
    let poses = rig.poses(&Source { path: PathBuf::from("made"), clip, map }.on_rig(&rig, 60.0).unwrap());
    let found = difference(&file.pack().unwrap(), &rounded.pack().unwrap(), &[poses]).unwrap();
    println!("{found:?}, {} bytes", bytes.len());
    // Not zero: the weights were really rounded.
    assert!(found.frames > 300 && found.mean_deg > 1e-3 && found.mean_deg < 0.5 && found.worst_deg < 4.0, "{found:?}");
}

#[test]
fn what_cannot_be_rounded_is_refused() {
    let done = to_int8(&model("mechanics.kin"), &Provenance::default()).unwrap();
    let twice = to_int8(&PackFile::from_bytes(&done), &Provenance::default());
    assert!(matches!(twice, Err(QuantiseError::Done)));
    let none = to_int8(&model("weary.kin"), &Provenance::default());
    assert!(matches!(none, Err(QuantiseError::NoNetwork { found }) if found == "translator"));
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
