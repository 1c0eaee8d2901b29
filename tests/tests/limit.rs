//! The limiter's promise: position, velocity and acceleration within the bounds after any input.

#[path = "common/robot.rs"]
mod robot;

use kinesic::Pose;
use kinesic::limit::{Fault, LimitState, Limiter};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use proptest::prelude::*;
use robot::{JOINTS, Watch, limits};

const STEPS: usize = 1000;

/// Numbers as they come from a broken wire: any bits, and rotations, small and large.
fn number() -> impl Strategy<Value = f32> {
    prop_oneof![3 => -1.5f32..1.5, 1 => -1e7f32..1e7, 1 => any::<u32>().prop_map(f32::from_bits)]
}

/// Parts of which a sequence is made, chosen by one number a frame so that shrinking stays possible.
#[derive(Clone, Debug)]
struct Source {
    seed: u64,
    numbers: Vec<f32>,
    kinds: Vec<u8>,
}

fn source() -> impl Strategy<Value = Source> {
    let kinds = proptest::collection::vec(0u8..8, 24);
    (any::<u64>(), proptest::collection::vec(number(), 64), kinds).prop_map(|(seed, numbers, kinds)| Source {
        seed,
        numbers,
        kinds,
    })
}

struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        self.0 >> 33
    }

    fn unit(&mut self) -> f32 {
        (self.next() % 20_001) as f32 * 1e-4 - 1.0
    }
}

fn frame(source: &Source, random: &mut Random, at: usize) -> Option<Pose<JOINTS>> {
    let mut pose = Pose::identity();
    let smooth = at as f32 * 0.11;
    // Every kind lasts for some frames.
    match source.kinds[at / 7 % source.kinds.len()] {
        0 => return None,
        1 => {
            // Any bits at all.
            for q in &mut pose.rotations {
                let mut part = || source.numbers[random.next() as usize % source.numbers.len()];
                *q = UnitQuaternion::new_unchecked(Quaternion::new(part(), part(), part(), part()));
            }
            pose.root = Vector3::repeat(source.numbers[at % source.numbers.len()]);
        }
        2 | 3 => {
            // Another rotation each frame.
            for q in &mut pose.rotations {
                let part = Quaternion::new(random.unit(), random.unit(), random.unit(), random.unit() + 1e-3);
                *q = UnitQuaternion::new_normalize(part);
            }
            pose.root = Vector3::new(random.unit(), random.unit(), random.unit()) * 3.0;
        }
        4 => {
            // From one end to the other.
            let turn = if (at / 5).is_multiple_of(2) { 3.0 } else { -3.0 };
            for (joint, q) in pose.rotations.iter_mut().enumerate() {
                let axis = [Vector3::x(), Vector3::y(), Vector3::z()][joint % 3];
                *q = UnitQuaternion::from_scaled_axis(axis * turn);
            }
        }
        kind => {
            // Smooth, slow or fast.
            let speed = if kind == 5 { 0.3 } else { 2.5 };
            for (joint, q) in pose.rotations.iter_mut().enumerate() {
                let phase = source.numbers[joint].clamp(-3.0, 3.0);
                let turn = (smooth * speed + phase).sin();
                *q = UnitQuaternion::from_scaled_axis(Vector3::new(turn, 0.5 * turn, -0.7 * turn));
            }
            pose.root = Vector3::new(smooth.sin(), 1.0, smooth.cos());
        }
    }
    Some(pose)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    /// A thousand steps of any input, two hundred times.
    #[test]
    fn the_bounds_hold_after_any_sequence(source in source()) {
        let tables = limits().tables();
        let limiter = Limiter::<JOINTS>::new(tables.view(), limits().meta, 60.0).unwrap();
        let (mut state, mut out) = (LimitState::new(), Pose::identity());
        limiter.start(&mut state, &out);
        let mut watch = Watch::new(&limiter, &state);
        let mut random = Random(source.seed);
        for at in 0..STEPS {
            let input = frame(&source, &mut random, at);
            limiter.step(&mut state, input.as_ref(), &mut out);
            watch.check(&limiter, &state, &out, &format!("step {at}"));
        }
        // The same bits again.
        let mut again = LimitState::new();
        limiter.start(&mut again, &Pose::identity());
        let mut random = Random(source.seed);
        for at in 0..STEPS {
            limiter.step(&mut again, frame(&source, &mut random, at).as_ref(), &mut out);
        }
        prop_assert_eq!(again, state);
    }
}

