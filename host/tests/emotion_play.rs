//! Playback of an emotion model: laws of the device's code, on the made walk.

use kinesic::emotion::{EmotionState, FADE, Place};
use kinesic::model::{ATTRIBUTES, AttributeMeta, EmotionMeta, Kind, ModelMeta};
use kinesic::pose::{World, forward};
use kinesic::rig::{Drift, JointKind};
use kinesic::{Emotion, Engine, Frame, Pack, Pipeline, PipelineState, Pose, Rig, Skeleton};
use kinesic_host::emotion::synthetic::{self, COMPONENTS, KEYS};
use kinesic_host::pack::{PackFile, PackWriter, Provenance};
use nalgebra::{UnitQuaternion, Vector3};
use proptest::prelude::*;

const JOINTS: usize = 19;
const ROWS: usize = JOINTS + 1;
type Model<'a> = Emotion<'a, ROWS, KEYS, COMPONENTS>;
type State = EmotionState<ROWS, KEYS>;

/// A model, and what turns its frames into positions.
struct Device<'a> {
    model: Model<'a>,
    rig: Rig<'a>,
    skeleton: Skeleton<'a>,
}

impl<'a> Device<'a> {
    fn load(pack: &Pack<'a>) -> Self {
        let (model, rig) = (Model::load(pack).unwrap(), Rig::load(pack).unwrap());
        Self { model, rig, skeleton: Skeleton::load(pack).unwrap() }
    }
}

fn file(attributes: usize) -> PackFile {
    let (model, rig) = synthetic::model(attributes);
    PackFile::from_bytes(&model.pack(&rig, &Provenance::default()))
}

/// The made walk as a gesture: it ends.
fn gesture() -> PackFile {
    let (mut model, rig) = synthetic::model(1);
    model.cycle = false;
    PackFile::from_bytes(&model.pack(&rig, &Provenance::default()))
}

fn started(strength: [f32; 4]) -> State {
    let mut state = State::new();
    state.strength = strength;
    state
}

fn step(device: &Device, state: &mut State, dt: f32) -> Pose<JOINTS> {
    let mut frame = Frame::new();
    device.model.step(state, dt, &mut frame);
    shown(device, &frame)
}

fn shown(device: &Device, frame: &Frame<ROWS>) -> Pose<JOINTS> {
    let mut pose = device.rig.rest();
    device.rig.show(frame, frame, &mut Drift::new(), &mut pose);
    pose
}

fn positions(device: &Device, pose: &Pose<JOINTS>) -> [Vector3<f32>; JOINTS] {
    let mut world = World::identity();
    forward(&device.skeleton, pose, &mut world);
    world.positions
}

/// Largest distance of a joint.
fn apart(device: &Device, a: &Pose<JOINTS>, b: &Pose<JOINTS>) -> f32 {
    let (a, b) = (positions(device, a), positions(device, b));
    a.iter().zip(b).map(|(a, b)| (a - b).norm()).fold(0.0, f32::max)
}

#[test]
fn thirty_sixty_and_hundred_and_twenty_frames_agree_at_common_times() {
    let (file, gesture) = (file(2), gesture());
    for file in [&file, &gesture] {
        let pack = file.pack().unwrap();
        let device = Device::load(&pack);
        let run = |rate: usize| {
            let mut state = started([0.2, 0.5, 0.0, 0.0]);
            let mut poses = Vec::new();
            for frame in 0..=10 * rate {
                // A change of strength at the same times.
                if frame == 2 * rate || frame == 3 * rate {
                    state.strength[0] = frame as f32 / rate as f32 - 2.0;
                }
                let pose = step(&device, &mut state, 1.0 / rate as f32);
                if frame % (rate / 30) == 0 {
                    poses.push(pose);
                }
            }
            poses
        };
        let slow = run(30);
        for fast in [run(60), run(120), run(90)] {
            let worst = slow.iter().zip(&fast).map(|(a, b)| apart(&device, a, b)).fold(0.0, f32::max);
            assert!(worst < 2e-4, "{worst} m");
        }
    }
}

/// Speeds of the joints right now, m/s, by two steps of a millisecond from a copy of the state.
fn rates(device: &Device, state: &State) -> [Vector3<f32>; JOINTS] {
    let mut state = *state;
    let [a, b] = [(); 2].map(|()| positions(device, &step(device, &mut state, 1e-3)));
    std::array::from_fn(|joint| (b[joint] - a[joint]) * 1e3)
}

