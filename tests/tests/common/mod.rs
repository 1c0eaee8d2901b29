//! Small packs from made walks.
#![allow(dead_code, missing_docs, reason = "each test file uses a part")]

use kinesic_host::clip::{Clip, JointMap};
use kinesic_host::gait::{Manner, walk};
use kinesic_host::pack::{PackFile, Provenance};
use kinesic_host::rig::Rig;
use kinesic_host::translate::{Alignment, FormChoice, TrainOptions, TrainPair, Trained, train};

pub const FPS: f64 = 60.0;

pub fn neutral(seed: u64) -> Clip {
    walk(&Manner::NEUTRAL, 4.0, FPS, 0.0, seed)
}

pub fn weary(seed: u64) -> Clip {
    walk(&Manner::WEARY, 5.3, FPS, 0.0, seed)
}

pub fn rig() -> Rig {
    let skeleton = kinesic_host::gait::skeleton();
    Rig::new(&skeleton, &JointMap::detect(&skeleton).unwrap()).unwrap()
}

pub fn trained(form: FormChoice, order: usize) -> Trained {
    let rig = rig();
    let locals = |clip: &Clip| rig.locals(&rig.poses(clip));
    let pair = TrainPair {
        source_name: "neutral".into(),
        target_name: "weary".into(),
        source: locals(&neutral(1)),
        target: locals(&weary(2)),
    };
    // The alignment of the golden packs.
    let alignment = Some(Alignment::Warp);
    // Nor have they a gate.
    let options = TrainOptions { form, order: Some(order), mirror: Some(false), alignment, gate: false };
    train(&rig, &[pair], "weary", FPS, &options, &|_| {}).unwrap()
}

pub fn packed(trained: &Trained) -> PackFile {
    let provenance =
        Provenance { tool: "kinesic-tests".into(), baselines: trained.baselines.clone(), ..Provenance::default() };
    PackFile::from_bytes(&trained.model.pack(&rig(), &provenance))
}

pub fn pack(form: FormChoice, order: usize) -> PackFile {
    packed(&trained(form, order))
}
