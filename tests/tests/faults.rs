//! Fault injection: every kind of fault on every engine. Limits never exceeded; afterwards everything is as without the fault.

#[path = "common/engines.rs"]
mod engines;
#[path = "common/robot.rs"]
mod robot;

use engines::{ENGINES, Motion, Packs, Random, State, new_state};
use kinesic::Pose;
use kinesic::pipeline::Weights;
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use robot::{JOINTS, Watch};

/// When the fault starts, and the frames watched in all.
const START: usize = 200;
const FRAMES: usize = 900;
/// Frames after the fault's end within which every rotation is back.
const RECOVERY: usize = 200;
/// As near as this is back, rad (chord of the quaternions).
const BACK: f32 = 5e-3;

type Change = fn(&mut Pose<JOINTS>, usize, &mut Random);

/// What breaks.
enum Fault {
    /// No frame.
    Missing,
    /// Every other frame is missing.
    Jitter,
    /// The last frame again.
    Frozen,
    /// The frame is changed; true if the guard must see it.
    Frame(bool, Change),
    /// A control is changed, and put back at the end.
    Control(fn(&mut State)),
    /// Another pipeline takes over, and the first again at the end.
    Model,
}

fn raw(w: f32, x: f32, y: f32, z: f32) -> UnitQuaternion<f32> {
    UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z))
}

fn scaled(q: &UnitQuaternion<f32>, factor: f32) -> UnitQuaternion<f32> {
    UnitQuaternion::new_unchecked(q.into_inner() * factor)
}

/// Name, frames that it lasts, what.
const FAULTS: [(&str, usize, Fault); 22] = [
    ("one frame missing", 1, Fault::Missing),
    ("frames missing for two seconds", 120, Fault::Missing),
    ("every other frame missing", 60, Fault::Jitter),
    ("frozen for three seconds", 180, Fault::Frozen),
    (
        "NaN in a rotation",
        10,
        Fault::Frame(true, |pose, at, _| pose.rotations[at % JOINTS] = raw(1.0, f32::NAN, 0.0, 0.0)),
    ),
    ("NaN in the root", 10, Fault::Frame(true, |pose, _, _| pose.root.y = f32::NAN)),
    (
        "NaN everywhere",
        60,
        Fault::Frame(true, |pose, _, _| {
            pose.rotations = [raw(f32::NAN, f32::NAN, f32::NAN, f32::NAN); JOINTS];
            pose.root = Vector3::repeat(f32::NAN);
        }),
    ),
    ("infinite rotation", 10, Fault::Frame(true, |pose, _, _| pose.rotations[3] = raw(f32::INFINITY, 0.0, 0.0, 0.0))),
    ("infinite root", 10, Fault::Frame(true, |pose, _, _| pose.root.x = f32::NEG_INFINITY)),
    ("a rotation of length zero", 10, Fault::Frame(true, |pose, _, _| pose.rotations[2] = raw(0.0, 0.0, 0.0, 0.0))),
    (
        "all numbers zero",
        60,
        Fault::Frame(true, |pose, _, _| {
            pose.rotations = [raw(0.0, 0.0, 0.0, 0.0); JOINTS];
            pose.root = Vector3::zeros();
        }),
    ),
    (
        "rotations twice as long",
        10,
        Fault::Frame(true, |pose, _, _| {
            for q in &mut pose.rotations {
                *q = scaled(q, 2.0);
            }
        }),
    ),
    (
        "a rotation half as long",
        10,
        Fault::Frame(true, |pose, _, _| pose.rotations[1] = scaled(&pose.rotations[1], 0.5)),
    ),
    ("largest numbers", 10, Fault::Frame(true, |pose, _, _| pose.rotations[0] = raw(f32::MAX, f32::MAX, 0.0, 0.0))),
    ("root at ten thousand kilometres", 10, Fault::Frame(true, |pose, _, _| pose.root.z = 1e7)),
    (
        "rotations of the other sign",
        30,
        Fault::Frame(false, |pose, at, _| {
            if at.is_multiple_of(2) {
                for q in &mut pose.rotations {
                    *q = scaled(q, -1.0);
                }
            }
        }),
    ),
    ("root leaps by 100 m and back", 5, Fault::Frame(false, |pose, _, _| pose.root.x += 100.0)),
    (
        "left and right exchanged",
        20,
        Fault::Frame(false, |pose, _, _| {
            for (left, right) in [(1, 5), (2, 6), (3, 7), (4, 8), (13, 16), (14, 17), (15, 18)] {
                pose.rotations.swap(left, right);
            }
        }),
    ),
    (
        "random rotations",
        20,
        Fault::Frame(false, |pose, _, random| {
            for q in &mut pose.rotations {
                let part = Quaternion::new(random.unit(), random.unit(), random.unit(), random.unit() + 1e-3);
                *q = UnitQuaternion::new_normalize(part);
            }
        }),
    ),
    (
        "strength and expression NaN",
        20,
        Fault::Control(|state| {
            state.translate.controls.strength = f32::NAN;
            state.components.controls.strength = f32::NAN;
            state.emotion.strength = [f32::NAN; 4];
            state.modulation.amount = f32::NAN;
            state.weights = Weights { source: f32::NAN, ..Weights::default() };
        }),
    ),
    (
        "strength from 1 to 5 and back",
        20,
        Fault::Control(|state| {
            state.translate.controls.strength = 5.0;
            state.components.controls.strength = 5.0;
            state.emotion.strength = [5.0; 4];
            state.modulation.amount = 5.0;
        }),
    ),
    ("another model and back", 30, Fault::Model),
];