#[test]
fn a_change_of_strength_moves_nothing_and_alters_no_speed() {
    let (file, gesture) = (file(2), gesture());
    for file in [&file, &gesture] {
        let pack = file.pack().unwrap();
        let device = Device::load(&pack);
        let mut state = started([0.0; 4]);
        let (mut moved, mut faster, mut kept) = (0f32, 0f32, 0f32);
        for at in 0..200 {
            step(&device, &mut state, 0.017);
            let (before, speed) = (step(&device, &mut state, 0.0), rates(&device, &state));
            let playing = state.playing();
            state.strength = [((at + 1) % 3) as f32 * 0.5, 1.0 - (at % 5) as f32 * 0.5, 0.0, 0.0];
            device.model.change(&mut state);
            assert_ne!(state.playing(), playing);
            let (after, speed_after) = (step(&device, &mut state, 0.0), rates(&device, &state));
            moved = moved.max(apart(&device, &before, &after));
            faster = speed.iter().zip(speed_after).map(|(a, b)| (a - b).norm()).fold(faster, f32::max);
            kept = speed.iter().map(|v| v.norm()).fold(kept, f32::max);
        }
        assert!(moved < 2e-5, "{moved} m");
        // Speeds are differences over a millisecond: single precision and accelerations show in them.
        assert!(faster < 0.15 && kept > 1.0, "{faster} m/s of {kept} m/s");
    }
}

#[test]
fn a_sweep_has_no_step_in_position_or_velocity() {
    let file = file(1);
    let pack = file.pack().unwrap();
    let device = Device::load(&pack);
    let rate = 240.0;
    // Largest speed and acceleration of any joint over ten seconds.
    let extremes = |sweep: &dyn Fn(f32) -> f32| {
        let mut state = started([sweep(0.0), 0.0, 0.0, 0.0]);
        let mut last: Vec<[Vector3<f32>; JOINTS]> = Vec::new();
        let mut most = [0f32; 2];
        for frame in 0..2400 {
            state.strength[0] = sweep(frame as f32 / rate);
            let now = positions(&device, &step(&device, &mut state, 1.0 / rate));
            if let [.., before, middle] = &last[..] {
                for joint in 0..JOINTS {
                    let (a, b) = (middle[joint] - before[joint], now[joint] - middle[joint]);
                    most = [most[0].max(b.norm() * rate), most[1].max((b - a).norm() * rate * rate)];
                }
            }
            last.push(now);
        }
        most
    };
    let still = [extremes(&|_| 0.0), extremes(&|_| 1.0)];
    let [speed, acceleration] = [0, 1].map(|k| still[0][k].max(still[1][k]));
    // There and back within two seconds, and a leap every half second.
    let swept = extremes(&|t| 0.5 - 0.5 * (3.0 * t).cos());
    let leaping = extremes(&|t| if (2.0 * t) as i32 % 2 == 0 { 0.0 } else { 1.0 });
    println!("speed m/s, acceleration m/s^2: steady {speed} {acceleration}, swept {swept:?}, leaping {leaping:?}");
    assert!(swept[0] < 1.2 * speed && swept[1] < 1.5 * acceleration, "{swept:?} {speed} {acceleration}");
    // A leap: 6 |offset| / FADE^2 + 4 |rate| / FADE more, with the offsets and rates of the two walks, under 0.4 m and 2 m/s.
    let bound = acceleration + 6.0 * 0.4 / (FADE * FADE) + 4.0 * 2.0 / FADE;
    assert!(leaping[1] < bound, "{leaping:?} {bound}");
}

