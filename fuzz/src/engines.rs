//! Every engine, 100 frames. A new engine gets a function and a line in [`step_all`].

use kinesic::emotion::{Emotion, EmotionState, Place};
use kinesic::face::{FaceState, FaceSynth, POINTS};
use kinesic::limit::{LimitState, Limiter};
use kinesic::mechanics::{Blend, Decoupled, Modulation, Window, mix, modulate};
use kinesic::{BodyMechanics, Components, ComponentsState, MechanicsState, Pack, Pose, Translator, TranslatorState};

use super::frames::{Frames, JOINTS};

/// Frames that each engine steps.
const STEPS: usize = 100;

/// Steps every engine that takes the pack.
pub fn step_all(pack: &Pack, frames: &mut Frames) {
    translator(pack, frames);
    mechanics(pack, frames);
    components(pack, frames);
    face(pack, frames);
    emotion(pack, frames);
    limit(pack, frames);
}

fn translator(pack: &Pack, frames: &mut Frames) {
    let Ok(model) = Translator::<JOINTS, 1024>::load(pack) else { return };
    let mut state = Box::new(TranslatorState::new());
    let mut styled = Pose::identity();
    model.start(&mut state, &frames.pose());
    for step in 0..STEPS {
        if step % 10 == 0 {
            state.controls.strength = frames.control();
            state.controls.mask = std::array::from_fn(|_| frames.control());
        }
        model.step(&mut state, &frames.pose(), &mut styled);
    }
}

fn mechanics(pack: &Pack, frames: &mut Frames) {
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
    let Ok(model) = Components::<JOINTS, 64>::load(pack) else { return };
    let mut state = ComponentsState::new();
    let mut styled = Pose::identity();
    for step in 0..STEPS {
        if step % 10 == 0 {
            state.controls.strength = frames.control();
            state.controls.mask = std::array::from_fn(|_| frames.control());
        }
        model.step(&mut state, &frames.pose(), &mut styled);
        model.step_stored(&mut state, &mut styled);
    }
}

fn emotion(pack: &Pack, frames: &mut Frames) {
    let Ok(model) = Emotion::<JOINTS, 32, 64>::load(pack) else { return };
    let mut state = Box::new(EmotionState::<JOINTS, 32>::new());
    let mut pose = Pose::identity();
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
        model.step(&mut state, frames.control(), &mut pose);
        let mut motion = [0.0; 1024];
        model.motion(&state.strength, &mut motion);
        model.score(&motion);
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

/// Whatever goes in, what comes out is a pose, and within the table's ranges.
fn limit(pack: &Pack, frames: &mut Frames) {
    let Ok(model) = Limiter::<JOINTS>::load(pack) else { return };
    let mut state = LimitState::new();
    let mut out = Pose::identity();
    model.start(&mut state, &frames.pose());
    for _ in 0..STEPS {
        let pose = frames.pose();
        model.step(&mut state, (!frames.next().is_multiple_of(8)).then_some(&pose), &mut out);
        assert!(out.is_sound(model.joints()), "{out:?}");
        for (joint, (lower, upper)) in model.table().lower.iter().zip(model.table().upper).enumerate() {
            let ranges = lower.iter().zip(upper);
            assert!(state.angles(joint).iter().zip(ranges).all(|(x, (lower, upper))| (lower..=upper).contains(&x)));
        }
    }
}
