//! The limiter's promise: position, velocity and acceleration within the bounds after any input.

#[path = "common/robot.rs"]
mod robot;

use kinesic::engine::Fault;
use kinesic::limit::{Clamped, LimitState, LimitTable, Limiter};
use kinesic::model::LimitsMeta;
use kinesic::rig::JointKind;
use kinesic::{Frame, Pipeline, PipelineState, Pose, Rig};
use kinesic_host::limit::Tables;
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use proptest::prelude::*;
use robot::{JOINTS, ROWS, Watch, first, limits, rig, tables};

type Limits<'a> = Pipeline<'a, Limiter<'a, ROWS>, ROWS>;
type State = PipelineState<LimitState<ROWS>, ROWS>;

fn pipeline(tables: &Tables) -> Limits<'_> {
    Limits::new(tables.rig().frames(), tables.limiter().unwrap()).unwrap()
}

const STEPS: usize = 1000;

/// Numbers as they come from a broken wire: any bits, and rotations, small and large.
fn number() -> impl Strategy<Value = f32> {
    prop_oneof![3 => -1.5f32..1.5, 1 => -1e7f32..1e7, 1 => any::<u32>().prop_map(f32::from_bits)]
}

/// Parts of which a sequence is made, chosen by one number per frame so that shrinking stays possible.
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
        let tables = tables();
        let limits = pipeline(&tables);
        let (mut state, mut out) = (State::new(), Pose::identity());
        limits.start(&mut state, &Pose::<JOINTS>::identity());
        let mut watch = Watch::new(&shown(&limits, &state));
        let mut random = Random(source.seed);
        for at in 0..STEPS {
            let input = frame(&source, &mut random, at);
            limits.step(&mut state, input.as_ref(), &mut out);
            watch.check(&limits.engine, state.shown(), &format!("step {at}"));
            watch.check_pose(&out, state.source(), &format!("step {at}"));
        }
        // The same bits again.
        let mut again = State::new();
        limits.start(&mut again, &Pose::<JOINTS>::identity());
        let mut random = Random(source.seed);
        for at in 0..STEPS {
            limits.step(&mut again, frame(&source, &mut random, at).as_ref(), &mut out);
        }
        prop_assert_eq!(again.engine, state.engine);
        prop_assert_eq!(again.shown(), state.shown());
    }

    /// The same of servos and a slider, coordinates in and out.
    #[test]
    fn servos_stay_within_their_bounds_after_any_sequence(source in source()) {
        let servos = Servos::new();
        let limits = servos.pipeline();
        let (mut state, mut out) = (State::new(), [0.0; 5]);
        let mut start = Frame::new();
        start.rows[0] = SERVO_TABLE.rest[0];
        start.rows[1] = SERVO_TABLE.rest[1];
        let mut watch = Watch::new(&start);
        let mut random = Random(source.seed);
        for at in 0..STEPS {
            let smooth = (at as f32 * 0.07).sin();
            let mut part = |kind| match kind {
                1 => source.numbers[random.next() as usize % source.numbers.len()],
                2 | 3 => 3.0 * random.unit(),
                4 => if (at / 5).is_multiple_of(2) { 3.0 } else { -3.0 },
                _ => smooth,
            };
            let kind = source.kinds[at / 7 % source.kinds.len()];
            let input = [0; 5].map(|_| part(kind));
            limits.step_coordinates(&mut state, (kind > 0).then_some(&input), &mut out);
            watch.check(&limits.engine, state.shown(), &format!("step {at}"));
            prop_assert_eq!(&out[..], &state.shown().coordinates()[..5]);
        }
    }
}

/// Where a state that has just been started shows the robot: where it was put, within the bounds.
fn shown(limits: &Limits<'_>, state: &State) -> Frame<ROWS> {
    let mut frame = *state.shown();
    for (index, x) in frame.coordinates_mut().iter_mut().enumerate() {
        *x = state.engine.coordinate(index).unwrap();
    }
    assert_eq!(limits.rig().joints(), JOINTS);
    frame
}