#[test]
fn motion_within_the_limits_passes_to_rounding() {
    let mut model = limits();
    model.meta.frozen = 0.0;
    let tables = model.tables();
    let limiter = Limiter::<JOINTS>::new(tables.view(), model.meta, 60.0).unwrap();
    let mut state = LimitState::new();
    let mut out = Pose::identity();
    for at in 0..600 {
        let turn = 0.15 * (at as f32 * 0.05).sin();
        let mut pose = Pose::<JOINTS>::identity();
        pose.root = Vector3::new(0.3 * (at as f32 * 0.03).sin(), 1.0, 0.01 * at as f32);
        for (joint, q) in pose.rotations.iter_mut().enumerate() {
            // Hinges turn about X alone, and one not at zero.
            let axis = Vector3::x() * if matches!(joint, 14 | 17) { -1.0 } else { 1.0 };
            *q = UnitQuaternion::from_scaled_axis(
                axis * (turn + if matches!(joint, 2 | 6 | 14 | 17) { 0.2 } else { 0.0 }),
            );
        }
        pose.rotations[13] =
            UnitQuaternion::from_scaled_axis(Vector3::z() * core::f32::consts::FRAC_PI_4) * pose.rotations[13];
        limiter.step(&mut state, Some(&pose), &mut out);
        if at > 60 {
            assert!((out.root - pose.root).norm() < 2e-6, "{at}");
            for (joint, (a, b)) in out.rotations.iter().zip(&pose.rotations).enumerate() {
                assert!(a.coords.dot(&b.coords).abs() > 1.0 - 1e-6, "frame {at} joint {joint}: {a} {b}");
            }
            assert_eq!(state.report().clamped, Default::default(), "{at}");
        }
    }
    assert!(state.report().clamped_frames < 60);
}

#[test]
fn a_gap_is_held_then_decays_to_rest_and_ends() {
    let model = limits();
    let tables = model.tables();
    let limiter = Limiter::<JOINTS>::new(tables.view(), model.meta, 60.0).unwrap();
    let (mut state, mut out) = (LimitState::new(), Pose::identity());
    let mut pose = Pose::<JOINTS>::identity();
    pose.rotations[2] = UnitQuaternion::from_scaled_axis(Vector3::x() * 1.5);
    // Two poses by turns, so that they do not count as frozen.
    for at in 0..80 {
        pose.root.x = if at % 2 == 0 { 0.0 } else { 1e-7 };
        limiter.step(&mut state, Some(&pose), &mut out);
    }
    assert!((state.angles(2)[0] - 1.5).abs() < 1e-4);
    for _ in 0..30 {
        limiter.step(&mut state, None, &mut out);
    }
    assert!((state.angles(2)[0] - 1.5).abs() < 1e-4, "held for half a second: {:?}", state.angles(2));
    assert_eq!((state.report().fault, state.report().gap), (Some(Fault::Missing), 30));
    for _ in 0..600 {
        limiter.step(&mut state, None, &mut out);
    }
    assert!(state.angles(2)[0].abs() < 1e-3, "at rest after ten seconds: {:?}", state.angles(2));
    for at in 0..limiter.recovery_frames() {
        pose.root.x = if at % 2 == 0 { 0.0 } else { 1e-7 };
        limiter.step(&mut state, Some(&pose), &mut out);
    }
    assert_eq!((state.report().fault, state.report().gap), (None, 0));
    assert!((state.angles(2)[0] - 1.5).abs() < 1e-4);
}

#[test]
fn a_changed_table_does_not_jump() {
    let model = limits();
    let mut narrow = model.clone();
    narrow.joints[2].upper[0] = 2.0;
    let (wide, narrow) = (model.tables(), narrow.tables());
    let wide = Limiter::<JOINTS>::new(wide.view(), model.meta, 60.0).unwrap();
    let narrow = Limiter::<JOINTS>::new(narrow.view(), model.meta, 60.0).unwrap();
    let (mut state, mut out) = (LimitState::new(), Pose::identity());
    wide.start(&mut state, &out);
    let mut watch = Watch::new(&wide, &state);
    let mut pose = Pose::<JOINTS>::identity();
    for at in 0..400 {
        pose.rotations[2] = UnitQuaternion::from_scaled_axis(Vector3::x() * (1.0 + 0.7 * (at as f32 * 0.1).sin()));
        let limiter = if at / 50 % 2 == 0 { &wide } else { &narrow };
        limiter.step(&mut state, Some(&pose), &mut out);
        watch.check(&wide, &state, &out, &format!("step {at}"));
    }
}
