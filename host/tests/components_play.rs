//! Packs of components through the device's code, on a made walk.

mod components_common;

use components_common::{rig, walk};
use kinesic::LoadError;
use kinesic::components::{Components, ComponentsState};
use kinesic::{Pose, pose};
use kinesic_host::components::{
    Settings, TrainOptions, Trained, bone_error, bones, composed, evaluate, play, play_stored, train,
};
use kinesic_host::pack::{PackFile, Provenance};
use kinesic_host::rig::{MAX_JOINTS, Rig};

fn trained(rig: &Rig) -> Trained {
    let options = TrainOptions { count: Some(12), ..TrainOptions::default() };
    train(rig, &walk(rig, 150, 1.0, 0.1), &walk(rig, 130, 1.8, 0.6), "lively", &options).expect("trains")
}

fn pack(rig: &Rig) -> PackFile {
    PackFile::from_bytes(&trained(rig).model.pack(rig, &Provenance::default()))
}

fn apart(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn the_same_seed_gives_the_same_bytes() {
    let rig = rig();
    assert_eq!(pack(&rig).bytes(), pack(&rig).bytes());
}

#[test]
fn strength_and_mask_of_a_live_stream() {
    let rig = rig();
    let file = pack(&rig);
    let pack = file.pack().expect("loads");
    let source = rig.poses(&walk(&rig, 90, 1.1, 0.2));
    let mut settings = Settings::default();
    settings.controls.strength = 0.0;
    let same = play(&pack, &source, &settings).expect("plays");
    for (a, b) in same.iter().zip(&source) {
        assert!((a.root - b.root).norm() < 1e-6);
        assert!(a.rotations.iter().zip(&b.rotations).take(13).all(|(a, b)| (a.coords - b.coords).norm() < 1e-5));
    }
    settings.controls.strength = 1.0;
    settings.controls.mask[7] = 0.0;
    settings.controls.mask[0] = 0.0;
    let styled = play(&pack, &source, &settings).expect("plays");
    let spine = |poses: &[Pose<MAX_JOINTS>]| poses.iter().map(|p| p.rotations[7].coords).collect::<Vec<_>>();
    assert!(spine(&styled).iter().zip(spine(&source)).all(|(a, b)| (a - b).norm() < 1e-6));
    assert!(styled.iter().zip(&source).all(|(a, b)| (a.root - b.root).norm() < 1e-6));
    settings.controls.mask.fill(1.0);
    let styled = rig.locals(&play(&pack, &source, &settings).expect("plays")).positions;
    let moved = apart(&styled, &rig.locals(&source).positions);
    assert!(moved > 0.05, "the style moves nothing: {moved} m");
}

#[test]
fn the_stored_stream_at_strength_0_is_the_content() {
    let rig = rig();
    let content = walk(&rig, 150, 1.0, 0.1);
    let file = pack(&rig);
    let mut settings = Settings::default();
    settings.controls.strength = 0.0;
    let played = play_stored(&file.pack().expect("loads"), &settings).expect("plays");
    assert_eq!(played.len(), 150);
    let (found, wanted) = (rig.locals(&played), rig.locals(&rig.poses(&content)));
    assert!(apart(&found.positions, &wanted.positions) < 0.03, "{}", apart(&found.positions, &wanted.positions));
    // The path is the content's, from the origin and facing +Z.
    let length = |root: Vec<nalgebra::Vector3<f64>>| (root[149] - root[0]).norm();
    let (a, b) = (length(played.iter().map(|p| p.root.cast()).collect()), length(content.root.clone()));
    assert!((a - b).abs() < 0.02, "{a} {b}");
    // The last frame is followed by the first, from where the last was.
    let pack = file.pack().expect("loads");
    let components = Components::<16, 12>::load(&pack).expect("fits");
    let (mut state, mut out) = (ComponentsState::new(), Pose::identity());
    let roots: Vec<_> = (0..151)
        .map(|_| {
            components.step_stored(&mut state, &mut out);
            out.root
        })
        .collect();
    assert!((roots[150] - roots[149]).norm() < 0.1, "{} {}", roots[149], roots[150]);
}

#[test]
fn composed_bones_stretch_and_restored_ones_do_not() {
    let rig = rig();
    let trained = trained(&rig);
    let bones = bones(&rig);
    let file = PackFile::from_bytes(&trained.model.pack(&rig, &Provenance::default()));
    let pack = file.pack().expect("loads");
    let before = bone_error(&composed(&trained.model, 1.0), 39, &bones);
    assert!(before.max_percent > 0.1, "{before:?}");
    for strength in [0.5, 1.0, 2.0] {
        let mut settings = Settings::default();
        settings.controls.strength = strength;
        let live = play(&pack, &rig.poses(&walk(&rig, 90, 1.1, 0.2)), &settings).expect("plays");
        for played in [live, play_stored(&pack, &settings).expect("plays")] {
            let after = bone_error(&rig.locals(&played).positions, 39, &bones);
            assert!(after.max_percent < 0.1, "{after:?}");
        }
    }
}

#[test]
fn capacities_shapes_and_damage_are_refused() {
    let rig = rig();
    let file = pack(&rig);
    let pack = file.pack().expect("loads");
    let joints = Components::<12, 12>::load(&pack).map(|_| ());
    assert_eq!(joints, Err(LoadError::Capacity { parameter: "JOINTS", found: 13, capacity: 12 }));
    let count = Components::<13, 11>::load(&pack).map(|_| ());
    assert_eq!(count, Err(LoadError::Capacity { parameter: "COUNT", found: 12, capacity: 11 }));
    let other = kinesic::Translator::<16, 64>::load(&pack).map(|_| ());
    assert_eq!(other, Err(LoadError::NoModel { expected: "translator" }));
    let mut bytes = file.bytes().to_vec();
    for at in (0..bytes.len()).step_by(997) {
        bytes[at] ^= 4;
        assert!(PackFile::from_bytes(&bytes).pack().is_err(), "a flipped bit at {at} went unnoticed");
        bytes[at] ^= 4;
    }
    // Tensors of another shape, one at a time: the checksum is right, the model is not.
    let mut model = trained(&rig).model;
    model.track.pop();
    let short = PackFile::from_bytes(&model.pack(&rig, &Provenance::default()));
    let refused = Components::<16, 12>::load(&short.pack().expect("a sound file")).map(|_| ());
    assert_eq!(refused, Err(LoadError::Shape { tensor: "components/weights", found: 1800, expected: 1788 }));
    let mut model = trained(&rig).model;
    model.shift.pop();
    let short = PackFile::from_bytes(&model.pack(&rig, &Provenance::default()));
    assert!(Components::<16, 12>::load(&short.pack().expect("a sound file")).is_err());
    let mut model = trained(&rig).model;
    model.mean[4] = f64::NAN;
    let broken = PackFile::from_bytes(&model.pack(&rig, &Provenance::default()));
    assert!(Components::<16, 12>::load(&broken.pack().expect("a sound file")).is_err());
}

#[test]
fn a_live_step_survives_any_pose() {
    let rig = rig();
    let file = pack(&rig);
    let pack = file.pack().expect("loads");
    let components = Components::<16, 16>::load(&pack).expect("fits");
    let mut state = ComponentsState::new();
    let mut out = Pose::identity();
    let mut source = Pose::<16>::identity();
    for scale in [0.0, 1.0, 1e6, f32::INFINITY, f32::NAN] {
        source.root.x = scale;
        source.rotations[3] =
            nalgebra::UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(scale, 0.0, scale, 0.0));
        components.step(&mut state, &source, &mut out);
    }
    state.reset();
    components.step(&mut state, &Pose::identity(), &mut out);
    assert!(out.rotations.iter().take(13).all(|q| (q.norm() - 1.0).abs() < 1e-5));
    let _ = pose::Controls::<16>::default();
}

#[test]
fn the_report_agrees_with_the_training() {
    let rig = rig();
    let trained = trained(&rig);
    let metric = |name: &str, value| kinesic_host::pack::Metric { name: name.to_owned(), value };
    let recorded = [
        metric("reconstruction_error", trained.reconstruction_error),
        metric("style_distance", trained.style_distance),
    ];
    let file = PackFile::from_bytes(&trained.model.pack(&rig, &Provenance::default()));
    let report = evaluate(&file.pack().expect("loads"), &rig, &recorded).expect("evaluates");
    assert!((report.content_distance - trained.content_distance).abs() < 1e-5);
    assert!((report.density - trained.content.factors.density()).abs() < 1e-9);
    assert!((report.composed_bone_error_max_percent - trained.composed_bones.max_percent).abs() < 1e-2);
    assert!(report.bone_error_max_percent < 0.1);
    assert!(evaluate(&file.pack().expect("loads"), &rig, &[]).is_err());
}
