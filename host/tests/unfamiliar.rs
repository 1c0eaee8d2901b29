//! What a walk taught, on what is no walk: real clips, and motions that are made.

mod real;

use kinesic::engine::Controls;
use kinesic_host::clip::{Clip, ReadOptions};
use kinesic_host::feet::{Hold, lock};
use kinesic_host::gait::{self, Manner, walk};
use kinesic_host::pack::{PackFile, Provenance};
use kinesic_host::prepare::Source;
use kinesic_host::rig::Rig;
use kinesic_host::translate::{Played, Settings, TrainOptions, TrainPair, Trained, play_on_clock, train};
use nalgebra::UnitQuaternion;

const FPS: f64 = 60.0;

/// A pack from pairs of clips on one rig.
fn learned(rig: &Rig, pairs: &[[&Clip; 2]], options: &TrainOptions) -> (Rig, Trained, PackFile) {
    let poses: Vec<_> = pairs.as_flattened().iter().map(|clip| rig.poses(clip)).collect();
    let rig = rig.centred(&poses.iter().map(Vec::as_slice).collect::<Vec<_>>());
    let pair = |(index, [source, target]): (usize, &[&Clip; 2])| TrainPair {
        source_name: format!("source{index}"),
        target_name: format!("target{index}"),
        source: rig.locals_of(source),
        target: rig.locals_of(target),
    };
    let pairs: Vec<TrainPair> = pairs.iter().enumerate().map(pair).collect();
    let trained = train(&rig, &pairs, "style", FPS, options, &|_| {}).unwrap();
    let file = PackFile::from_bytes(&trained.model.pack(&rig, &Provenance::default()));
    (rig, trained, file)
}

fn played(file: &PackFile, rig: &Rig, clip: &Clip, settings: &Settings) -> Played {
    play_on_clock(&file.pack().unwrap(), rig, clip, settings).unwrap()
}

fn made_rig() -> Rig {
    let skeleton = gait::skeleton();
    let map = kinesic_host::clip::JointMap::detect(&skeleton).unwrap();
    Rig::new(&skeleton, &map).unwrap()
}

/// Standing, the right arm waving from the shoulder; `lift` is how high.
fn wave_of(lift: f64) -> Clip {
    let mut clip = walk(&Manner { stride: 0.0, knee: 0.0, arms: 0.0, sway: 0.0, ..Manner::NEUTRAL }, 4.0, FPS, 0.0, 3);
    let joints = clip.skeleton.len();
    let arm = clip.skeleton.find("RightArm").unwrap();
    let root = clip.root[0];
    for frame in 0..clip.frames() {
        clip.root[frame] = root;
        let turn = lift + 0.5 * (frame as f64 / FPS * 9.0).sin();
        clip.rotations[frame * joints + arm] = UnitQuaternion::from_euler_angles(0.0, 0.0, -turn);
    }
    clip
}