#[test]
fn a_cycle_goes_on_where_it_ended() {
    let file = file(1);
    let pack = file.pack().unwrap();
    let device = Device::load(&pack);
    let mut state = started([0.0; 4]);
    let first = step(&device, &mut state, 0.0);
    let round = state.seconds();
    let mut last = first;
    let mut travels = Vec::new();
    for _ in 0..5 {
        // The whole round is the longest step there is.
        let pose = step(&device, &mut state, round);
        let next = step(&device, &mut state, 0.0);
        travels.push((next.root - pose.root).norm());
        for (a, b) in next.rotations.iter().zip(&first.rotations).skip(1) {
            assert!((a.coords - b.coords).norm() < 1e-3, "a round later the posture is the same");
        }
        last = next;
    }
    assert!(travels.iter().all(|t| (t / travels[0] - 1.0).abs() < 1e-3 && *t > 0.5), "{travels:?}");
    assert!((last.root.y - first.root.y).abs() < 1e-4);
    // Ten minutes on.
    for _ in 0..36_000 {
        last = step(&device, &mut state, 1.0 / 60.0);
    }
    assert!(last.is_sound(JOINTS) && (0.5..1.2).contains(&last.root.y), "{}", last.root);
    // Brought back to the origin, the same pose goes on.
    let before = step(&device, &mut state, 0.0);
    state.put(Place::default());
    let after = step(&device, &mut state, 0.0);
    assert!(after.root.xz().norm() < 3.0);
    for (a, b) in before.rotations.iter().zip(&after.rotations).skip(1) {
        assert!((a.coords - b.coords).norm() < 1e-2);
    }
}

#[test]
fn a_walk_keeps_its_direction_through_changes() {
    let file = file(2);
    let pack = file.pack().unwrap();
    let device = Device::load(&pack);
    let mut state = started([0.0; 4]);
    // Direction of the way of the next round, rad.
    let course = |state: &State| {
        let mut state = *state;
        let round = state.seconds();
        let start = step(&device, &mut state, round).root;
        let way = step(&device, &mut state, 0.0).root - start;
        way.x.atan2(way.z)
    };
    let (mut most, mut sum) = (0f32, 0f32);
    for change in 0..80 {
        // There and back at ever other phases.
        for _ in 0..37 + change {
            step(&device, &mut state, 0.011);
        }
        let before = course(&state);
        state.strength[0] = if change % 2 == 0 { 1.0 } else { 0.0 };
        device.model.change(&mut state);
        let (sin, cos) = (course(&state) - before).sin_cos();
        let turn = sin.atan2(cos);
        (most, sum) = (most.max(turn.abs()), sum + turn);
    }
    println!("a change turns the way of the next round by at most {most:.3} rad, 80 changes by {sum:.3} rad");
    // A round of the slower walk turns by more: half of that to either side.
    assert!(most < 0.08 && sum.abs() < 0.3, "{most} {sum}");
}

#[test]
fn a_gesture_ends_stands_and_starts_again() {
    let file = gesture();
    let pack = file.pack().unwrap();
    let device = Device::load(&pack);
    let mut state = started([0.0; 4]);
    step(&device, &mut state, 0.0);
    let round = state.seconds();
    for _ in 0..60 {
        step(&device, &mut state, round / 50.0);
    }
    assert!(state.has_ended());
    for _ in 0..20 {
        step(&device, &mut state, 0.1);
    }
    let (a, b) = (step(&device, &mut state, 0.1), step(&device, &mut state, 0.1));
    assert_eq!(a, b, "it stands");
    device.model.restart(&mut state);
    assert!(!state.has_ended());
    let c = step(&device, &mut state, 0.5 * round);
    assert!(apart(&device, &a, &c) < 2e-5, "a restart moves nothing");
    assert!(apart(&device, &a, &step(&device, &mut state, 0.0)) > 0.1, "it plays again");
}

#[test]
fn strengths_outside_the_range_or_nan_are_held() {
    let file = file(2);
    let pack = file.pack().unwrap();
    let device = Device::load(&pack);
    let mut state = started([7.0, -7.0, f32::NAN, 3.0]);
    let far = step(&device, &mut state, 0.0);
    assert_eq!(state.playing(), Some([1.0, -1.0, 0.0, 0.0]));
    assert_eq!(far, step(&device, &mut started([1.0, -1.0, 0.0, 0.0]), 0.0));
    state.strength = [f32::NAN, f32::NEG_INFINITY, 0.0, 0.0];
    assert_eq!(far, step(&device, &mut state, 0.0), "what is no number changes nothing");
    assert_eq!(state.playing(), Some([1.0, -1.0, 0.0, 0.0]));
    for dt in [f32::NAN, f32::INFINITY, -1.0, f32::NEG_INFINITY] {
        assert_eq!(far, step(&device, &mut state, dt), "no time passes");
    }
    step(&device, &mut state, 1e30);
    assert!(step(&device, &mut state, 0.0).is_sound(JOINTS), "at most a round passes");
}