static SERVO_TABLE: LimitTable<'static> = LimitTable {
    lower: &[[-1.5, 0.0, 0.2], [-0.5, -1.0, 0.0]],
    upper: &[[1.5, 0.3, 2.2], [0.5, -0.2, 0.0]],
    velocity: &[[4.0, 0.5, 9.0], [2.0, 3.0, 0.0]],
    acceleration: &[[30.0, 4.0, 90.0], [300.0, 20.0, 0.0]],
    jerk: &[],
    rest: &[[0.0, 0.1, 0.2], [0.0, -0.2, 0.0]],
};

/// A machine that stands: four servos and a slider in two rows.
struct Servos {
    kinds: [u16; 5],
    axes: [[[f32; 3]; 3]; 5],
    reference: [[f32; 4]; 5],
    middle: [[f32; 3]; 5],
}

impl Servos {
    fn new() -> Self {
        use JointKind::{Hinge, Slider};
        Self {
            kinds: [Hinge, Slider, Hinge, Hinge, Hinge].map(|kind| kind as u16),
            axes: [[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]; 5],
            reference: [[0.0, 0.0, 0.0, 1.0]; 5],
            middle: [[0.0; 3]; 5],
        }
    }

    fn pipeline(&self) -> Limits<'_> {
        let rig = Rig::new(&self.kinds, &self.axes, &self.reference, &self.middle, None).unwrap();
        Limits::new(rig, Limiter::new(rig, SERVO_TABLE, LimitsMeta::default(), 60.0).unwrap()).unwrap()
    }
}

#[test]
fn motion_within_the_limits_passes_to_rounding() {
    let tables = tables();
    let limits = pipeline(&tables);
    let (mut state, mut out) = (State::new(), Pose::identity());
    for at in 0..600 {
        let turn = 0.15 * (at as f32 * 0.05).sin();
        let heading = UnitQuaternion::from_scaled_axis(Vector3::y() * (0.4 * (at as f32 * 0.02).sin()));
        let mut pose = Pose::<JOINTS>::identity();
        let height = limits.engine.table().rest[0][1] + 0.05 * (at as f32 * 0.1).sin();
        pose.root = Vector3::new(0.3 * (at as f32 * 0.03).sin(), height, 0.01 * at as f32);
        for (joint, q) in pose.rotations.iter_mut().enumerate() {
            // Hinges turn about X alone, and one not at zero.
            let axis = Vector3::x() * if matches!(joint, 14 | 17) { -1.0 } else { 1.0 };
            *q = UnitQuaternion::from_scaled_axis(
                axis * (turn + if matches!(joint, 2 | 6 | 14 | 17) { 0.2 } else { 0.0 }),
            );
        }
        pose.rotations[0] = heading * pose.rotations[0];
        pose.rotations[13] =
            UnitQuaternion::from_scaled_axis(Vector3::z() * core::f32::consts::FRAC_PI_4) * pose.rotations[13];
        limits.step(&mut state, Some(&pose), &mut out);
        if at > 60 {
            assert!((out.root - pose.root).norm() < 1e-5, "{at}: {} {}", out.root, pose.root);
            for (joint, (a, b)) in out.rotations.iter().zip(&pose.rotations).enumerate() {
                assert!(a.coords.dot(&b.coords).abs() > 1.0 - 1e-6, "frame {at} joint {joint}: {a} {b}");
            }
            let report = state.engine.report();
            assert_eq!((report.position, report.rate), (0, 0), "{at}");
        }
    }
    assert!(state.engine.report().clamped_frames < 60);
}

