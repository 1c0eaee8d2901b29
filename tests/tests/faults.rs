//! Fault injection: every kind of fault on every engine. Limits never exceeded; afterwards everything is as without the fault.

#[path = "common/engines.rs"]
mod engines;
#[path = "common/robot.rs"]
mod robot;

use engines::{
    ENGINES, Engines, Feel, Limit, Mechanics, Motion, Packs, Random, Restyle, State, Translate, engine, limit_state,
    new_state, weights,
};
use kinesic::engine::Engine;
use kinesic::{Frame, Pose, Rig};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use robot::{JOINTS, ROWS, Watch};

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
            let mix = &mut state.engine.0;
            mix.engines.0.modulation.amount = f32::NAN;
            mix.engines.1.controls.strength = f32::NAN;
            mix.engines.2.controls.strength = f32::NAN;
            mix.engines.3.strength = [f32::NAN; 4];
            (mix.weights, mix.source) = ([f32::NAN; 4], f32::NAN);
        }),
    ),
    (
        "strength from 1 to 5 and back",
        20,
        Fault::Control(|state| {
            let (expression, translator, components, emotion) = &mut state.engine.0.engines;
            expression.modulation.amount = 5.0;
            translator.controls.strength = 5.0;
            components.controls.strength = 5.0;
            emotion.strength = [5.0; 4];
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
    // Of the same coordinates.
    let other = match engine {
        "limits of hinges and chains" => engine,
        "style components" => "translator, whole body",
        _ => "style components",
    };
    let (other_weights, other) = (weights(other), packs.device(other));
    let limiter = &device.engine.1;
    let (mut state, mut motion, mut random) = (new_state(engine), Motion::new(3), Random(9));
    let first = Motion::new(3).next();
    device.start(&mut state, &first);
    let mut watch = Watch::new(&at_limits(&state));
    let (mut out, mut last) = (Pose::identity(), first);
    let mut run = Vec::new();
    let controls = state;
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
            if matches!(fault, Fault::Model) {
                (state.engine.0.weights, state.engine.0.source) = other_weights;
            }
        }
        if fault.is_some_and(|(_, length, fault)| {
            frame == START + length && matches!(fault, Fault::Control(_) | Fault::Model)
        }) {
            restore(&mut state, &controls);
        }
        device.step(&mut state, given.then_some(&input), &mut out);
        last = input;
        watch.check(limiter, state.shown(), &format!("{engine}, {what}, frame {frame}"));
        watch.check_pose(&out, state.source(), &format!("{engine}, {what}, frame {frame}"));
        assert!(!must_see || state.report().fault.is_some(), "{engine}, {what}, frame {frame} passes the guard");
        assert!(
            during.is_some() || state.report().fault.is_none(),
            "{engine}, {what}, frame {frame}: {:?}",
            state.report()
        );
        seen += u32::from(state.report().fault.is_some());
        run.push(out);
    }
    assert_eq!(state.report().faulty, seen);
    Run { out: run, state }
}

/// Where the limiter puts the robot at first.
fn at_limits(state: &State) -> Frame<ROWS> {
    let mut frame = *state.source();
    for (index, x) in frame.coordinates_mut().iter_mut().enumerate() {
        *x = limit_state(state).coordinate(index).unwrap();
    }
    frame
}

/// Puts the controls back.
fn restore(state: &mut State, controls: &State) {
    let (mix, before) = (&mut state.engine.0, &controls.engine.0);
    mix.engines.0.modulation = before.engines.0.modulation;
    mix.engines.1.controls = before.engines.1.controls;
    mix.engines.2.controls = before.engines.2.controls;
    mix.engines.3.strength = before.engines.3.strength;
    (mix.weights, mix.source) = (before.weights, before.source);
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
            let mut restored = faulty.state;
            restore(&mut restored, &calm.state);
            assert_eq!(restored.engine.0, faulty.state.engine.0, "{engine}: {name}");
        }
        println!("{engine}: the slowest recovery takes {} frames: {}", worst.0, worst.1);
    }
    assert!(slow.is_empty(), "not back within {RECOVERY} frames:\n{}", slow.join("\n"));
}

