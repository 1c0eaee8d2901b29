//! What the device's code promises: strength, mask, the host's simulation, no allocation.

mod common;

use common::{neutral, rig};
use kinesic::pose::{World, forward};
use kinesic::{Emotion, EmotionState, Frame, Pipeline, PipelineState, Pose, Translator, TranslatorState};
use kinesic_host::emotion::synthetic;
use kinesic_host::pack::{PackFile, Provenance};
use kinesic_host::rig::MAX_ROWS;
use kinesic_host::translate::FormChoice;

const FORMS: [FormChoice; 2] = [FormChoice::WholeBody, FormChoice::PerJoint];

type Device<'a> = Pipeline<'a, Translator<'a, MAX_ROWS, 1024>, MAX_ROWS>;
type State = PipelineState<TranslatorState<MAX_ROWS, 1024>, MAX_ROWS>;

fn angle(a: &nalgebra::UnitQuaternion<f32>, b: &nalgebra::UnitQuaternion<f32>) -> f64 {
    a.cast::<f64>().angle_to(&b.cast::<f64>())
}

#[test]
fn strength_zero_is_the_identity() {
    for form in FORMS {
        let file = common::pack(form, 24);
        let pack = file.pack().unwrap();
        let device = Device::load(&pack).unwrap();
        let mut state = State::new();
        state.engine.controls.strength = 0.0;
        let mut styled = Pose::identity();
        for pose in rig().poses(&neutral(4)) {
            device.step(&mut state, Some(&pose), &mut styled);
            assert_eq!(styled, pose, "{form:?}: bit for bit");
        }
    }
}

#[test]
fn a_mask_of_zero_leaves_a_joint_untouched() {
    for form in FORMS {
        let file = common::pack(form, 24);
        let pack = file.pack().unwrap();
        let device = Device::load(&pack).unwrap();
        let mut state = State::new();
        let untouched = [10, 13, 17];
        for joint in untouched {
            device.rig().weigh(joint, 0.0, &mut state.engine.controls.mask);
        }
        let mut styled = Pose::identity();
        let mut moved = 0.0f64;
        for pose in rig().poses(&neutral(4)) {
            device.step(&mut state, Some(&pose), &mut styled);
            for (joint, (a, b)) in styled.rotations.iter().zip(&pose.rotations).enumerate().take(19) {
                if untouched.contains(&joint) {
                    assert_eq!(a, b, "joint {joint}: bit for bit");
                } else {
                    moved = moved.max(angle(a, b));
                }
            }
        }
        assert!(moved > 0.2, "the rest is translated");
    }
}

#[test]
fn bones_keep_their_length_at_any_strength() {
    let file = common::pack(FormChoice::WholeBody, 24);
    let pack = file.pack().unwrap();
    let device = Device::load(&pack).unwrap();
    let rig = rig();
    for strength in [-1.0, 0.5, 1.0, 3.0] {
        let mut state = State::new();
        state.engine.controls.strength = strength;
        let (mut styled, mut world) = (Pose::identity(), World::identity());
        for pose in rig.poses(&neutral(4)) {
            device.step(&mut state, Some(&pose), &mut styled);
            forward(&rig.device(), &styled, &mut world);
            for (joint, bone) in rig.skeleton.joints.iter().enumerate().skip(1) {
                let length = (world.positions[joint] - world.positions[bone.parent.unwrap()]).norm();
                assert!((f64::from(length) - bone.offset.norm()).abs() < 1e-5);
            }
        }
    }
}

#[test]
fn a_step_allocates_nothing() {
    for form in FORMS {
        let file = common::pack(form, 24);
        let poses = rig().poses(&neutral(4));
        let mut styled = Pose::identity();
        let mut state = State::new();
        let info = allocation_counter::measure(|| {
            let pack = file.pack().unwrap();
            let device = Device::load(&pack).unwrap();
            for pose in &poses {
                device.step(&mut state, Some(pose), &mut styled);
            }
        });
        assert_eq!(info.count_total, 0, "{form:?}: loading and stepping");
    }
}

#[test]
fn an_emotion_allocates_nothing() {
    let (model, rig) = synthetic::model(2);
    let file = PackFile::from_bytes(&model.pack(&rig, &Provenance::default()));
    let (mut state, mut frame) = (EmotionState::<20, 13>::new(), Frame::new());
    let info = allocation_counter::measure(|| {
        let pack = file.pack().unwrap();
        let emotion = Emotion::<20, 13, 40>::load(&pack).unwrap();
        for at in 0..300 {
            state.strength = [(at / 50 % 2) as f32, 0.5, 0.0, 0.0];
            emotion.step(&mut state, 1.0 / 60.0, &mut frame);
        }
        emotion.restart(&mut state);
    });
    assert_eq!(info.count_total, 0, "loading, changing and stepping");
    assert!(frame.is_sound());
}

#[test]
fn a_held_pose_stays_still_after_start() {
    let file = common::pack(FormChoice::WholeBody, 24);
    let pack = file.pack().unwrap();
    let device = Device::load(&pack).unwrap();
    let pose = rig().poses(&neutral(4))[7];
    let mut state = State::new();
    device.start(&mut state, &pose);
    let (mut first, mut styled) = (Pose::identity(), Pose::identity());
    device.step(&mut state, Some(&pose), &mut first);
    for _ in 0..600 {
        device.step(&mut state, Some(&pose), &mut styled);
    }
    for (a, b) in styled.rotations.iter().zip(&first.rotations).take(19) {
        assert!(angle(a, b) < 1e-4, "{a} {b}");
    }
}