#[test]
fn a_gap_is_held_then_decays_to_rest_and_ends() {
    let tables = tables();
    let limits = pipeline(&tables);
    let knee = first(&limits.engine, 2);
    let (mut state, mut out) = (State::new(), Pose::identity());
    let mut pose = Pose::<JOINTS>::identity();
    pose.rotations[2] = UnitQuaternion::from_scaled_axis(Vector3::x() * 1.5);
    let angle = |state: &State| state.shown().coordinates()[knee];
    // Holding still is no fault.
    for _ in 0..200 {
        limits.step(&mut state, Some(&pose), &mut out);
    }
    assert!((angle(&state) - 1.5).abs() < 1e-4);
    assert_eq!((state.report().fault, state.report().faulty), (None, 0));
    let mut garbled = pose;
    garbled.rotations[5] = UnitQuaternion::new_unchecked(Quaternion::new(f32::NAN, 0.0, 0.0, 0.0));
    for at in 0..30 {
        limits.step(&mut state, if at % 2 == 0 { Some(&garbled) } else { None }, &mut out);
    }
    assert!((angle(&state) - 1.5).abs() < 1e-4, "held for half a second: {}", angle(&state));
    assert_eq!((state.report().fault, state.report().gap, state.engine.report().gap), (Some(Fault::Missing), 30, 30));
    for _ in 0..600 {
        limits.step(&mut state, None::<&Pose<JOINTS>>, &mut out);
    }
    assert!(angle(&state).abs() < 1e-3, "at rest after ten seconds: {}", angle(&state));
    assert!(out.rotations[2].angle() < 1e-3 && (out.root.y - limits.engine.table().rest[0][1]).abs() < 1e-3);
    for _ in 0..limits.engine.recovery_frames() {
        limits.step(&mut state, Some(&pose), &mut out);
    }
    assert_eq!((state.report().fault, state.report().gap, state.engine.report().gap), (None, 0, 0));
    assert!((angle(&state) - 1.5).abs() < 1e-4);
    // A source that cannot hold still is frozen when it does; the robot goes to rest.
    state.guard.frozen = 10;
    for _ in 0..700 {
        limits.step(&mut state, Some(&pose), &mut out);
    }
    assert_eq!(state.report().fault, Some(Fault::Frozen));
    assert!(angle(&state).abs() < 1e-3, "{}", angle(&state));
}

#[test]
fn a_recovery_ends_in_time_from_anywhere() {
    let tables = tables();
    let limits = pipeline(&tables);
    let frames = limits.engine.recovery_frames();
    let turned = |turn: f32| {
        let mut pose = Pose::<JOINTS>::identity();
        pose.root.y = if turn > 0.0 { 1.5 } else { 0.1 };
        pose.rotations.iter_mut().skip(1).for_each(|q| *q = UnitQuaternion::from_scaled_axis(Vector3::x() * turn));
        pose
    };
    for turned_for in [3, 11, 40, 200] {
        let (mut state, mut out) = (State::new(), Pose::identity());
        for at in 0..turned_for {
            limits.step(&mut state, Some(&turned(if at % 60 < 50 { 3.0 } else { -3.0 })), &mut out);
        }
        limits.step(&mut state, None::<&Pose<JOINTS>>, &mut out);
        for _ in 0..frames {
            limits.step(&mut state, Some(&turned(-0.3)), &mut out);
        }
        // Every limited coordinate is where the source's is, as far as its bounds allow.
        let table = limits.engine.table();
        let bounds = table.lower.as_flattened().iter().zip(table.upper.as_flattened());
        for (index, ((lower, upper), velocity)) in bounds.zip(table.velocity.as_flattened()).enumerate() {
            if *velocity > 0.0 {
                let wanted = state.source().coordinates()[index].max(*lower).min(*upper);
                let found = state.engine.coordinate(index).unwrap();
                assert!((found - wanted).abs() < 1e-4, "coordinate {index}: {found}, {wanted}");
            }
        }
    }
}

