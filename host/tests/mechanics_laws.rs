//! Laws of decoupling and modulation on made poses, and features against an independent computation of the whole clip.

mod mechanics_common;
mod real;

use kinesic::Pose;
use kinesic::mechanics::{
    Blend, Body, Decoupled, Decoupler, DynamicFeatures, FEATURES, FeatureState, Modulation, Window, feature, mix,
    modulate,
};
use kinesic_host::clip::{Canonical, Clip};
use kinesic_host::mechanics::{Rows, body, measured, signs};
use kinesic_host::rig::{MAX_JOINTS, Rig};
use mechanics_common::on_rig;
use nalgebra::{UnitQuaternion, Vector3};
use proptest::prelude::*;

const JOINTS: usize = 12;

fn pose() -> impl Strategy<Value = Pose<JOINTS>> {
    let turn = prop::array::uniform3(-3.0f32..3.0);
    (prop::collection::vec(turn, JOINTS), prop::array::uniform3(-2.0f32..2.0)).prop_map(|(turns, root)| {
        let mut pose = Pose { root: Vector3::from(root), ..Pose::identity() };
        for (rotation, turn) in pose.rotations.iter_mut().zip(turns) {
            *rotation = UnitQuaternion::from_scaled_axis(Vector3::from(turn));
        }
        pose
    })
}

/// Largest difference of a quaternion's component, whatever the sign.
fn distance(a: &Pose<JOINTS>, b: &Pose<JOINTS>) -> f32 {
    let pairs = a.rotations.iter().zip(&b.rotations);
    pairs.map(|(a, b)| (a.coords - b.coords).amax().min((a.coords + b.coords).amax())).fold(0.0, f32::max)
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn the_product_is_the_observed_pose(observed in pose(), mechanics in pose()) {
        let mut parts = Decoupled::identity();
        Decoupler::default().split(&observed, &mechanics, &mut parts);
        prop_assert!(distance(&parts.observed(), &observed) <= 1e-5);
        prop_assert!(parts.activity.iter().all(|a| (0.0..=1.0).contains(a)));
        prop_assert_eq!(parts.mechanics.root, observed.root);
        prop_assert_eq!(parts.mechanics.rotations[0], observed.rotations[0]);
    }

    #[test]
    fn modulation_has_its_fixed_points(observed in pose(), mechanics in pose()) {
        let mut parts = Decoupled::identity();
        Decoupler::default().split(&observed, &mechanics, &mut parts);
        let mut out = Pose::identity();
        let mut at = |amount: f32, weight: f32| {
            modulate(&observed, &parts, &Modulation { amount, mask: [weight; JOINTS] }, &mut out);
            out
        };
        prop_assert_eq!(at(1.0, 1.0), observed);
        prop_assert_eq!(at(f32::NAN, 1.0), observed);
        prop_assert_eq!(at(5.0, 0.0), observed);
        prop_assert!(distance(&at(0.0, 1.0), &parts.mechanics) <= 1e-5);
        // Twice the rotation vector.
        let twice = at(2.0, 1.0);
        for ((out, kept), e) in twice.rotations.iter().zip(&parts.mechanics.rotations).zip(&parts.expressive).skip(1) {
            let expected = UnitQuaternion::from_scaled_axis(2.0 * e.scaled_axis()) * kept;
            prop_assert!(out.angle_to(&expected) < 2e-3);
        }
    }

    #[test]
    fn mixing_with_oneself_is_the_pose_and_blending_starts_and_ends_on_one(a in pose(), b in pose(), m in pose()) {
        let (mut first, mut second, mut out) = (Decoupled::identity(), Decoupled::identity(), Pose::identity());
        Decoupler::default().split(&a, &m, &mut first);
        Decoupler::default().split(&b, &m, &mut second);
        mix(&first, &first, &Modulation::default(), &mut out);
        prop_assert!(distance(&out, &a) <= 1e-5);
        // Where the weight is 0 the first motion is left alone.
        mix(&first, &second, &Modulation { amount: 1.0, mask: [0.0; JOINTS] }, &mut out);
        prop_assert!(distance(&out, &a) <= 1e-5);
        let blend = Blend { mechanics: Window { start: 1.0, end: 2.0 }, expressive: Window { start: 3.0, end: 5.0 } };
        blend.step(0.5, &first, &second, &mut out);
        prop_assert!(distance(&out, &a) <= 1e-5);
        blend.step(5.0, &first, &second, &mut out);
        prop_assert!(distance(&out, &b) <= 1e-5);
        // Between the windows: the second's mechanics, the first's expression.
        blend.step(2.5, &first, &second, &mut out);
        let mut mixed = Pose::identity();
        mix(&second, &first, &Modulation::default(), &mut mixed);
        prop_assert!(distance(&out, &mixed) <= 1e-5);
    }
}