#[test]
fn travel_adds_up_to_the_way_and_a_state_can_stand_in_a_static() {
    static START: State = State::new();
    let file = file(1);
    let pack = file.pack().unwrap();
    let device = Device::load(&pack);
    let (mut state, mut frame) = (START, Frame::<ROWS>::new());
    let mut way = Vector3::zeros();
    for at in 0..400 {
        state.strength[0] = (at % 90) as f32 / 90.0;
        device.model.step(&mut state, 0.013, &mut frame);
        let [x, _, z] = frame.rows[0];
        if at == 0 {
            assert_eq!([x, z], [0.0; 2], "nothing has travelled yet");
            way = Vector3::new(frame.ground[0], 0.0, frame.ground[1]);
        }
        way += frame.heading.to_world(Vector3::new(x, 0.0, z));
        assert!((way - Vector3::new(frame.ground[0], 0.0, frame.ground[1])).norm() < 1e-4, "{way} {:?}", frame.ground);
    }
    assert!(way.norm() > 2.0, "{way}");
    // Put elsewhere it has not travelled.
    let before = frame.rows[0];
    state.put(Place { ground: Vector3::new(50.0, 0.0, 7.0), ..state.place() });
    device.model.step(&mut state, 0.013, &mut frame);
    assert!(frame.ground[0] > 40.0 && frame.rows[0].iter().zip(before).all(|(a, b)| (a - b).abs() < 0.01));
}

#[test]
fn between_pose_and_pose_it_walks_on_from_where_the_source_stands() {
    let file = file(1);
    let pack = file.pack().unwrap();
    let device = Device::load(&pack);
    let pipeline = Pipeline::<Model, ROWS>::load(&pack).unwrap();
    let mut state = Box::new(PipelineState::new());
    // The source walks about on its own way, and leaps.
    let source = |at: usize| {
        let mut pose: Pose<JOINTS> = device.rig.rest();
        pose.root = Vector3::new(3.0 + 0.01 * at as f32 + if at > 250 { 9.0 } else { 0.0 }, 1.0, -2.0);
        pose.rotations[0] = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), 1.2) * pose.rotations[0];
        pose.rotations[4] = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), 0.1 * (at % 7) as f32);
        pose
    };
    pipeline.start(&mut state, &source(0));
    // The same by itself.
    let mut alone = started([0.0; 4]);
    let heading = state.source().heading;
    alone.put(Place { ground: Vector3::new(3.0, 0.0, -2.0), heading });
    let mut out = Pose::identity();
    for at in 0..600 {
        let strength = if at < 300 { 0.0 } else { 0.7 };
        (state.engine.strength[0], alone.strength[0]) = (strength, strength);
        let pose = source(at);
        // Frames that do not come stop nothing.
        pipeline.step(&mut state, (at % 10 < 8).then_some(&pose), &mut out);
        let expected = step(&device, &mut alone, 1.0 / 60.0);
        let far = apart(&device, &out, &expected);
        assert!(far < 1e-3, "frame {at}: {far} m");
    }
    assert!((out.root - source(0).root).norm() > 5.0, "it went its way: {}", out.root);
    // A chain with nothing else is the same engine.
    let mut chain = <(Model, Option<Model>) as Engine<ROWS>>::State::default();
    let mut frame = Frame::new();
    (device.model, None::<Model>).step(&mut chain, &mut frame);
    assert!(frame.is_sound() && frame.rows[0][1] > 0.5);
}