#[test]
fn a_leap_is_bridged_at_the_roots_rates() {
    let tables = tables();
    let limits = pipeline(&tables);
    // The frame after the leap is missing, or the frame of the leap is; or nothing is.
    for missing in [None, Some(60), Some(61)] {
        let (mut state, mut out) = (State::new(), Pose::identity());
        let mut pose = Pose::<JOINTS>::identity();
        pose.root.y = limits.engine.table().rest[0][1];
        limits.start(&mut state, &pose);
        let mut watch = Watch::new(state.shown());
        let mut arrived = None;
        for at in 0..400 {
            pose.root.x = 0.01 * at as f32;
            pose.root.z = if at < 60 { 0.0 } else { -7.0 };
            limits.step(&mut state, Some(&pose).filter(|_| missing != Some(at)), &mut out);
            watch.check(&limits.engine, state.shown(), &format!("step {at}"));
            watch.check_pose(&out, state.source(), &format!("step {at}"));
            assert_eq!(state.shown().leap, [0.0; 2], "nothing leaps that goes out");
            if at >= 60 && arrived.is_none() && (out.root - pose.root).norm() < 1e-4 {
                arrived = Some(at);
            }
        }
        // 7 m at 5 m/s are 84 frames.
        assert!(arrived.is_some_and(|at| (60 + 84..60 + 130).contains(&at)), "{missing:?}: {arrived:?}");
        assert!((out.root - pose.root).norm() < 1e-4, "{missing:?}: {} {}", out.root, pose.root);
    }
}

#[test]
fn an_about_turn_is_made_at_the_headings_rates() {
    let tables = tables();
    let limits = pipeline(&tables);
    let (mut state, mut out) = (State::new(), Pose::identity());
    let mut pose = Pose::<JOINTS>::identity();
    pose.root.y = limits.engine.table().rest[0][1];
    limits.start(&mut state, &pose);
    let mut watch = Watch::new(state.shown());
    let (mut most, mut arrived) = (0.0f32, None);
    for at in 0..200 {
        // It walks on in the direction in which it faces, and turns about.
        let back = at >= 30;
        pose.rotations[0] = UnitQuaternion::from_scaled_axis(Vector3::y() * if back { 3.0 } else { 0.0 });
        pose.root += pose.rotations[0] * Vector3::z() * 0.02;
        let before = out.rotations[0];
        limits.step(&mut state, Some(&pose), &mut out);
        watch.check(&limits.engine, state.shown(), &format!("step {at}"));
        watch.check_pose(&out, state.source(), &format!("step {at}"));
        if at > 0 {
            most = most.max(before.angle_to(&out.rotations[0]));
        }
        if back && arrived.is_none() && out.rotations[0].angle_to(&pose.rotations[0]) < 1e-3 {
            arrived = Some(at);
        }
    }
    // 3 rad at 10 rad/s are 18 frames.
    assert!((0.1..0.167).contains(&most), "{most} rad in a frame");
    assert!(arrived.is_some_and(|at| (48..75).contains(&at)), "{arrived:?}");
    assert!((out.root - pose.root).norm() < 1e-4);
}

#[test]
fn what_is_clamped_is_named() {
    let servos = Servos::new();
    let limits = servos.pipeline();
    let (mut state, mut out) = (State::new(), [0.0; 5]);
    let at_rest = [0.0, 0.1, 0.2, 0.0, -0.2];
    limits.step_coordinates(&mut state, Some(&at_rest), &mut out);
    assert!((0..6).all(|index| state.engine.clamped(index) == Some(Clamped::default())));
    // The third servo is told to go beyond its bound at once, the fourth to a place within.
    let told = [0.0, 0.1, 5.0, 0.4, -0.2];
    limits.step_coordinates(&mut state, Some(&told), &mut out);
    let clamped = |position, rate| Some(Clamped { position, rate });
    let found: Vec<_> = (0..5).map(|index| state.engine.clamped(index)).collect();
    assert_eq!(
        found,
        [
            clamped(false, false),
            clamped(false, false),
            clamped(true, true),
            clamped(false, true),
            clamped(false, false)
        ]
    );
    assert_eq!((state.engine.report().position, state.engine.report().rate), (1, 2));
    for _ in 0..limits.engine.recovery_frames() {
        limits.step_coordinates(&mut state, Some(&told), &mut out);
    }
    assert_eq!(out, [0.0, 0.1, 2.2, 0.4, -0.2]);
    assert_eq!((state.engine.clamped(2), state.engine.clamped(3)), (clamped(true, false), clamped(false, false)));
    assert_eq!(state.engine.clamped(3 * ROWS), None);
}