/// What came out, and the report.
struct Run {
    out: Vec<Pose<JOINTS>>,
    state: State,
}

fn run(packs: &Packs, engine: &str, fault: Option<&(&str, usize, Fault)>) -> Run {
    let device = packs.device(engine);
    let other = packs.device(if engine == "style components" { "limit alone" } else { "style components" });
    let limiter = device.limiter();
    let (mut state, mut motion, mut random) = (new_state(engine), Motion::new(3), Random(9));
    let first = Motion::new(3).next();
    device.start(&mut state, &first);
    let mut watch = Watch::new(limiter, state.limit());
    let (mut out, mut last) = (Pose::identity(), first);
    let mut run = Vec::new();
    let controls = state.clone();
    let mut seen = 0;
    for frame in 0..FRAMES {
        let mut input = motion.next();
        let mut device = &device;
        let mut given = true;
        let what = fault.map_or("no fault", |(name, ..)| name);
        let during = fault.filter(|(_, length, _)| (START..START + length).contains(&frame));
        let mut must_see = false;
        if let Some((.., fault)) = during {
            match fault {
                Fault::Missing => (given, must_see) = (false, true),
                Fault::Jitter => (given, must_see) = (frame.is_multiple_of(2), !frame.is_multiple_of(2)),
                Fault::Frozen => (input, must_see) = (last, frame - START > 60),
                Fault::Frame(see, change) => {
                    change(&mut input, frame, &mut random);
                    must_see = *see;
                }
                Fault::Control(change) => change(&mut state),
                Fault::Model => device = &other,
            }
            if matches!(fault, Fault::Model) && frame == START {
                state.change_model();
            }
        }
        if fault.is_some_and(|(_, length, fault)| frame == START + length && matches!(fault, Fault::Model)) {
            state.change_model();
        }
        if fault.is_some_and(|(_, length, fault)| frame == START + length && matches!(fault, Fault::Control(_))) {
            state.translate.controls = controls.translate.controls;
            state.components.controls = controls.components.controls;
            state.emotion.strength = controls.emotion.strength;
            state.modulation = controls.modulation;
            state.weights = controls.weights;
        }
        device.step(&mut state, given.then_some(&input), &mut out);
        last = input;
        watch.check(limiter, state.limit(), &out, &format!("{engine}, {what}, frame {frame}"));
        assert!(!must_see || state.report().fault.is_some(), "{engine}, {what}, frame {frame} passes the guard");
        assert!(
            during.is_some() || state.report().fault.is_none(),
            "{engine}, {what}, frame {frame}: {:?}",
            state.report()
        );
        seen += u32::from(state.report().fault.is_some());
        run.push(out);
    }
    assert_eq!(state.report().faulty_frames, seen);
    Run { out: run, state }
}

fn apart(a: &Pose<JOINTS>, b: &Pose<JOINTS>) -> f32 {
    let each = a.rotations.iter().zip(&b.rotations).map(|(a, b)| (2.0 - 2.0 * a.coords.dot(&b.coords).abs()).max(0.0));
    2.0 * each.fold(0.0, f32::max).sqrt()
}

#[test]
fn every_fault_on_every_engine_is_survived() {
    let packs = Packs::new();
    let mut slow = Vec::new();
    for engine in ENGINES {
        let calm = run(&packs, engine, None);
        let mut worst = (0, "");
        for fault in &FAULTS {
            let (name, length, _) = fault;
            let faulty = run(&packs, engine, Some(fault));
            let end = START + length;
            let rows = faulty.out.iter().zip(&calm.out).skip(end);
            let back =
                rows.collect::<Vec<_>>().into_iter().rposition(|(a, b)| apart(a, b) > BACK).map_or(0, |at| at + 1);
            println!("{engine}: {name}: back after {back} frames");
            // After another strength or model its own clock shows another time: another motion, nothing to come back from.
            if engine == "emotion" && (name.starts_with("strength from") || name.starts_with("another model")) {
                continue;
            }
            if back > worst.0 {
                worst = (back, name);
            }
            if back > RECOVERY {
                slow.push(format!("{engine}: {name}: {back} frames"));
            }
            // What went before is not touched, and neither are the controls.
            assert_eq!(faulty.out[..START], calm.out[..START], "{engine}: {name}");
            assert_eq!(faulty.state.translate.controls, calm.state.translate.controls, "{engine}: {name}");
            assert_eq!(faulty.state.modulation, calm.state.modulation, "{engine}: {name}");
        }
        println!("{engine}: the slowest recovery takes {} frames: {}", worst.0, worst.1);
    }
    assert!(slow.is_empty(), "not back within {RECOVERY} frames:\n{}", slow.join("\n"));
}
