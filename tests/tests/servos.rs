//! Machines learned from the angles of their servos as they are: no hips, no markers, no rotations.

#[path = "common/servos.rs"]
mod servos;

use faer::Mat;
use kinesic::{Components, ComponentsState, Frame, Pipeline, PipelineState, Translator};
use kinesic_host::components::{ComponentsModel, Factors};
use kinesic_host::pack::{PackFile, Provenance};
use kinesic_host::translate::{Alignment, TrainOptions, TrainPair, train};
use servos::{FPS, Machine, Take, antennas, head, lamp};

type Device<'a> = Pipeline<'a, Translator<'a, 2, 256>, 2>;

/// Root of the mean square of each servo's error, degrees, after the first second.
fn errors(found: &[Vec<f64>], wanted: &[Vec<f64>]) -> Vec<f64> {
    let from = FPS as usize;
    let servo = |index: usize| {
        let rows = found.iter().zip(wanted).skip(from);
        let square: f64 = rows.map(|(a, b)| (a[index] - b[index]).powi(2)).sum();
        (square / (found.len() - from) as f64).sqrt().to_degrees()
    };
    (0..wanted[0].len()).map(servo).collect()
}

/// The calm motion moved by what the manners differ by on average in a training take.
fn mean_offset(calm: &[Vec<f64>], training: &[Take]) -> Vec<Vec<f64>> {
    let mean = |take: &dyn Fn(&Take) -> f64| training.iter().map(take).sum::<f64>() / training.len() as f64;
    let average = |rows: &[Vec<f64>], servo: usize| rows.iter().map(|row| row[servo]).sum::<f64>() / rows.len() as f64;
    let offset: Vec<f64> =
        (0..calm[0].len()).map(|servo| mean(&|[calm, lively]| average(lively, servo) - average(calm, servo))).collect();
    calm.iter().map(|row| row.iter().zip(&offset).map(|(x, offset)| x + offset).collect()).collect()
}

/// Trains on takes, plays an unseen one through the device's code, servo angles in and out.
fn learned(machine: &Machine, takes: u64) {
    let rig = machine.rig();
    let training: Vec<_> = (1..=takes).map(|seed| machine.take(seed, 40.0)).collect();
    let pair = |[calm, lively]: &Take| TrainPair {
        source_name: "calm".into(),
        target_name: "lively".into(),
        source: machine.locals(&rig, calm),
        target: machine.locals(&rig, lively),
    };
    let pairs: Vec<TrainPair> = training.iter().map(pair).collect();
    let trained = train(&rig, &pairs, "lively", FPS, &TrainOptions::default(), &|_| {}).unwrap();
    let file = PackFile::from_bytes(&trained.model.pack(&rig, &Provenance::default()));
    let pack = file.pack().unwrap();
    let device = Device::load(&pack).unwrap();
    let mut state = PipelineState::new();

    let [calm, lively] = machine.take(77, 30.0);
    let mut servos = vec![0.0; machine.servos.len()];
    let play = |row: &Vec<f64>| -> Vec<f64> {
        let told: Vec<f32> = row.iter().map(|x| *x as f32).collect();
        device.step_coordinates(&mut state, Some(&told), &mut servos);
        servos.iter().map(|x| f64::from(*x)).collect()
    };
    let played: Vec<Vec<f64>> = calm.iter().map(play).collect();
    let [found, nothing, offset] =
        [&played, &calm, &mean_offset(&calm, &training)].map(|motion| errors(motion, &lively));
    println!("{}, {takes} takes of 40 s: {:?}", machine.name, trained.candidate.0);
    for (servo, ((found, nothing), offset)) in machine.servos.iter().zip(found.iter().zip(&nothing).zip(&offset)) {
        println!("  {}: {found:.2} degrees rms, doing nothing {nothing:.2}, mean offset {offset:.2}", servo.name);
    }
    for (servo, ((found, nothing), offset)) in machine.servos.iter().zip(found.iter().zip(&nothing).zip(&offset)) {
        assert!(*found < 1.5, "{}: {found} degrees", servo.name);
        assert!(found < nothing && found < offset, "{}: {found}, {nothing}, {offset}", servo.name);
    }
}

#[test]
fn a_pan_tilt_head_is_learned_from_its_angles() {
    learned(&head(), 1);
}

#[test]
fn a_lamp_is_learned_from_its_angles() {
    learned(&lamp(), 2);
}

#[test]
fn a_head_with_antennas_is_learned_from_its_angles() {
    learned(&antennas(), 2);
}

#[test]
fn a_machine_whose_clips_drift_apart_is_warped() {
    let machine = head();
    let rig = machine.rig();
    let [calm, lively] = machine.take(1, 40.0);
    let frames = lively.len() as f64;
    // Early by up to a second and late by as much, in turn.
    let moved = |at: usize| at as f64 + FPS * (4.0 * core::f64::consts::PI * at as f64 / frames).sin();
    let drifting: Vec<Vec<f64>> = (0..lively.len())
        .map(|at| lively[(moved(at).round().max(0.0) as usize).min(lively.len() - 1)].clone())
        .collect();
    let pair = TrainPair {
        source_name: "calm".into(),
        target_name: "lively".into(),
        source: machine.locals(&rig, &calm),
        target: machine.locals(&rig, &drifting),
    };
    let trained = train(&rig, &[pair], "lively", FPS, &TrainOptions::default(), &|_| {}).unwrap();
    assert_eq!(trained.alignment, Alignment::Warp, "{:?}", trained.alignments);
}

#[test]
fn a_stored_path_is_not_followed_by_a_machine_that_stands() {
    let rig = head().rig();
    let model = ComponentsModel {
        style: "made".into(),
        frame_rate: FPS,
        mean: vec![0.25, -0.5, 0.0],
        shift: vec![0.0; 3],
        scale: vec![1.0; 3],
        learned: Mat::from_fn(3, 1, |row, _| [1.0, 0.5, 0.0][row]),
        content: Factors {
            weights: Mat::from_fn(2, 1, |frame, _| frame as f64),
            components: Mat::from_fn(3, 1, |row, _| [1.0, 0.5, 0.0][row]),
        },
        track: vec![[9.0, 7.0, 0.6, 0.8]; 2],
        strength: [0.0, 1.0],
    };
    let file = PackFile::from_bytes(&model.pack(&rig, &Provenance::default()));
    let components = Components::<1, 1>::load(&file.pack().unwrap()).unwrap();
    let (mut state, mut frame) = (ComponentsState::new(), Frame::new());
    for wanted in [[0.25, -0.5, 0.0], [1.25, 0.0, 0.0], [0.25, -0.5, 0.0]] {
        components.step_stored(&mut state, &mut frame);
        assert_eq!(frame, Frame::from_coordinates(&wanted));
    }
}
