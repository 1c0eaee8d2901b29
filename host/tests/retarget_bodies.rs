//! Real motions of every skeleton in the data on every other one: limbs point where they did, feet stay on the floor, shoulders keep
//! their width. `--nocapture` prints the table; `KINESIC_BVH=FOLDER` writes what was made.

mod bodies;
mod real;

use std::path::PathBuf;

use bodies::{Measured, hinge, measure, share};
use kinesic_host::clip::{Canonical, ReadOptions};
use kinesic_host::prepare::Source;

/// Skeleton, and clips of it: a walk and something with arms or jumps. The first is also the rig.
const BODIES: [(&str, &[&str]); 10] = [
    ("xia", &["xia/neutral_01_000.bvh", "xia/childlike_16_000.bvh", "xia/proud_13_000.bvh"]),
    ("cmu31", &["cmu31/07_01.bvh", "cmu31/05_02.bvh", "cmu31/13_11.bvh"]),
    ("cmu31b", &["cmu31/49_01.bvh", "cmu31/49_09.bvh"]),
    ("cmu24cc", &["cmu24cc/06_08.bvh", "cmu24cc/06_12.bvh"]),
    ("cmu43daz", &["cmu43daz/09_01.bvh", "cmu43daz/13_10.bvh", "cmu43daz/14_07.bvh"]),
    ("bandai1", &["bandai1/walk_normal_001.bvh", "bandai1/bye_active_001.bvh", "bandai1/dance-short_normal_001.bvh"]),
    ("bandai2", &["bandai2/walk_normal_001.bvh", "bandai2/raise-up-both-hands_active_001.bvh"]),
    (
        "aalto",
        &["aalto/k_limp_angry_k_limp_sad_025_075.bvh", "aalto/k_limp_regular_k_limp_fast_k_limp_angry_100_000_000.bvh"],
    ),
    ("m21", &["m21/style/STRUTTING-1.bvh", "m21/content/jumping-jack.bvh", "m21/content/box-1.bvh"]),
    ("kindergator", &["kindergator/adult/p565_Fly-like-a-bird.csv", "kindergator/adult/p565_Do-two-jumping-jacks.csv"]),
];
/// The first of them have CMU's hips: the spine turns in the pelvis.
const CMU: usize = 3;

#[test]
fn every_body_on_every_other() {
    let Some(folder) = real::data("retarget_bodies") else { return };
    let sources: Vec<Vec<Source>> = BODIES
        .iter()
        .map(|(_, clips)| {
            let read = |name: &&str| {
                let mut source = Source::read(&folder.join(name), &ReadOptions::default()).unwrap();
                source.clip = source.clip.resample(30.0).unwrap().slice(0..240);
                source
            };
            clips.iter().map(read).collect()
        })
        .collect();
    let out = std::env::var_os("KINESIC_BVH").map(PathBuf::from);
    let mut all: Vec<(usize, usize, usize, Measured, f64)> = Vec::new();
    for to in 0..BODIES.len() {
        let own = &sources[to][0];
        let rig = own.rig().unwrap();
        let [l, r] = [Canonical::LShoulder, Canonical::RShoulder].map(|s| rig.map.joint(s).unwrap());
        let widths = (0..own.clip.frames()).map(|f| own.clip.positions(f)).map(|p| (p[l] - p[r]).norm());
        let native = share(widths.collect(), 0.5);
        for from in (0..BODIES.len()).filter(|from| *from != to) {
            for (at, source) in sources[from].iter().enumerate() {
                let (moved, measured) = measure(&source.clip, &source.map, &rig);
                if let Some(out) = &out {
                    let stem = source.path.file_stem().unwrap().to_string_lossy().into_owned();
                    moved.write_bvh(out.join(format!("{}-on-{}-{stem}.bvh", BODIES[from].0, BODIES[to].0))).unwrap();
                }
                all.push((from, to, at, measured, native));
            }
        }
    }
    print(&all);
    for (from, to, at, measured, native) in &all {
        let pair = format!("{} {at} on {}", BODIES[*from].0, BODIES[*to].0);
        // CMU's spine turns in the pelvis and its neck in the chest. Where the rig has one bone for both, these two bones cannot follow.
        let rigid = *from < CMU && *to >= CMU;
        // A Kinect's shoulders and head are on one joint: where the head leans to a side and the shoulders do not, it goes with them.
        let kinect = BODIES[*to].0 == "kindergator";
        for (class, _, _, most) in &measured.limbs {
            let bound = match *class {
                "lower spine" | "chest-neck" if rigid => 30.0,
                "lower spine" | "chest-neck" => 2.0,
                "neck" if kinect => 25.0,
                "hips' line" => 2.1,
                "shoulders' line" => 4.0,
                _ => 0.1,
            };
            assert!(*most < bound, "{pair}: {class} {most} degrees off");
        }
        // One recording of a Kinect has feet that point steeply down for a second: the whole clip is not lifted for them.
        let deep = if BODIES[*from].0 == "kindergator" { 0.065 } else { 0.01 };
        assert!(measured.under[0] < deep, "{pair}: {} m under the floor", measured.under[0]);
        assert!(measured.standing[0].abs() < 0.05, "{pair}: stands {} m above the floor", measured.standing[0]);
        let width = measured.shoulders[1] / native;
        assert!((0.87..1.12).contains(&width), "{pair}: shoulders {width} of the rig's");
        // No flips: nothing turns much faster than in the clip.
        let [fastest, own] = measured.fastest;
        assert!(fastest < 1.2 * own + 6.0, "{pair}: {fastest} degrees a frame, {own} in the clip");
    }
}

