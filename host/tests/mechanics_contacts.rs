//! Foot contacts of the device's code beside an independent, non-causal reference in f64, flat, tilted and stepped.

mod mechanics_common;
mod real;

use kinesic::mechanics::{DynamicFeatures, FeatureState};
use kinesic_host::clip::{Canonical, Clip};
use kinesic_host::mechanics::{body, measured};
use kinesic_host::rig::{MAX_JOINTS, Rig};
use mechanics_common::on_rig;
use nalgebra::{UnitQuaternion, Vector3};

/// Walking, running, jumping, dancing, hopping, standing.
const CLIPS: [&str; 8] = [
    "cmu31/07_01.bvh",
    "cmu31/08_04.bvh",
    "cmu31/26_01.bvh",
    "cmu31/35_05.bvh",
    "cmu31/35_19.bvh",
    "cmu31/cmuc_jumping_118_481.bvh",
    "cmu31/05_02.bvh",
    "cmu31/49_02.bvh",
];

/// Both feet, `[left, right]`, one a frame.
fn streamed(rig: &Rig, clip: &Clip, frame_rate: f32, calibrated: &[&Clip]) -> Vec<[bool; 2]> {
    let body = measured(&body(rig).unwrap(), calibrated);
    let features = DynamicFeatures::new(rig.device(), &body, frame_rate).unwrap();
    let mut state = FeatureState::<MAX_JOINTS, 40>::new();
    let step = |pose| {
        features.step(&mut state, pose);
        state.contacts().stands
    };
    rig.poses(clip).iter().map(step).collect()
}

/// The whole clip at once, past and future: central differences over five frames, heights over the point's own lowest position
/// within three quarters of a second to either side (the floors of these recordings are not level: the same foot stands up to
/// 4 cm higher some steps later), a median over seven frames. Shares no code and no threshold with the device.
fn reference(rig: &Rig, clip: &Clip) -> Vec<[bool; 2]> {
    let feet = [[Canonical::LAnkle, Canonical::LToe], [Canonical::RAnkle, Canonical::RToe]];
    let frames = clip.frames();
    let positions: Vec<Vec<Vector3<f64>>> = (0..frames).map(|f| clip.positions(f)).collect();
    let mut stands = vec![[false; 2]; frames];
    for (side, foot) in feet.iter().enumerate() {
        let mut raw = vec![false; frames];
        for joint in foot.iter().filter_map(|c| rig.map.joint(*c)) {
            for (frame, raw) in raw.iter_mut().enumerate() {
                let around = &positions[frame.saturating_sub(45)..(frame + 46).min(frames)];
                let floor = around.iter().map(|p| p[joint].y).fold(f64::MAX, f64::min);
                let (a, b) = (frame.saturating_sub(2), (frame + 2).min(frames - 1));
                let speed = (positions[b][joint] - positions[a][joint]).norm() / ((b - a) as f64 * clip.frame_time);
                *raw |= speed < 0.75 && positions[frame][joint].y - floor < 0.045;
            }
        }
        for frame in 0..frames {
            let near = &raw[frame.saturating_sub(3)..(frame + 4).min(frames)];
            stands[frame][side] = 2 * near.iter().filter(|r| **r).count() > near.len();
        }
    }
    stands
}

struct Score {
    right: usize,
    found: usize,
    wanted: usize,
    flicker: usize,
}

impl Score {
    fn of(found: &[[bool; 2]], wanted: &[[bool; 2]]) -> Self {
        let mut score = Score { right: 0, found: 0, wanted: 0, flicker: 0 };
        for side in 0..2 {
            let mut since = 0;
            for frame in 0..found.len() {
                let (f, w) = (found[frame][side], wanted[frame][side]);
                score.right += usize::from(f && w);
                score.found += usize::from(f);
                score.wanted += usize::from(w);
                since += 1;
                if frame > 0 && f != found[frame - 1][side] {
                    score.flicker += usize::from(since < 3);
                    since = 0;
                }
            }
        }
        score
    }

    fn precision(&self) -> f64 {
        self.right as f64 / self.found.max(1) as f64
    }

    fn recall(&self) -> f64 {
        self.right as f64 / self.wanted.max(1) as f64
    }
}

/// The ground tilted by 5 degrees under the whole scene, about an axis square to neither path.
fn tilted(clip: &Clip) -> Clip {
    let turn = UnitQuaternion::from_scaled_axis(Vector3::new(0.7, 0.0, 0.7).normalize() * 5f64.to_radians());
    let joints = clip.skeleton.len();
    let mut clip = clip.clone();
    clip.root.iter_mut().for_each(|p| *p = turn * *p);
    clip.rotations.iter_mut().step_by(joints).for_each(|q| *q = turn * *q);
    clip
}

/// 0.2 m up, at once, in the middle of the clip: the floor of another room.
fn stepped(clip: &Clip) -> Clip {
    let mut clip = clip.clone();
    let half = clip.frames() / 2;
    clip.root.iter_mut().skip(half).for_each(|p| p.y += 0.2);
    clip
}

#[test]
fn precision_and_recall_on_real_clips() {
    let Some(folder) = real::data("mechanics_contacts") else { return };
    let (rig, clips) = on_rig(&folder, &CLIPS);
    let calibrated: Vec<&Clip> = clips.iter().take(4).collect();
    println!("{:34} {:>22} {:>22} {:>22}", "precision, recall, flicker", "flat", "tilted 5 deg", "stepped 0.2 m");
    let mut sums = [[0.0; 2]; 3];
    for (name, clip) in CLIPS.iter().zip(&clips) {
        let wanted = reference(&rig, clip);
        let scores = [clip.clone(), tilted(clip), stepped(clip)]
            .map(|clip| Score::of(&streamed(&rig, &clip, clip.fps() as f32, &calibrated), &wanted));
        print!("{name:34}");
        for (score, sum) in scores.iter().zip(&mut sums) {
            print!(" {:>8.3} {:>8.3} {:>4}", score.precision(), score.recall(), score.flicker);
            sum[0] += score.precision() / CLIPS.len() as f64;
            sum[1] += score.recall() / CLIPS.len() as f64;
        }
        println!();
    }
    println!("mean: {sums:.3?}");
    for [precision, recall] in sums {
        assert!(precision > 0.85 && recall > 0.85, "{precision} {recall}");
    }
}

#[test]
fn standing_still_gives_two_steady_contacts() {
    let Some(folder) = real::data("mechanics_contacts") else { return };
    // Three seconds of one pose of a walk's double support, with a millimetre of noise as from a camera.
    let (rig, clips) = on_rig(&folder, &["cmu31/35_05.bvh"]);
    let clip = &clips[0];
    let both = reference(&rig, clip).iter().position(|s| *s == [true; 2]).expect("a frame of double support");
    let joints = clip.skeleton.len();
    let mut still = clip.slice(both..both + 1);
    let (mut seed, frames) = (7u64, 180);
    let mut noise = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((seed >> 40) as f64 / f64::from(1 << 23) - 1.0) * 1e-3
    };
    still.root = (0..frames).map(|_| still.root[0] + Vector3::new(noise(), noise(), noise())).collect();
    still.rotations = still.rotations[..joints].repeat(frames);
    let found = streamed(&rig, &still, 60.0, &[clip]);
    assert!(found.iter().all(|stands| *stands == [true; 2]), "{found:?}");
}