#[test]
fn activity_is_the_formula() {
    let decoupler = Decoupler::default();
    for degrees in 0..180 {
        let turn = f64::from(degrees).to_radians();
        let exact = (turn.tanh() * 2.0).powi(4).clamp(0.0, 1.0);
        assert!((f64::from(decoupler.activity(turn as f32)) - exact).abs() < 1e-4, "{degrees}");
    }
}

#[test]
fn a_cut_is_a_window_without_length() {
    let cut = Window { start: 2.0, end: 2.0 };
    assert_eq!([1.0, 2.0, 2.5].map(|t| cut.weight(t)), [0.0, 1.0, 1.0]);
    assert!(Window { start: 0.0, end: 1.0 }.weight(f32::NAN).is_finite());
}

const CLIPS: [&str; 4] = ["cmu31/07_01.bvh", "cmu31/35_19.bvh", "cmu31/cmuc_jumping_118_481.bvh", "cmu31/05_06.bvh"];

/// Features of all frames in f64 from world positions, the whole clip at once; contacts are given.
fn whole_clip(rig: &Rig, body: &Body, clip: &Clip, frame: usize, heading: &mut f64) -> Vec<f64> {
    let at = clip.positions(frame);
    let hips = [Canonical::LHip, Canonical::RHip].map(|c| at[rig.map.joint(c).unwrap()]);
    let across = hips[0] - hips[1];
    if across.x.hypot(across.z) > 1e-3 {
        *heading = (-across.z).atan2(across.x);
    }
    let local = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), -*heading);
    let rate = clip.fps() / f64::from(body.height);
    let before = frame.saturating_sub(1);
    let velocity = local * (clip.root[frame] - clip.root[before]) * rate;
    let start = frame.saturating_sub((clip.fps() / 3.0).round() as usize);
    let span = (frame - start).max(1) as f64;
    let mean = local * (clip.root[frame] - clip.root[start]) * rate / span;
    let worlds = clip.skeleton.world_rotations(clip.pose(frame));
    let mut row = Vec::from(<[f64; 3]>::from(velocity));
    row.extend(<[f64; 3]>::from(mean));
    for joint in body.thighs {
        let matrix = (local * worlds[usize::from(joint)]).to_rotation_matrix();
        row.extend(matrix.matrix().column(0).iter().chain(matrix.matrix().column(1).iter()));
    }
    row
}

#[test]
fn streaming_equals_the_whole_clip() {
    let Some(folder) = real::data("mechanics_laws") else { return };
    let (rig, clips) = on_rig(&folder, &CLIPS);
    let body = measured(&body(&rig).unwrap(), &clips.iter().collect::<Vec<_>>());
    let signs = signs(&rig, &clips.iter().collect::<Vec<_>>());
    let mut worst = 0.0f64;
    for clip in &clips {
        let rows = Rows::of(&rig, &body, clip, &signs).unwrap();
        let (mut heading, mut since) = (0.0, [0.0; 2]);
        for (frame, row) in rows.features.chunks_exact(FEATURES).enumerate() {
            let expected = whole_clip(&rig, &body, clip, frame, &mut heading);
            let (moves, thighs) = (&row[..6], &row[feature::THIGHS..]);
            for (index, (found, expected)) in moves.iter().chain(thighs).zip(&expected).enumerate() {
                let error = (f64::from(*found) - expected).abs();
                worst = worst.max(error);
                // Velocities are differences of f32 positions, by 60 frames a second.
                assert!(error < 2e-4, "frame {frame}, feature {index}: {found} {expected}");
            }
            let [stands, air] = [feature::CONTACT, feature::AIR].map(|at| [row[at], row[at + 1]]);
            for ((stands, air), since) in stands.iter().zip(air).zip(&mut since) {
                *since = if *stands == 1.0 { 0.0 } else { *since + 1.0 / 60.0f64 };
                let expected = if frame == 0 { 0.0 } else { since.min(1.0) };
                *since = expected;
                assert!((f64::from(air) - expected).abs() < 1e-4, "frame {frame}: {air} {expected}");
            }
        }
    }
    println!("largest difference: {worst:.1e}");
}