#[test]
fn another_walk_is_familiar_and_a_wave_is_not() {
    let [neutral, weary] = [(Manner::NEUTRAL, 4.0), (Manner::WEARY, 5.3)].map(|(m, s)| walk(&m, s, FPS, 0.0, 1));
    let (rig, _, file) = learned(&made_rig(), &[[&neutral, &weary]], &TrainOptions::default());
    let other = walk(&Manner { cadence: 1.0, stride: 0.38, arms: 0.5, ..Manner::NEUTRAL }, 4.0, FPS, 1.0, 5);
    let walked = played(&file, &rig, &other, &Settings::default());
    assert_eq!(walked.unfamiliar_percent(), Some(0.0));
    // A live stream has not seen the walk before it begins: the style comes within the first second.
    let live = played(&file, &rig, &other, &Settings { live: true, ..Settings::default() });
    let familiar = live.familiar.as_ref().unwrap();
    assert!(familiar[0] < 0.5 && familiar[60..].iter().all(|familiar| *familiar > 0.9), "{familiar:?}");
    let whole = walked.familiar.as_ref().unwrap();
    assert!(whole.iter().zip(familiar).skip(150).all(|(a, b)| (a - b).abs() < 0.02));
    let wave = wave_of(2.2);
    let waved = played(&file, &rig, &wave, &Settings::default());
    assert!(waved.unfamiliar_percent().unwrap() > 99.0, "{:?}", waved.unfamiliar_percent());
    let travel = |clip: &Clip| (clip.root[clip.frames() - 1] - clip.root[0]).xz().norm();
    assert!(travel(&waved.clip) < 0.02, "{}", travel(&waved.clip));
    let all = played(&file, &rig, &wave, &Settings { fade: false, ..Settings::default() });
    assert!(travel(&all.clip) > 0.2 && all.familiar == waved.familiar, "{}", travel(&all.clip));
    // Half of the mean change of posture stays: the body stoops.
    let chest = rig.skeleton.find("Spine").unwrap();
    let turned = |clip: &Clip| clip.pose(120)[chest].angle_to(&wave.pose(120)[chest]);
    assert!((0.05..0.3).contains(&turned(&waved.clip)), "{}", turned(&waved.clip));
    // Strength 0 is the clip whatever is familiar.
    let none = Settings { controls: Controls { strength: 0.0, ..Controls::default() }, ..Settings::default() };
    let same = played(&file, &rig, &wave, &none).clip;
    let far = same.rotations.iter().zip(&wave.rotations).map(|(a, b)| a.angle_to(b)).fold(0.0, f64::max);
    assert!(far < 1e-5, "{far}");
}

#[test]
fn a_pack_without_a_gate_makes_what_one_with_a_gate_makes_that_never_fades() {
    let [neutral, weary] = [(Manner::NEUTRAL, 3.0), (Manner::WEARY, 4.0)].map(|(m, s)| walk(&m, s, FPS, 0.0, 1));
    let pair = [[&neutral, &weary]];
    let (rig, _, gated) = learned(&made_rig(), &pair, &TrainOptions::default());
    let (_, _, plain) = learned(&made_rig(), &pair, &TrainOptions { gate: false, ..TrainOptions::default() });
    let never = Settings { fade: false, ..Settings::default() };
    let [a, b] = [&gated, &plain].map(|file| played(file, &rig, &neutral, &never));
    assert!(a.clip.rotations == b.clip.rotations && a.clip.root == b.clip.root && b.familiar.is_none());
    assert!(gated.bytes().len() > plain.bytes().len());
}

#[test]
fn the_device_sees_what_the_training_saw() {
    let [neutral, weary] = [(Manner::NEUTRAL, 4.0), (Manner::WEARY, 5.3)].map(|(m, s)| walk(&m, s, FPS, 0.0, 1));
    let (rig, trained, file) = learned(&made_rig(), &[[&neutral, &weary]], &TrainOptions::default());
    let gate = trained.model.gate.as_ref().unwrap();
    for clip in [&neutral, &wave_of(0.6)] {
        let rows = rig.locals_of(clip).coordinates;
        let (mean, scale) = (&trained.model.mean, &trained.model.inverse_deviation);
        let input = faer::Mat::from_fn(rows.len() / mean.len(), mean.len(), |t, c| {
            (rows[t * mean.len() + c] - mean[c]) * scale[c]
        });
        let novelty = gate.look(&input);
        let familiar = played(&file, &rig, clip, &Settings::default()).familiar.unwrap();
        // Novelty is smoothed on the device, and what came before a clip is not the same: compare where both are settled.
        let mut smooth = novelty[30].distance;
        for (frame, familiar) in familiar.iter().enumerate().skip(30) {
            smooth += gate.rates[2] * (novelty[frame].distance - smooth);
            let expected = 1.0 / (1.0 + (smooth * gate.rates[3]).powi(8));
            assert!(frame < 120 || (expected - f64::from(*familiar)).abs() < 0.02, "{frame}: {expected} {familiar}");
        }
    }
}

