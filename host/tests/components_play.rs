//! Packs of components through the device's code, on a made walk.

mod components_common;

use components_common::walk;
use kinesic::components::{Components, ComponentsState};
use kinesic::{Frame, LoadError, Pack, Pose};
use kinesic_host::clip::Clip;
use kinesic_host::components::{self, RECORDED, Settings, TrainOptions, Trained, evaluate, train};
use kinesic_host::pack::{PackFile, Provenance};
use kinesic_host::rig::{MAX_JOINTS, Rig};
use nalgebra::{UnitQuaternion, Vector3, Vector4};

/// The figure's rig, centred on both walks.
fn rig() -> Rig {
    let rig = components_common::rig();
    let [content, style] = [walk(&rig, 150, 1.0, 0.1), walk(&rig, 130, 1.8, 0.6)].map(|clip| rig.poses(&clip));
    rig.centred(&[&content, &style])
}

fn trained(rig: &Rig) -> Trained {
    let options = TrainOptions { count: Some(12), ..TrainOptions::default() };
    train(rig, &walk(rig, 150, 1.0, 0.1), &walk(rig, 130, 1.8, 0.6), "lively", &options).expect("trains")
}

fn pack(rig: &Rig) -> PackFile {
    PackFile::from_bytes(&trained(rig).model.pack(rig, &Provenance::default()))
}

/// The poses that a clip becomes.
fn play(pack: &Pack, rig: &Rig, source: &Clip, settings: &Settings) -> Vec<Pose<MAX_JOINTS>> {
    rig.poses(&components::play(pack, rig, source, settings).expect("plays"))
}

/// The poses of the stored stream.
fn play_stored(pack: &Pack, rig: &Rig, settings: &Settings) -> Vec<Pose<MAX_JOINTS>> {
    rig.poses(&components::play_stored(pack, rig, settings).expect("plays"))
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
    let clip = walk(&rig, 90, 1.1, 0.2);
    let source = rig.poses(&clip);
    let mut settings = Settings::default();
    settings.controls.strength = 0.0;
    let same = play(&pack, &rig, &clip, &settings);
    for (a, b) in same.iter().zip(&source) {
        assert!((a.root - b.root).norm() < 1e-6);
        assert!(a.rotations.iter().zip(&b.rotations).take(13).all(|(a, b)| (a.coords - b.coords).norm() < 1e-5));
    }
    settings.controls.strength = 1.0;
    let mut joints = [1.0; MAX_JOINTS];
    (joints[7], joints[0]) = (0.0, 0.0);
    settings.controls.mask = rig.coordinate_weights(&joints);
    let styled = play(&pack, &rig, &clip, &settings);
    let spine = |poses: &[Pose<MAX_JOINTS>]| poses.iter().map(|p| p.rotations[7].coords).collect::<Vec<_>>();
    assert!(spine(&styled).iter().zip(spine(&source)).all(|(a, b)| (a - b).norm() < 1e-6));
    assert!(styled.iter().zip(&source).all(|(a, b)| (a.root - b.root).norm() < 1e-6));
    settings.controls.mask = Settings::default().controls.mask;
    let styled = rig.locals(&play(&pack, &rig, &clip, &settings)).positions;
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
    let played = play_stored(&file.pack().expect("loads"), &rig, &settings);
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
    let (mut state, mut frame) = (ComponentsState::new(), Frame::new());
    let places: Vec<_> = (0..151)
        .map(|_| {
            components.step_stored(&mut state, &mut frame);
            frame.ground
        })
        .collect();
    let [[a, b], [c, d]] = [places[149], places[150]];
    assert!((c - a).hypot(d - b) < 0.1 && a.hypot(b) > 1.0, "{a} {b}, {c} {d}");
}

