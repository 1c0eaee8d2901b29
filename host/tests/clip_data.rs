//! The readers on every real clip. The clips stay outside the repository: `KINESIC_DATA`, default `../shared/data`.

use std::collections::{BTreeMap, HashMap};
use std::time::{Duration, Instant};

use kinesic_host::clip::{self, Canonical, Clip, JointMap, kinect};
use kinesic_tests::{data, table};

#[test]
fn every_clip_of_the_manifest_is_read() {
    let Some(folder) = data("every_clip_of_the_manifest_is_read") else {
        return;
    };
    let rows = table(&folder.join("manifest.tsv"));
    assert!(rows.len() > 900, "{} rows", rows.len());
    let mut heights: BTreeMap<String, [f64; 2]> = BTreeMap::new();
    let (mut slowest, mut residuals, mut bytes) = ((Duration::ZERO, String::new()), Vec::new(), 0);
    let (start, mut turned) = (Instant::now(), Vec::new());
    for row in &rows {
        let (file, skeleton) = (&row["file"], &row["skeleton"]);
        let path = folder.join(file);
        bytes += path.metadata().expect("a file").len();
        let before = Instant::now();
        let clip = clip::read(&path).unwrap_or_else(|e| panic!("{e}"));
        slowest = slowest.max((before.elapsed(), file.clone()));
        let summary = clip.summary();

        let names = HashMap::from([
            ("cmu31", 31),
            ("bandai22", 21),
            ("m21", 21),
            ("daz43", 43),
            ("aalto19", 19),
            ("kinect20", 20),
            ("cc24", 24),
        ]);
        assert_eq!(summary.layout.as_ref(), Some(skeleton), "{file}");
        // bandai22 counts a scene root above the hips, which is folded.
        assert_eq!(Some(&summary.joints), names.get(skeleton.as_str()), "{file}");
        assert!((0.8..2.3).contains(&summary.height_m), "{file}: height {}", summary.height_m);
        let range = heights.entry(skeleton.clone()).or_insert([f64::INFINITY, 0.0]);
        *range = [range[0].min(summary.height_m), range[1].max(summary.height_m)];
        if skeleton != "kinect20" {
            assert_eq!(summary.frames.to_string(), row["frames"], "{file}");
            let fps: f64 = row["fps"].parse().expect("a rate");
            assert!((summary.fps - fps).abs() < 0.01 * fps, "{file}: {} fps", summary.fps);
        } else {
            let recording = kinect::read_recording(&path, &kinect::KinectOptions::default()).expect("read before");
            assert!(recording.residual_cm < 10.0, "{file}: {} cm", recording.residual_cm);
            residuals.push(recording.residual_cm);
        }
        if !faces_left_to_x(&clip) {
            turned.push(file.clone());
        }
    }
    eprintln!("toes against the sides: {turned:?}");
    assert!(turned.len() * 100 < rows.len(), "left and right exchanged in {turned:?}");
    residuals.sort_by(f64::total_cmp);
    let median = residuals[residuals.len() / 2];
    eprintln!(
        "{} clips, {} MB in {:.1?} with summaries; slowest {slowest:?}",
        rows.len(),
        bytes >> 20,
        start.elapsed()
    );
    eprintln!(
        "heights {heights:.2?}; kinect residual cm: median {median:.2}, worst {:.2}",
        residuals[residuals.len() - 1]
    );
    if !cfg!(debug_assertions) {
        assert!(slowest.0 < Duration::from_millis(1000), "{slowest:?}");
    }
}

/// Whether toes, or the way of knees and elbows, agree with left and right: a mirrored reader would turn people round.
fn faces_left_to_x(clip: &Clip) -> bool {
    let map = JointMap::detect(&clip.skeleton).expect("known layout");
    let (Some(lt), Some(rt)) = (map.joint(Canonical::LToe), map.joint(Canonical::RToe)) else {
        return true;
    };
    let at = |c| map.joint(c).expect("core joint");
    let (la, ra) = (at(Canonical::LAnkle), at(Canonical::RAnkle));
    let (lh, rh) = (at(Canonical::LHip), at(Canonical::RHip));
    let step = clip.frames().div_ceil(100);
    let forward = |f: usize| {
        let p = clip.positions(f);
        let up = p[at(Canonical::Head)] - (p[lh] + p[rh]) / 2.0;
        (p[lh] - p[rh]).cross(&up).dot(&(p[lt] - p[la] + p[rt] - p[ra])) > 0.0
    };
    let frames: Vec<usize> = (0..clip.frames()).step_by(step).collect();
    frames.iter().filter(|&&f| forward(f)).count() * 2 > frames.len()
}