/// What a bare engine is given for one frame.
enum Bad<S> {
    Frame(&'static str, fn(&mut Frame<ROWS>)),
    Control(fn(&mut S)),
}

/// One engine without a pipeline before it: one bad frame, or one frame with a control that is no number. Two frames later everything
/// is a number, and [`RECOVERY`] frames later it is as without the fault.
fn bare<E: Engine<ROWS>>(name: &str, rig: &Rig<'_>, engine: &E, set: fn(&mut E::State), spoil: fn(&mut E::State))
where
    E::State: Clone,
{
    let bad: [Bad<E::State>; 7] = [
        Bad::Frame("one coordinate NaN", |frame| frame.rows[4][1] = f32::NAN),
        Bad::Frame("all coordinates NaN", |frame| frame.rows = [[f32::NAN; 3]; ROWS]),
        Bad::Frame("one coordinate 3e38", |frame| frame.rows[4][1] = 3e38),
        Bad::Frame("all coordinates -3e38", |frame| frame.rows = [[-3e38; 3]; ROWS]),
        Bad::Frame("travel 3e38", |frame| frame.rows[0] = [3e38, 1.0, -3e38]),
        Bad::Frame("place and leap NaN", |frame| (frame.ground, frame.leap) = ([f32::NAN; 2], [f32::NAN; 2])),
        Bad::Control(spoil),
    ];
    let run = |bad: Option<&Bad<E::State>>| {
        let (mut state, mut motion, mut source) = (E::State::default(), Motion::new(3), Frame::new());
        set(&mut state);
        rig.read(&motion.next(), &mut source);
        engine.start(&mut state, &source);
        let mut out = Vec::new();
        for at in 0..START + RECOVERY + 100 {
            rig.read(&motion.next(), &mut source);
            let mut frame = source;
            match bad {
                Some(Bad::Frame(_, change)) if at == START => change(&mut frame),
                Some(Bad::Control(change)) if at == START => change(&mut state),
                Some(Bad::Control(_)) if at == START + 1 => set(&mut state),
                _ => {}
            }
            engine.step(&mut state, &mut frame);
            out.push(frame);
        }
        out
    };
    let calm = run(None);
    for bad in &bad {
        let what = if let Bad::Frame(what, _) = bad { what } else { "controls NaN" };
        let faulty = run(Some(bad));
        // Where only a control was bad, not even that frame is.
        let from = if matches!(bad, Bad::Frame(..)) { START + 2 } else { START };
        for (at, frame) in faulty.iter().enumerate().skip(from) {
            assert!(frame.is_sound(), "{name}: {what}: frame {at}: {frame:?}");
        }
        let apart = |a: &Frame<ROWS>, b: &Frame<ROWS>| {
            a.coordinates().iter().zip(b.coordinates()).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
        };
        let pairs: Vec<_> = faulty.iter().zip(&calm).skip(START + 1).collect();
        let back = pairs.into_iter().rposition(|(a, b)| apart(a, b) > BACK).map_or(0, |at| at + 1);
        println!("{name} alone: {what}: back after {back} frames");
        assert!(back <= RECOVERY, "{name}: {what}: back after {back} frames");
        assert_eq!(faulty[..START], calm[..START], "{name}: {what}");
    }
}

#[test]
fn a_bad_frame_is_survived_by_engines_without_a_pipeline() {
    let packs = Packs::new();
    let limiter: Limit<'_> = engine(&packs.balls);
    let rig = limiter.rig();
    for (name, file) in [("translator, whole body", &packs.body), ("translator, per joint", &packs.joint)] {
        let translator: Translate<'_> = engine(file);
        let full = |state: &mut <Translate<'_> as Engine<ROWS>>::State| state.controls.strength = 1.0;
        bare(name, rig, &translator, full, |state| state.controls.strength = f32::NAN);
        bare(
            name,
            rig,
            &translator,
            |state| state.controls.mask[4] = [1.0; 3],
            |state| {
                state.controls.mask[4] = [f32::NAN, f32::INFINITY, -3e38];
            },
        );
    }
    let mechanics: Mechanics<'_> = engine(&packs.mechanics);
    bare(
        "body mechanics",
        rig,
        &mechanics,
        |state| state.modulation.amount = 0.5,
        |state| {
            state.modulation.amount = f32::NAN;
        },
    );
    let components: Restyle<'_> = engine(&packs.components);
    bare(
        "style components",
        rig,
        &components,
        |state| state.controls.strength = 1.0,
        |state| {
            state.controls.strength = f32::NAN;
        },
    );
    let emotion: Feel<'_> = engine(&packs.emotion);
    bare("emotion", rig, &emotion, |state| state.strength[0] = 0.5, |state| state.strength = [f32::NAN; 4]);
    bare("limits of balls", rig, &limiter, |_| (), |_| ());
    let hinges: Limit<'_> = engine(&packs.limits);
    bare("limits of hinges and chains", hinges.rig(), &hinges, |_| (), |_| ());
    let set = |(mix, _): &mut <Engines<'_> as Engine<ROWS>>::State| {
        (mix.weights, mix.source) = weights("pipeline");
        mix.engines.0.modulation.amount = 0.5;
    };
    bare("all of them", rig, &packs.device("pipeline").engine, set, |(mix, _)| {
        (mix.weights, mix.source) = ([f32::NAN; 4], f32::NAN);
    });
}