/// Legs are twisted about themselves as the rig's own motions twist them: knees bend about the same axes. The clips' rest poses say
/// nothing of that, the recordings do. (Elbows turn about the forearm as well, so that they have no axis to compare.)
#[test]
fn knees_bend_about_the_axes_of_the_rig() {
    let Some(folder) = real::data("retarget_bodies") else { return };
    let read = |name: &str| Source::read(&folder.join(name), &ReadOptions::default()).unwrap();
    let limbs = [Canonical::LKnee, Canonical::RKnee];
    let axes = |source: &Source| limbs.map(|j| hinge(&source.clip, source.map.joint(j).unwrap()));
    let from = ["bandai1/walk_normal_001.bvh", "bandai2/walk_normal_001.bvh", "cmu24cc/06_12.bvh"].map(read);
    for to in ["xia/neutral_01_000.bvh", "cmu31/07_01.bvh", "cmu43daz/14_07.bvh"].map(read) {
        let (rig, native) = (to.rig().unwrap(), axes(&to));
        for source in &from {
            let clip = source.on_rig(&rig, 30.0).unwrap();
            let found = axes(&Source::new("moved", clip, rig.map.clone()));
            for ((limb, a), b) in limbs.iter().zip(native).zip(found) {
                let Some(apart) = a.zip(b).map(|(a, b)| a.angle(&b).to_degrees()) else { continue };
                assert!(apart < 20.0, "{} on {}: {limb:?} {apart}", source.name(), to.name());
            }
        }
    }
}

fn print(all: &[(usize, usize, usize, Measured, f64)]) {
    println!(
        "pair: worst limbs of the pair (95 %, max) | under floor, source's | standing median, 90 % | shoulders / native | fastest"
    );
    for (from, to, at, m, native) in all {
        let mut limbs = m.limbs.clone();
        limbs.sort_by(|a, b| b.3.total_cmp(&a.3));
        let limbs: Vec<String> = limbs.iter().take(4).map(|l| format!("{} {:.1} {:.1}", l.0, l.2, l.3)).collect();
        println!(
            "{:>11} {at} -> {:<9} {:<60} | {:5.1} {:4.1} | {:5.1} {:5.1} | {:.2} {:.2} {:.2} ({:.2} {:.2}) | {:5.1} {:5.1}",
            BODIES[*from].0,
            BODIES[*to].0,
            limbs.join(", "),
            100.0 * m.under[0],
            100.0 * m.under[1],
            100.0 * m.standing[0],
            100.0 * m.standing[1],
            m.shoulders[0] / native,
            m.shoulders[1] / native,
            m.shoulders[2] / native,
            m.breathing[0],
            m.breathing[1],
            m.fastest[0],
            m.fastest[1],
        );
    }
    println!("class: mean of means, worst mean, worst 95 %, worst max, over {} motions", all.len());
    let classes = bodies::LIMBS.iter().map(|l| l.0).chain(bodies::TIPS.iter().map(|t| t.0));
    for class in classes {
        let rows: Vec<_> = all.iter().flat_map(|a| a.3.limbs.iter().filter(|l| l.0 == class)).collect();
        let worst = |values: Vec<f64>| values.into_iter().fold(0.0, f64::max);
        let mean = rows.iter().map(|r| r.1).sum::<f64>() / rows.len() as f64;
        let a = worst(rows.iter().map(|r| r.1).collect());
        let b = worst(rows.iter().map(|r| r.2).collect());
        let c = worst(rows.iter().map(|r| r.3).collect());
        println!("{class:<12} {mean:6.2} {a:6.2} {b:6.2} {c:6.2}  ({})", rows.len());
    }
    let under = |at: f64| 100.0 * share(all.iter().map(|a| a.3.under[0]).collect(), at);
    println!("under the floor, cm: median {:.1}, 90 % {:.1}, worst {:.1}", under(0.5), under(0.9), under(1.0));
    let standing = |k: usize, at: f64| 100.0 * share(all.iter().map(|a| a.3.standing[k]).collect(), at);
    println!(
        "standing, cm: medians {:.1} to {:.1}; 90 % {:.1} to {:.1}",
        standing(0, 0.0),
        standing(0, 1.0),
        standing(1, 0.0),
        standing(1, 1.0)
    );
    let wide = |at: f64| share(all.iter().map(|a| a.3.shoulders[1] / a.4).collect(), at);
    println!("shoulders' width, of the rig's own: {:.2} to {:.2}", wide(0.0), wide(1.0));
}