#[test]
fn real_clips_survive_writing_and_reading() {
    let Some(folder) = data("real_clips_survive_writing_and_reading") else {
        return;
    };
    let out = tempfile::tempdir().expect("a folder");
    for file in [
        "cmu31/01_01.bvh",
        "xia/angry_01_000.bvh",
        "bandai1/bow_active_001.bvh",
        "bandai2/wave-left-hand_normal_002.bvh",
        "m21/content/box-1.bvh",
        "m21/style/DEPRESSED.bvh",
        "cmu43daz/09_01.bvh",
        "aalto/k_walk_regular_k_walk_sad_k_walk_slow_033_033_033.bvh",
        "cmu24cc/06_08.bvh",
        "kindergator/adult/p565_Bow.csv",
    ] {
        let clip = clip::read(folder.join(file)).unwrap_or_else(|e| panic!("{e}"));
        let path = out.path().join("again.bvh");
        let before = Instant::now();
        clip.write_bvh(&path).unwrap_or_else(|e| panic!("{e}"));
        let writing = before.elapsed();
        let again = clip::read(&path).unwrap_or_else(|e| panic!("{file}: {e}"));
        assert_eq!(again.frames(), clip.frames(), "{file}");
        assert!(again.notes[0].contains("cm assumed"), "{file}: {:?}", again.notes);
        let angle = clip.rotations.iter().zip(&again.rotations).map(|(a, b)| a.angle_to(b)).fold(0.0, f64::max);
        let (a, b) = (clip.all_positions(), again.all_positions());
        let off = a.iter().zip(&b).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
        eprintln!("{file}: {:.1e} degrees, {off:.1e} m, written in {writing:.1?}", angle.to_degrees());
        assert!(angle.to_degrees() < 1e-4 && off < 1e-6, "{file}: {} degrees, {off} m", angle.to_degrees());
    }
}

#[test]
fn the_layouts_agree_with_the_table_of_the_data() {
    let Some(folder) = data("the_layouts_agree_with_the_table_of_the_data") else {
        return;
    };
    let rows = table(&folder.join("joint_map.tsv"));
    for (layout, file) in [
        ("cmu31", "cmu31/01_01.bvh"),
        ("bandai22", "bandai1/bow_active_001.bvh"),
        ("m21", "m21/content/box-1.bvh"),
        ("daz43", "cmu43daz/09_01.bvh"),
        ("aalto19", "aalto/k_walk_regular_k_walk_sad_k_walk_slow_033_033_033.bvh"),
        ("kinect20", "kindergator/adult/p565_Bow.csv"),
    ] {
        let clip = clip::read(folder.join(file)).unwrap_or_else(|e| panic!("{e}"));
        let map = JointMap::detect(&clip.skeleton).expect("known layout");
        assert_eq!(map.layout(), layout);
        for row in &rows {
            let canonical = Canonical::from_name(&row["canonical"]).expect("a canonical joint");
            let found = map.joint(canonical).map_or("-", |j| &clip.skeleton.joints[j].name);
            assert_eq!(found, row[layout], "{layout}");
        }
        let mirrored = clip.mirrored().unwrap_or_else(|e| panic!("{file}: {e}"));
        let (a, b) = (clip.positions(7), mirrored.positions(7));
        for (joint, p) in b.iter().enumerate() {
            let q = a[map.mirror_partner(joint).expect("a partner")];
            assert!((p.x + q.x).hypot((p - q).yz().norm()) < 1e-9, "{layout} joint {joint}");
        }
    }
}

#[test]
fn a_long_clip_is_read_fast() {
    let Some(folder) = data("a_long_clip_is_read_fast") else {
        return;
    };
    let path = folder.join("m21/content/box-1.bvh");
    let best = (0..5).map(|_| {
        let before = Instant::now();
        assert_eq!(clip::read(&path).expect("a clip").frames(), 2795);
        before.elapsed()
    });
    let best = best.min().expect("five runs");
    eprintln!("2795 frames x 66 channels: {best:.1?}");
    assert!(cfg!(debug_assertions) || best < Duration::from_millis(100), "{best:?}");
}