#[test]
fn a_changed_table_does_not_jump() {
    let (model, mut narrow) = (limits(), limits());
    narrow.joints[2].upper[0] = 2.0;
    let [wide, narrow] = [model, narrow].map(|model| model.tables(&rig()).unwrap());
    let [wide, narrow] = [&wide, &narrow].map(pipeline);
    let (mut state, mut out) = (State::new(), Pose::identity());
    let mut pose = Pose::<JOINTS>::identity();
    pose.root.y = wide.engine.table().rest[0][1];
    wide.start(&mut state, &pose);
    let mut watch = Watch::new(state.shown());
    for at in 0..400 {
        pose.rotations[2] = UnitQuaternion::from_scaled_axis(Vector3::x() * (1.0 + 0.7 * (at as f32 * 0.1).sin()));
        let limits = if at / 50 % 2 == 0 { &wide } else { &narrow };
        limits.step(&mut state, Some(&pose), &mut out);
        watch.check(&wide.engine, state.shown(), &format!("step {at}"));
    }
}

/// Position before speed, and speed before acceleration, where a table changes while a servo moves.
#[test]
fn two_tables_under_one_state_keep_what_comes_first() {
    let servos = Servos::new();
    let rig = Rig::new(&servos.kinds, &servos.axes, &servos.reference, &servos.middle, None).unwrap();
    let table = |upper, velocity, acceleration| LimitTable { upper, velocity, acceleration, ..SERVO_TABLE };
    let limits = |table| Limits::new(rig, Limiter::new(rig, table, LimitsMeta::default(), 60.0).unwrap()).unwrap();
    // The second servo of the first row is a slider; the first goes up at full speed when the table changes.
    let low = [[0.2, 0.3, 2.2], [0.5, -0.2, 0.0]];
    let slow = [[1.0, 0.5, 9.0], [2.0, 3.0, 0.0]];
    let weak = [[3.0, 4.0, 90.0], [300.0, 20.0, 0.0]];
    let before = limits(SERVO_TABLE);
    for (after, upper, speed) in [
        (limits(table(&low, SERVO_TABLE.velocity, SERVO_TABLE.acceleration)), 0.2, 4.0 / 60.0),
        (limits(table(SERVO_TABLE.upper, &slow, SERVO_TABLE.acceleration)), 1.5, 1.0 / 60.0),
        (limits(table(SERVO_TABLE.upper, SERVO_TABLE.velocity, &weak)), 1.5, 4.0 / 60.0),
        (limits(table(&low, &slow, &weak)), 0.2, 1.0 / 60.0),
    ] {
        // At every moment of the way up.
        for swap in 1..50 {
            let (mut state, mut out) = (State::new(), [0.0f32; 5]);
            let told = [1.5, 0.1, 0.2, 0.0, -0.2];
            let [mut last, mut went] = [0.0f32; 2];
            for at in 0..swap + 200 {
                let changed = at >= swap;
                let limits = if changed { &after } else { &before };
                limits.step_coordinates(&mut state, Some(&told), &mut out);
                let step = out[0] - last;
                if changed {
                    assert!(out[0] <= upper, "{swap}, {at}: {} above {upper}", out[0]);
                    // Only where the servo is beyond its new bound it goes faster than it may: to the bound, at once.
                    let back = last > upper && out[0] == upper;
                    assert!(back || step.abs() <= speed + 1e-6, "{swap}, {at}: {step} per frame, at most {speed}");
                    // Once it was put back it brakes, and nothing else takes it down.
                    assert!(step >= 0.0 || back || step > went, "{swap}, {at}: no bounce: {step} after {went}");
                }
                (last, went) = (out[0], step);
            }
            assert!((last - upper).abs() < 1e-4 && went.abs() < 1e-5, "{swap}: at {last}");
        }
    }
}
