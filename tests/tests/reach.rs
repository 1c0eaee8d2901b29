//! The root of a result stays in reach of the source's: changed travel, limits that bridge a leap, feet that are held.

#[path = "common/robot.rs"]
mod robot;

use kinesic::engine::Engine;
use kinesic::rig::{Drift, REACH};
use kinesic::{Feet, FeetState, Frame, Limiter, Pack, Pipeline, PipelineState, Pose, Translator, TranslatorState};
use kinesic_host::gait::{Manner, walk};
use kinesic_host::pack::PackFile;
use kinesic_host::rig::Rig;
use nalgebra::{UnitQuaternion, Vector3};
use proptest::prelude::*;
use robot::{JOINTS, RATE, ROWS, rig, tables};

/// How far apart two roots are over the ground, m.
fn apart(a: &Pose<JOINTS>, b: &Pose<JOINTS>) -> f32 {
    let way = a.root - b.root;
    way.x.hypot(way.z)
}

/// Rounding of a sum whose parts are so large.
fn rounding(pose: &Pose<JOINTS>) -> f32 {
    1e-5 + 2e-7 * pose.root.norm()
}

/// Travel as an engine may make it: small, large, or enough to leave every continent.
fn travel() -> impl Strategy<Value = [f32; 2]> {
    let one = || prop_oneof![6 => -0.05f32..0.05, 1 => -3f32..3.0, 1 => -1e6f32..1e6];
    (one(), one()).prop_map(|(x, z)| [x, z])
}

fn turned(random: &mut u64) -> UnitQuaternion<f32> {
    let mut unit = || {
        *random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((*random >> 33) % 20_001) as f32 * 1e-4 - 1.0
    };
    UnitQuaternion::from_scaled_axis(Vector3::new(unit(), unit(), unit()) * 2.0)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn no_sequence_of_travel_leads_out_of_reach(
        ways in prop::collection::vec((travel(), travel()), 1..200),
        start in -1e6f32..1e6,
        reach in prop_oneof![0f32..10.0, Just(REACH)],
    ) {
        let rig = rig();
        let device = rig.frames();
        let (mut source, mut drift) = (Frame::<ROWS>::new(), Drift::new());
        source.reach = reach;
        let (mut pose, mut out) = (Pose::<JOINTS>::identity(), Pose::identity());
        pose.root.x = 0.9 * start;
        for ([x, z], [own_x, own_z]) in ways {
            pose.root += Vector3::new(own_x.clamp(-0.1, 0.1), 0.0, own_z.clamp(-0.1, 0.1));
            device.read(&pose, &mut source);
            let mut styled = source;
            styled.rows[0][0] += x;
            styled.rows[0][2] += z;
            device.write(&source, &styled, &mut drift, &pose, &mut out);
            prop_assert!(apart(&pose, &out) <= reach + rounding(&pose), "{} of {reach}", apart(&pose, &out));
        }
    }

    #[test]
    fn feet_keep_any_pose_sound_and_in_reach(seed in any::<u64>(), far in prop_oneof![Just(0f32), -1e6f32..1e6], wide in 0f32..3.0) {
        let pack = weary();
        let feet = Feet::load(&pack.pack().unwrap()).unwrap();
        let (mut state, mut random) = (FeetState::new(), seed);
        let mut source = Pose::<JOINTS>::identity();
        source.root = Vector3::new(0.9 * far, 0.9, 0.0);
        for frame in 0..60 {
            source.root.z += 0.02;
            source.rotations = std::array::from_fn(|_| turned(&mut random));
            let mut out = source;
            out.rotations = std::array::from_fn(|_| turned(&mut random));
            out.root += turned(&mut random) * Vector3::new(wide, 0.0, 0.0);
            let put = apart(&source, &out);
            // Some frames do not come.
            let came = (frame % 17 != 5).then_some(&source);
            feet.step(&mut state, came, &mut out);
            prop_assert!(out.is_sound(JOINTS), "{out:?}");
            let most = put.max(REACH);
            let is = apart(&source, &out);
            prop_assert!(came.is_none() || is <= most + rounding(&source), "{is} of {most}");
        }
    }
}

