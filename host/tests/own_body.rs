//! The result lands on the clip's own skeleton: at strength 0 it is the clip, at strength 1 its bones, joints and rate are the clip's.

mod real;

use kinesic::engine::Controls;
use kinesic_host::clip::{Canonical, Clip, ReadOptions};
use kinesic_host::feet;
use kinesic_host::models;
use kinesic_host::own_body::OwnBody;
use kinesic_host::prepare::Source;
use kinesic_host::rig::{MAX_JOINTS, Rig};
use kinesic_host::translate::{Settings, Timing, play};

/// Clips of nine skeletons: walks, and what is none.
const CLIPS: [&str; 20] = [
    "xia/neutral_01_000.bvh",
    "xia/angry_01_001.bvh",
    "cmu31/07_01.bvh",
    "cmu31/08_01.bvh",
    "cmu31/10_01.bvh",
    "cmu31/35_01.bvh",
    "m21/content/box-1.bvh",
    "m21/content/jumping-jack.bvh",
    "m21/style/DEPRESSED.bvh",
    "m21/style/OLD-1.bvh",
    "bandai2/wave-both-hands_normal_001.bvh",
    "bandai2/walk_normal_001.bvh",
    "kindergator/adult/p565_Fly-like-a-bird.csv",
    "kindergator/adult/p734_Jump.csv",
    "bandai1/walk_normal_001.bvh",
    "bandai1/bye_active_001.bvh",
    "cmu24cc/06_08.bvh",
    "cmu43daz/09_01.bvh",
    "cmu43daz/14_07.bvh",
    "aalto/k_limp_angry_k_limp_sad_025_075.bvh",
];

fn performed(source: &Source, strength: f32) -> Clip {
    masked(source, strength, 1.0)
}

/// With a weight of the root.
fn masked(source: &Source, strength: f32, root: f32) -> Clip {
    let file = models::weary();
    let pack = file.pack().unwrap();
    let rig = Rig::from_pack(&pack).unwrap();
    let before = source.on_rig(&rig, f64::from(pack.metadata().frame_rate)).unwrap();
    let mut weights = [1.0; MAX_JOINTS];
    weights[0] = root;
    let controls = Controls { strength, mask: rig.coordinate_weights(&weights) };
    let after =
        play(&pack, &rig, &before, &Settings { controls, timing: Timing::Keep, ..Settings::default() }).unwrap();
    let carried = OwnBody::new(source, &rig).carry(&before, &after);
    feet::lock(&source.clip, &carried, &source.map, feet::Hold { travels: f64::from(root), ..feet::Hold::default() })
}

#[test]
fn a_masked_root_keeps_its_path_and_tilt_and_held_feet_their_spots() {
    let Some(data) = real::data("own_body") else { return };
    for clip in ["xia/neutral_01_000.bvh", "bandai2/walk_normal_001.bvh", "cmu31/07_01.bvh", "m21/style/OLD-1.bvh"] {
        let source = Source::read(&data.join(clip), &ReadOptions::default()).unwrap();
        let (free, held) = (performed(&source, 1.0), masked(&source, 1.0, 0.0));
        let far = |a: &Clip| a.root.iter().zip(&source.clip.root).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
        let pelvis = source.map.joint(Canonical::Pelvis).unwrap();
        let tilts = (0..held.frames()).map(|frame| {
            let [is, was] = [&held, &source.clip].map(|clip| clip.skeleton.world_rotations(clip.pose(frame))[pelvis]);
            is.angle_to(&was).to_degrees()
        });
        let tilt = tilts.fold(0.0, f64::max);
        let (mut off, mut stood, mut swings) = (0.0, 0.0, 0.0f64);
        for foot in feet::Foot::of(&source.clip.skeleton, &source.map) {
            let (was, is) = (foot.path(&source.clip), foot.path(&held));
            let stands = feet::Foot::stands(&was, source.clip.fps(), foot.size(&source.clip.skeleton));
            for ((was, is), stands) in was.iter().zip(&is).zip(stands) {
                let way = 100.0 * (is - was).norm();
                if stands {
                    (off, stood) = (off + way, stood + 1.0);
                } else {
                    swings = swings.max(way);
                }
            }
        }
        off /= stood;
        let slide = |clip: &Clip| feet::Feet::of(clip, &source.map).slide_cm_s;
        println!(
            "{clip}: root {:.2} mm off ({:.0} unmasked), tilt {tilt:.4} degrees, standing feet {off:.2} cm off, feet in the air at most {swings:.1}; \
             slide {:.1} cm/s, the clip's {:.1}",
            1000.0 * far(&held),
            1000.0 * far(&free),
            slide(&held),
            slide(&source.clip)
        );
        assert!(far(&held) < 1e-4 && tilt < 1e-3, "{clip}");
        assert!(far(&free) > 0.02, "{clip}: the mask has nothing to keep");
        assert!(off < 2.0 && swings > 1.0, "{clip}: {off} {swings}");
        assert!(slide(&held) < 1.2 * slide(&source.clip) + 1.0, "{clip}");
    }
}

/// Distance of a joint of one clip from that of the other, at most, m.
fn farthest_joint(a: &Clip, b: &Clip) -> f64 {
    let (a, b) = (a.all_positions(), b.all_positions());
    a.iter().zip(&b).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max)
}

#[test]
fn at_strength_0_every_joint_is_where_it_was_and_at_1_bones_are_the_clip_s() {
    let mut farthest = 0.0f64;
    let Some(data) = real::data("own_body") else { return };
    for path in CLIPS.iter().map(|clip| data.join(clip)) {
        let source = Source::read(&path, &ReadOptions::default()).unwrap();
        let same = performed(&source, 0.0);
        assert_eq!(same.frames(), source.clip.frames(), "{}", path.display());
        assert!(same.skeleton == source.clip.skeleton && same.frame_time == source.clip.frame_time);
        let far = farthest_joint(&same, &source.clip);
        assert!(far < 1e-4, "{}: {far} m", path.display());
        farthest = farthest.max(far);
        let styled = performed(&source, 1.0);
        assert!(styled.skeleton == source.clip.skeleton && styled.frames() == source.clip.frames());
        assert!(farthest_joint(&styled, &source.clip) > 0.05, "{}: the style did nothing", path.display());
        assert!(styled.rotations.iter().all(|q| q.coords.iter().all(|x| x.is_finite())));
    }
    println!("farthest joint at strength 0: {:.4} mm", 1000.0 * farthest);
}