/// Three servos in a row, no root: a nod, stronger with the strength.
fn robot(cycle: bool) -> PackFile {
    let mut pack = PackWriter::new(Kind::Emotion, "nod", 50.0);
    for (name, parent) in [("base", None), ("neck", Some(0)), ("head", Some(1))] {
        pack.joint(name, parent);
    }
    let upright = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
    pack.u16s("rig/kinds", 1, &[JointKind::Hinge as u16; 3]);
    pack.f32s("rig/axes", 9, &[upright; 3].concat());
    pack.f32s("rig/reference", 4, &[[0.0, 0.0, 0.0, 1.0]; 3].concat());
    pack.f32s("rig/middle", 3, &[0.0; 9]);
    pack.f32s("rig/across", 3, &[]);
    let mut attributes = [None; ATTRIBUTES];
    attributes[0] = Some(AttributeMeta { name: "eager", strength: [0.0, 1.0] });
    let duration = [0.01, 2.0];
    let (motion, keyframes, components, hidden) = ("nod", 4, 1, 1);
    pack.model(&ModelMeta::Emotion(EmotionMeta { motion, attributes, keyframes, components, hidden, cycle, duration }));
    pack.f32s("emotion/hidden", 2, &[0.0, 0.0]);
    // A keyframe is one component: the nod, by how much at strength 1.
    let layers: Vec<f32> = [0.0, 0.6, -0.3, 0.02]
        .iter()
        .flat_map(|nod| [[0.0, *nod], [0.0; 2], [0.0; 2], [0.0; 2]].concat().into_iter().chain([0.0; 8]))
        .collect();
    pack.tiled("emotion/output", 2, &layers);
    pack.f32s("emotion/output_bias", 1, &[0.0, 0.1, -0.1, 0.0]);
    pack.tiled("emotion/coordinates", 1, &[0.5, 1.0, 0.25]);
    pack.f32s("emotion/mean", 1, &[0.1, 0.0, -0.2]);
    pack.tiled("emotion/velocity", 1, &[0.0; 3]);
    pack.f32s("emotion/velocity_mean", 1, &[0.3, 0.4, 0.5]);
    pack.f32s("emotion/lever", 1, &[0.2, 0.15, 0.15]);
    PackFile::from_bytes(&pack.finish(&Provenance::default()))
}

#[test]
fn a_robot_without_a_root_nods_and_never_meets_a_place() {
    for cycle in [false, true] {
        let file = robot(cycle);
        let pack = file.pack().unwrap();
        let pipeline = Pipeline::<Emotion<1, 4, 2>, 1>::load(&pack).unwrap();
        let mut state = PipelineState::<EmotionState<1, 4>, 1>::new();
        let (mut most, mut last, mut fastest) = ([0f32; 2], None::<[f32; 3]>, 0f32);
        for at in 0..300 {
            state.engine.strength[0] = if at < 150 { 0.0 } else { 1.0 };
            let mut out = [0.0; 3];
            pipeline.step_coordinates(&mut state, Some(&[0.3, 0.3, 0.3]), &mut out);
            let [a, b, c] = out;
            // Without what fades, the three move together.
            if at % 150 > 30 {
                assert!((2.0 * (a - 0.1) - b).abs() < 1e-5 && (4.0 * (c + 0.2) - b).abs() < 1e-5, "{out:?}");
            }
            most[at / 150] = most[at / 150].max(b.abs());
            fastest = last.map_or(fastest, |last| fastest.max((b - last[1]).abs()));
            last = Some(out);
        }
        assert!(fastest < 0.2, "{fastest} rad in a frame");
        if cycle {
            assert!(most[1] > 3.0 * most[0], "{most:?}");
        }
        assert_eq!(state.shown().ground, [0.0; 2]);
        assert_eq!(state.engine.has_ended(), !cycle);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Whatever is asked for at whatever times: bones keep their length, rotations stay rotations, nothing leaps.
    #[test]
    fn any_sequence_of_strengths_and_steps_is_a_motion(
        asked in proptest::collection::vec((-2.0f32..2.0, -2.0f32..2.0, 0.0f32..0.05), 1..200),
    ) {
        let file = file(2);
        let pack = file.pack().unwrap();
        let device = Device::load(&pack);
        let mut state = started([0.0; 4]);
        let mut last = step(&device, &mut state, 0.0);
        for (weary, swaying, dt) in asked {
            state.strength = [weary, swaying, 0.0, 0.0];
            let pose = step(&device, &mut state, dt);
            prop_assert!(pose.is_sound(JOINTS));
            prop_assert!(apart(&device, &last, &pose) < 1e-4, "a change moves by {}", apart(&device, &last, &pose));
            last = step(&device, &mut state, 0.0);
            prop_assert!(apart(&device, &last, &pose) <= 12.0 * dt + 1e-4, "{} m in {dt} s", apart(&device, &last, &pose));
        }
    }
}