#[test]
fn one_pack_learns_two_actions_that_contradict_each_other() {
    let walks = [(Manner::NEUTRAL, 4.0), (Manner::WEARY, 5.3)].map(|(m, s)| walk(&m, s, FPS, 0.0, 1));
    // Walking, the style stoops and shortens; waving, it lifts the arm.
    let waves = [wave_of(0.6), wave_of(1.6)];
    let pairs = [[&walks[0], &walks[1]], [&waves[0], &waves[1]]];
    let (rig, trained, file) = learned(&made_rig(), &pairs, &TrainOptions::default());
    assert_eq!(trained.alignment, kinesic_host::translate::Alignment::Each);
    assert!(trained.candidate.0.experts, "{:?}", trained.candidate);
    for [source, target] in pairs {
        let out = played(&file, &rig, source, &Settings::default());
        assert!(out.unfamiliar_percent().unwrap() < 5.0);
        let arm = rig.skeleton.find("RightArm").unwrap();
        let mean = |clip: &Clip| {
            let frames = 60..clip.frames();
            let turn = |frame: usize| (clip.pose(frame)[arm] * nalgebra::Vector3::new(0.0, -1.0, 0.0)).y;
            frames.clone().map(turn).sum::<f64>() / frames.len() as f64
        };
        let [from, to, got] = [source, target, &out.clip].map(mean);
        assert!((got - to).abs() < 0.1 + 0.2 * (from - to).abs(), "{from} -> {to}: {got}");
    }
}

/// Two of xia's styles, learned from a walk, on a boxer, a wave and a walk played backwards; and on another person's walk.
#[test]
fn walks_leave_real_boxing_waving_and_walking_backwards_alone() {
    let Some(data) = real::data("walks_leave_real_boxing_waving_and_walking_backwards_alone") else { return };
    let read = |path: &str| Source::read(&data.join(path), &ReadOptions::default()).unwrap();
    let rig = read("xia/neutral_01_000.bvh").rig().unwrap();
    let on_rig = |path: &str| read(path).on_rig(&rig, FPS).unwrap();
    for style in ["angry", "depressed"] {
        let [neutral, styled] = ["neutral", style].map(|style| on_rig(&format!("xia/{style}_01_000.bvh")));
        let (rig, _, file) = learned(&rig, &[[&neutral, &styled]], &TrainOptions::default());
        let percent = |clip: &Clip| played(&file, &rig, clip, &Settings::default()).unfamiliar_percent().unwrap();
        let mut walk = on_rig("cmu31/07_01.bvh");
        assert!(percent(&walk) < 1.0, "{style}: {}", percent(&walk));
        assert!(percent(&on_rig("bandai1/walk_normal_001.bvh")) < 1.0);
        let joints = walk.skeleton.len();
        walk.root.reverse();
        walk.rotations = walk.rotations.chunks_exact(joints).rev().flatten().copied().collect();
        for clip in
            [walk, on_rig("bandai2/wave-left-hand_normal_001.bvh"), on_rig("m21/content/box-1.bvh").slice(0..900)]
        {
            assert!(percent(&clip) > 60.0, "{style}: {}", percent(&clip));
        }
        // The boxer takes steps that look familiar, one at a time: none of them carries him away, and neither do feet that are held.
        let boxer = on_rig("m21/content/box-1.bvh");
        let out = played(&file, &rig, &boxer, &Settings::default());
        let held =
            lock(&boxer, &out.clip, &rig.map, Hold { familiar: out.familiar.as_ref().unwrap(), ..Hold::default() });
        let travel = |clip: &Clip| (clip.root[clip.frames() - 1] - clip.root[0]).xz().norm();
        let [from, free, held] = [&boxer, &out.clip, &held].map(travel);
        assert!((free - from).abs() < 0.05 && (held - from).abs() < 0.1, "{style}: {from} {free} {held}");
    }
}