/// On level ground the running ground estimate is the floor, found here from the whole clip at once.
#[test]
fn hip_height_is_that_over_the_floor() {
    let Some(folder) = real::data("hip_height_is_that_over_the_floor") else { return };
    let (rig, clips) = on_rig(&folder, &CLIPS[..1]);
    let clip = &clips[0];
    let body = measured(&body(&rig).unwrap(), &[clip]);
    let signs = signs(&rig, &[clip]);
    let rows = Rows::of(&rig, &body, clip, &signs).unwrap();
    let soles = body.feet.iter().zip(&body.clearance).flat_map(|(joints, clearance)| {
        let of = |(joint, clearance): (&u16, &f32)| {
            let (joint, clearance) = (usize::from(*joint), f64::from(*clearance));
            (0..clip.frames()).map(move |frame| clip.positions(frame)[joint].y - clearance)
        };
        joints.iter().zip(clearance).flat_map(of).collect::<Vec<_>>()
    });
    let mut soles: Vec<f64> = soles.collect();
    soles.sort_by(f64::total_cmp);
    let floor = soles[soles.len() / 20];
    let mut largest = 0.0f64;
    for (row, root) in rows.features.chunks_exact(FEATURES).zip(&clip.root) {
        let expected = (root.y - floor) / f64::from(body.hip_height);
        let found = f64::from(row[feature::HIP_HEIGHT]);
        largest = largest.max((found - expected).abs());
    }
    println!("largest difference of the hip height: {largest:.3} of standing straight");
    // .06 measured: between two contacts the estimate follows soles that rise and sink by some centimetres in the recording.
    assert!(largest < 0.08, "{largest}");
}

#[test]
fn dropped_and_broken_frames_leave_no_trace() {
    let Some(folder) = real::data("mechanics_laws") else { return };
    let (rig, clips) = on_rig(&folder, &CLIPS[..1]);
    let body = body(&rig).unwrap();
    let features = DynamicFeatures::new(rig.device(), &body, 60.0).unwrap();
    let poses = rig.poses(&clips[0]);
    let mut whole = FeatureState::<MAX_JOINTS, 20>::new();
    let mut broken = FeatureState::<MAX_JOINTS, 20>::new();
    let mut garbage = poses[0];
    garbage.rotations[5] = UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(f32::NAN, 0.0, 0.0, 0.0));
    let mut infinite = poses[0];
    infinite.root.y = f32::INFINITY;
    // Before the first sound frame too.
    features.step(&mut broken, &garbage);
    for (frame, pose) in poses.iter().enumerate() {
        features.step(&mut whole, pose);
        let lost = frame % 40 == 12 || frame % 40 == 13 || frame == 60;
        features.step(
            &mut broken,
            if !lost {
                pose
            } else if frame % 2 == 0 {
                &garbage
            } else {
                &infinite
            },
        );
        assert!(broken.features().iter().all(|x| x.is_finite()));
        assert_eq!(broken.gap() > 0, lost);
        let [a, b] = [whole.features(), broken.features()];
        if frame > 0 && frame % 40 == 39 {
            // More than a third of a second after the last loss.
            let differences = a.iter().zip(b).map(|(a, b)| (a - b).abs());
            assert!(differences.fold(0.0, f32::max) < 0.02, "frame {frame}: {a:?} {b:?}");
        }
        if !lost {
            // The velocity over a gap is the mean over it, not a jump.
            let speed = |f: &[f32; FEATURES]| Vector3::new(f[0], f[1], f[2]).norm();
            assert!(speed(b) < 1.5 * speed(a) + 0.2, "frame {frame}");
        }
    }
}