fn weary() -> PackFile {
    PackFile::read(&std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../models/weary.kin")).unwrap()
}

/// Makes steps longer or shorter, m a frame.
struct Steps(f32);

impl<const R: usize> Engine<R> for Steps {
    type State = ();
    fn start(&self, (): &mut (), _: &Frame<R>) {}
    fn step(&self, (): &mut (), frame: &mut Frame<R>) {
        frame.rows[0][2] += self.0;
    }
}

#[test]
fn limits_bridge_a_leap_at_their_speed_and_come_back_into_reach() {
    let tables = tables();
    let limiter: Limiter<'_, ROWS> = tables.limiter().unwrap();
    let pipeline = Pipeline::<_, ROWS>::new(tables.rig().frames(), (Steps(0.01), limiter)).unwrap();
    let mut state = PipelineState::new();
    let (mut source, mut out) = (Pose::<JOINTS>::identity(), Pose::identity());
    source.root.y = 0.9;
    pipeline.start(&mut state, &source);
    pipeline.step(&mut state, Some(&source), &mut out);
    let run = |state: &mut _, source: &mut Pose<JOINTS>, out: &mut Pose<JOINTS>, frames: usize| {
        for _ in 0..frames {
            let before = out.root;
            source.root.x += 0.02;
            pipeline.step(state, Some(source), out);
            let step = (out.root - before).xz().norm();
            assert!(step <= 6.0 / RATE + 1e-4, "{step}: faster than the limit");
        }
    };
    run(&mut state, &mut source, &mut out, 2000);
    assert!((0.98 * REACH..REACH + 0.02).contains(&apart(&source, &out)), "{}", apart(&source, &out));
    source.root.z += 100.0;
    run(&mut state, &mut source, &mut out, 10);
    assert!(apart(&source, &out) > 50.0, "a leap is no way to go in a frame");
    run(&mut state, &mut source, &mut out, 3000);
    assert!(apart(&source, &out) < REACH + 0.02, "{}", apart(&source, &out));
    // It is the same behind limits as without them, where these hold nothing back.
    let free = Pipeline::<_, ROWS>::new(tables.rig().frames(), Steps(0.01)).unwrap();
    let mut free_state = PipelineState::new();
    let mut free_out = out;
    for _ in 0..3000 {
        source.root.x += 0.02;
        free.step(&mut free_state, Some(&source), &mut free_out);
        pipeline.step(&mut state, Some(&source), &mut out);
    }
    assert!(apart(&free_out, &out) < 0.05, "{}", apart(&free_out, &out));
}

#[test]
fn without_a_reach_travel_adds_up() {
    let rig = rig();
    let mut pipeline = Pipeline::<_, ROWS>::new(rig.frames(), Steps(0.01)).unwrap();
    pipeline.reach = f32::INFINITY;
    let mut state = PipelineState::new();
    let (source, mut out) = (Pose::<JOINTS>::identity(), Pose::identity());
    for _ in 0..10_000 {
        pipeline.step(&mut state, Some(&source), &mut out);
    }
    assert!((apart(&source, &out) - 100.0).abs() < 0.1, "{}", apart(&source, &out));
}

/// The weary style on a made walk of so many seconds, feet free and held: `[source, free, held]`.
fn played(seconds: f64, strength: f32) -> (Rig, [Vec<Pose<JOINTS>>; 3]) {
    let file = weary();
    let pack: Pack<'_> = file.pack().unwrap();
    let rig = Rig::from_pack(&pack).unwrap();
    let clip = walk(&Manner::NEUTRAL, seconds, f64::from(RATE), 0.0, 3);
    let source: Vec<Pose<JOINTS>> = (0..clip.frames())
        .map(|frame| {
            let mut pose = Pose::identity();
            pose.root = clip.root[frame].map(|x| x as f32);
            pose.rotations.iter_mut().zip(clip.pose(frame)).for_each(|(to, from)| *to = from.cast());
            pose
        })
        .collect();
    let pipeline = Pipeline::<Translator<'_, ROWS, 60>, ROWS>::load(&pack).unwrap();
    let feet = Feet::load(&pack).unwrap();
    let (mut state, mut feet_state) = (PipelineState::<TranslatorState<ROWS, 60>, ROWS>::new(), FeetState::new());
    state.engine.controls.strength = strength;
    pipeline.start(&mut state, &source[0]);
    let (mut free, mut held) = (Vec::new(), Vec::new());
    let mut out = Pose::identity();
    for pose in &source {
        pipeline.step(&mut state, Some(pose), &mut out);
        free.push(out);
        let mut out = out;
        feet.step(&mut feet_state, Some(pose), &mut out);
        held.push(out);
    }
    (rig, [source, free, held])
}

#[test]
fn held_feet_stand_on_a_walk_of_minutes_and_the_root_stays_in_reach() {
    let (rig, motions) = played(180.0, 1.0);
    let [source, free, held] = motions.each_ref().map(|poses| {
        let clip = kinesic_host::clip::Clip {
            skeleton: rig.skeleton.clone(),
            frame_time: 1.0 / f64::from(RATE),
            root: poses.iter().map(|pose| pose.root.cast()).collect(),
            rotations: poses.iter().flat_map(|pose| pose.rotations.iter().map(|q| q.cast())).collect(),
            coordinates: None,
            notes: Vec::new(),
        };
        kinesic_host::quality::measure(&clip, &rig.map)
    });
    println!("source {source:?}\nfree {free:?}\nheld {held:?}");
    assert!(held.foot_slide_cm_s < 1.3 * source.foot_slide_cm_s, "{held:?} {source:?}");
    assert!(held.jerk_m_s3 < 1.3 * free.jerk_m_s3, "{held:?} {free:?}");
    let [source, free, held] = &motions;
    for out in [free, held] {
        let far = source.iter().zip(out).map(|(a, b)| apart(a, b)).fold(0.0, f32::max);
        assert!(far <= REACH + 1e-4, "{far}");
    }
}

#[test]
fn where_the_style_changes_nothing_nothing_is_held() {
    let (_, [source, _, held]) = played(4.0, 0.0);
    assert!(source == held, "strength 0 is the source, bit for bit");
}

#[test]
fn a_frame_that_does_not_come_changes_nothing() {
    let file = weary();
    let feet = Feet::load(&file.pack().unwrap()).unwrap();
    let (_, [source, free, held]) = played(3.0, 1.0);
    let mut state = FeetState::new();
    let mut out = Pose::identity();
    for ((source, free), held) in source.iter().zip(&free).zip(&held) {
        out = *free;
        feet.step(&mut state, Some(source), &mut out);
        assert_eq!(out, *held);
    }
    for _ in 0..30 {
        let mut again = *free.last().unwrap();
        feet.step(&mut state, None, &mut again);
        assert!(apart(&again, &out) < 1e-6);
        let far = again.rotations.iter().zip(&out.rotations).map(|(a, b)| a.angle_to(b)).fold(0.0, f32::max);
        assert!(far < 0.02, "{far}");
    }
    // A pose that is none is left alone.
    let mut broken = out;
    broken.rotations[2] = UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(f32::NAN, 0.0, 0.0, 0.0));
    let before = broken.rotations.map(|q| q.coords.map(f32::to_bits));
    feet.step(&mut state, source.last(), &mut broken);
    assert_eq!(broken.rotations.map(|q| q.coords.map(f32::to_bits)), before);
}

#[test]
fn a_skeleton_without_legs_is_refused_by_name() {
    use kinesic::LoadError;
    use kinesic_host::clip::{Joint, Skeleton};
    use kinesic_host::rig::JointCoordinates;
    let joint = |name: &str, parent| Joint {
        name: name.to_owned(),
        parent,
        offset: nalgebra::Vector3::new(0.0, 0.1, 0.0),
        end: None,
    };
    let skeleton = Skeleton { joints: vec![joint("base", None), joint("arm", Some(0))] };
    let coordinates = vec![JointCoordinates::new(kinesic::rig::JointKind::Hinge); 2];
    let machine = Rig::machine(&skeleton, &coordinates).unwrap();
    let limits = kinesic_host::limit::LimitsModel::free("machine", 60.0, &machine, 6.0, 60.0);
    let bytes = limits.pack(&machine, &kinesic_host::pack::Provenance::default()).unwrap();
    let file = PackFile::from_bytes(&bytes);
    let refused = Feet::load(&file.pack().unwrap()).unwrap_err();
    assert_eq!(refused, LoadError::Value { tensor: "skeleton/canonical", index: 13 });
}