#[test]
fn heads_and_hands_are_styled() {
    let rig = rig();
    let (content, style) = (rig.poses(&walk(&rig, 150, 1.0, 0.1)), rig.poses(&walk(&rig, 130, 1.8, 0.6)));
    let played = play_stored(&pack(&rig).pack().expect("loads"), &rig, &Settings::default());
    let mean = |poses: &[Pose<MAX_JOINTS>], joint: usize| {
        let sum = poses.iter().map(|pose| pose.rotations[joint].coords).sum::<Vector4<f32>>();
        UnitQuaternion::new_normalize(sum.into())
    };
    for joint in [8, 10, 12] {
        let wanted = mean(&style, joint);
        let [before, after] = [&content, &played].map(|poses| mean(poses, joint).angle_to(&wanted).to_degrees());
        assert!(before > 5.0 && after < 0.2 * before, "joint {joint}: {before} before, {after} after");
    }
    let trained = trained(&rig);
    let (before, after) = (&trained.degrees_before, &trained.degrees_after);
    assert!(after.leaves < 0.6 * before.leaves && after.all < 0.8 * before.all, "{before:?} {after:?}");
}

#[test]
fn bones_keep_their_length_and_the_content_its_path() {
    let rig = rig();
    let file = pack(&rig);
    let pack = file.pack().expect("loads");
    let clip = walk(&rig, 90, 1.1, 0.2);
    let source = rig.poses(&clip);
    for strength in [0.5, 1.0, 2.0] {
        let mut settings = Settings::default();
        settings.controls.strength = strength;
        let live = play(&pack, &rig, &clip, &settings);
        for (styled, source) in live.iter().zip(&source) {
            // Travel has no component: only the height is styled.
            assert!((styled.root - source.root).xz().norm() < 1e-5);
        }
        for played in [live, play_stored(&pack, &rig, &settings)] {
            let positions = rig.locals(&played).positions;
            for (joint, frame) in positions.chunks_exact(39).flat_map(|frame| (1..13).map(move |j| (j, frame))) {
                let bone = &rig.skeleton.joints[joint];
                let at = |joint: usize| Vector3::from_column_slice(&frame[3 * joint..3 * joint + 3]);
                let length = (at(joint) - at(bone.parent.expect("a bone"))).norm();
                assert!((length / bone.offset.norm() - 1.0).abs() < 1e-3, "joint {joint}: {length}");
            }
        }
    }
}

#[test]
fn capacities_shapes_and_damage_are_refused() {
    let rig = rig();
    let file = pack(&rig);
    let pack = file.pack().expect("loads");
    // The root's row, and one for each joint but the feet, which never move.
    let rows = Components::<11, 12>::load(&pack).map(|_| ());
    assert_eq!(rows, Err(LoadError::Capacity { parameter: "ROWS", found: 12, capacity: 11 }));
    let count = Components::<12, 11>::load(&pack).map(|_| ());
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
fn a_live_step_survives_any_frame() {
    let rig = rig();
    let file = pack(&rig);
    let pack = file.pack().expect("loads");
    let components = Components::<16, 16>::load(&pack).expect("fits");
    let mut state = ComponentsState::new();
    for scale in [0.0, 1.0, 1e5, 1e6, f32::INFINITY, f32::NAN] {
        let mut frame = Frame::<16>::new();
        (frame.rows[0][1], frame.rows[3][0]) = (scale, -scale);
        let sound = frame.is_sound();
        components.step(&mut state, &mut frame);
        assert_eq!(frame.is_sound(), sound, "{scale}");
    }
    state.reset();
    assert_eq!(state, ComponentsState::new());
}

#[test]
fn the_report_agrees_with_the_training() {
    let rig = rig();
    let trained = trained(&rig);
    let metric = |name: &str, value| kinesic_host::pack::Metric { name: name.to_owned(), value };
    let recorded = RECORDED.map(|name| metric(name, trained.style_distance));
    let file = PackFile::from_bytes(&trained.model.pack(&rig, &Provenance::default()));
    let report = evaluate(&file.pack().expect("loads"), &rig, &recorded).expect("evaluates");
    assert!((report.content_distance - trained.content_distance).abs() < 1e-5);
    assert!((report.density - trained.content.factors.density()).abs() < 1e-9);
    assert!(report.change.cm > 1.0 && report.change.degrees.leaves > 1.0, "{report:?}");
    assert!(evaluate(&file.pack().expect("loads"), &rig, &[]).is_err());
}
