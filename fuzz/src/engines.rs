//! Every engine, 100 frames. [`live`] has every engine that restyles; one that can do more gets a function and a line in [`step_all`].

use kinesic::emotion::{Emotion, EmotionState, Place};
use kinesic::engine::live::{self, Live};
use kinesic::engine::{Engine, FromPack, Mix, MixState};
use kinesic::face::{FaceState, FaceSynth, POINTS};
use kinesic::limit::{LimitState, Limiter};
use kinesic::mechanics::{Blend, Decoupled, Expression, Modulation, Window, mix, modulate};
use kinesic::{
    BodyMechanics, Components, ComponentsState, Frame, MechanicsState, Pack, Pipeline, PipelineState, Pose, Translator,
};

use super::frames::{Frames, JOINTS, ROWS};

/// Frames that each engine steps.
const STEPS: usize = 100;

/// Steps every engine that takes the pack.
pub fn step_all(pack: &Pack, frames: &mut Frames) {
    live(pack, frames);
    translator(pack, frames);
    mechanics(pack, frames);
    components(pack, frames);
    face(pack, frames);
    emotion(pack, frames);
    limit(pack, frames);
}

/// An engine by itself and between poses, whatever goes in, with controls set anew every ten frames: a sound frame stays sound, and
/// what comes out is a pose.
fn hold<'p, E: Engine<ROWS> + FromPack<'p>>(pack: &Pack<'p>, frames: &mut Frames, set: fn(&mut E::State, &mut Frames)) {
    let Ok(device) = Pipeline::<E, ROWS>::load(pack) else { return };
    let mut state = Box::new(E::State::default());
    device.engine.start(&mut state, &frames.frame());
    for step in 0..STEPS {
        if step % 10 == 0 {
            set(&mut state, frames);
        }
        let mut frame = frames.frame();
        let sound = frame.is_sound();
        device.engine.step(&mut state, &mut frame);
        assert!(!sound || frame.is_sound(), "step {step}: {frame:?}");
        if frames.next().is_multiple_of(8) {
            frame = Frame::new();
            device.engine.idle(&mut state, &mut frame);
            assert!(frame.is_sound(), "step {step}: idle: {frame:?}");
        }
    }
    let mut state = Box::new(PipelineState::new());
    let mut out = device.rig().rest();
    device.start(&mut state, &frames.pose());
    for step in 0..STEPS {
        if step % 10 == 0 {
            set(&mut state.engine, frames);
        }
        let pose = frames.pose();
        device.step(&mut state, (!frames.next().is_multiple_of(8)).then_some(&pose), &mut out);
        let unit = |q: &kinesic::nalgebra::UnitQuaternion<f32>| (q.norm() - 1.0).abs() < 0.1;
        assert!(out.root.iter().all(|x| x.is_finite()), "step {step}: {out:?}");
        assert!(out.rotations.iter().take(device.rig().joints()).all(unit), "step {step}: {out:?}");
    }
    let mut servos = [0.0; 3 * ROWS];
    for _ in 0..STEPS {
        let frame = frames.frame();
        device.step_coordinates(&mut state, Some(frame.coordinates()), &mut servos);
        assert!(servos.iter().all(|x| x.is_finite()));
    }
}

/// Strength and mask.
macro_rules! controls {
    ($state:expr, $frames:expr) => {{
        $state.controls.strength = $frames.control();
        $state.controls.mask = std::array::from_fn(|_| std::array::from_fn(|_| $frames.control()));
    }};
}

/// Whatever the pack has, in series: a new engine comes by here.
fn live(pack: &Pack, frames: &mut Frames) {
    hold::<Live<ROWS, 1024, 64>>(pack, frames, |state, frames| {
        live::controls(state).for_each(|to| {
            to.strength = frames.control();
            to.mask = std::array::from_fn(|_| std::array::from_fn(|_| frames.control()));
        });
    });
}

fn translator(pack: &Pack, frames: &mut Frames) {
    hold::<Translator<ROWS, 1024>>(pack, frames, |state, frames| controls!(state, frames));
    // Side by side with what else the pack holds.
    type Both<'a> = Mix<(Translator<'a, ROWS, 1024>, Option<Components<'a, ROWS, 64>>)>;
    hold::<Both>(pack, frames, |state: &mut MixState<_, 2>, frames| {
        (state.weights, state.source) = ([frames.control(), frames.control()], frames.control());
    });
}

fn mechanics(pack: &Pack, frames: &mut Frames) {
    hold::<Expression<JOINTS, 512, 120>>(pack, frames, |state, frames| state.modulation.amount = frames.control());
    let Ok(model) = BodyMechanics::<JOINTS, 512, 120>::load(pack) else { return };
    let mut state = Box::new(MechanicsState::new());
    let (mut parts, mut before) = (Decoupled::identity(), Decoupled::identity());
    let mut out = Pose::identity();
    for step in 0..STEPS {
        let pose = frames.pose();
        model.step(&mut state, &pose, &mut parts);
        let mut modulation = Modulation { amount: frames.control(), ..Modulation::default() };
        modulation.mask = std::array::from_fn(|_| frames.control());
        modulate(&pose, &parts, &modulation, &mut out);
        mix(&parts, &before, &modulation, &mut out);
        let [a, b, c, d] = [(); 4].map(|()| 50.0 * frames.control());
        let blend = Blend { mechanics: Window { start: a, end: b }, expressive: Window { start: c, end: d } };
        blend.step(step as f32, &before, &parts, &mut out);
        before = parts;
    }
}

fn components(pack: &Pack, frames: &mut Frames) {
    hold::<Components<ROWS, 64>>(pack, frames, |state, frames| controls!(state, frames));
    let Ok(model) = Components::<ROWS, 64>::load(pack) else { return };
    let (mut state, mut frame) = (ComponentsState::new(), Frame::new());
    for step in 0..STEPS {
        if step % 10 == 0 {
            controls!(state, frames);
        }
        model.step_stored(&mut state, &mut frame);
    }
}

fn emotion(pack: &Pack, frames: &mut Frames) {
    hold::<Emotion<ROWS, 32, 64>>(pack, frames, |state, frames| {
        state.strength = std::array::from_fn(|_| frames.control());
    });
    let Ok(model) = Emotion::<ROWS, 32, 64>::load(pack) else { return };
    let mut state = Box::new(EmotionState::<ROWS, 32>::new());
    let mut frame = Frame::new();
    for step in 0..STEPS {
        if step % 10 == 0 {
            state.strength = std::array::from_fn(|_| frames.control());
        }
        match frames.next() % 32 {
            0 => model.restart(&mut state),
            1 => state.put(Place::default()),
            2 => model.change(&mut state),
            _ => {}
        }
        model.step(&mut state, frames.control(), &mut frame);
        let mut motion = [0.0; 1024];
        model.motion(&state.strength, &mut motion);
    }
}

fn face(pack: &Pack, frames: &mut Frames) {
    let Ok(model) = FaceSynth::<64>::load(pack) else { return };
    let mut state = FaceState::new();
    let mut offsets = [[0.0; 2]; POINTS];
    for _ in 0..STEPS {
        state.change = frames.control();
        let odd = frames.next().is_multiple_of(8);
        let mut number = || if odd { frames.control() } else { 100.0 * frames.unit() };
        let landmarks = [(); POINTS].map(|()| [number(), number()]);
        model.step(&mut state, &landmarks, &mut offsets);
        model.read(&landmarks);
        model.shape((frames.next() % 16) as usize, frames.control());
    }
}

/// Whatever goes in, what comes out is within the table's ranges.
fn limit(pack: &Pack, frames: &mut Frames) {
    hold::<Limiter<ROWS>>(pack, frames, |_, _| ());
    let Ok(model) = Limiter::<ROWS>::load(pack) else { return };
    let mut state = LimitState::new();
    model.start(&mut state, &frames.frame());
    for _ in 0..STEPS {
        let mut frame = frames.frame();
        model.step(&mut state, &mut frame);
        let table = model.table();
        let ranges = table.lower.as_flattened().iter().zip(table.upper.as_flattened());
        for (index, ((lower, upper), rate)) in ranges.zip(table.velocity.as_flattened()).enumerate() {
            // Travel and what a row does not use have no rate.
            assert!(*rate == 0.0 || (lower..=upper).contains(&&frame.coordinates()[index]), "{index}: {frame:?}");
        }
    }
}
