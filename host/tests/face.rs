//! Faces: the device's laws, training on made faces, the warp; real faces where they are.

use image::{DynamicImage, Rgb, RgbImage};
use kinesic::face::{CONTOUR, FaceState, Landmarks, POINTS};
use kinesic_host::face::warp::{Warp, WarpError};
use kinesic_host::face::{
    Face, HostFace, LandmarksFault, TrainError, TrainOptions, Trained, Wish, edit, evaluate, hold_out, landmarks,
    synthetic, train,
};
use kinesic_host::pack::{PackFile, Provenance};
use rand::SeedableRng;
use rand::rngs::ChaCha8Rng;

fn random(seed: u64) -> ChaCha8Rng {
    ChaCha8Rng::seed_from_u64(seed)
}

fn trained(seed: u64) -> Trained {
    let options = TrainOptions { clusters: 3, ..TrainOptions::default() };
    train(&synthetic::faces(600, &mut random(seed)), "smile", &options).unwrap()
}

fn packed(trained: &Trained) -> PackFile {
    PackFile::from_bytes(&trained.model.pack(&Provenance::default()))
}

#[test]
fn made_smiles_are_ranked_and_an_edit_scores_as_asked() {
    let file = packed(&trained(1));
    let pack = file.pack().unwrap();
    let others = synthetic::faces(300, &mut random(2));
    let report = evaluate(&pack, &others).unwrap();
    assert!(report.pair_accuracy > 0.97 && report.spearman > 0.8, "{report:?}");
    // Strengths are in units of the labels.
    for label in [0.0, 1.0] {
        let model = HostFace::load(&pack).unwrap();
        let of: Vec<&Face> = others.iter().filter(|face| face.label == Some(label)).collect();
        let sum: f32 = of.iter().map(|face| model.read(&face.landmarks).unwrap().strength).sum();
        assert!((sum / of.len() as f32 - label as f32).abs() < 0.1, "{label}: {sum} / {}", of.len());
    }
    for face in &others[..50] {
        for to in [0.0, 0.5, 1.0] {
            let edit = edit(&pack, &face.landmarks, Wish::Strength(to)).unwrap().unwrap();
            assert!((edit.strength_after - to).abs() < 0.05, "{to}: {}", edit.strength_after);
        }
    }
}

#[test]
fn the_same_seed_gives_the_same_bytes() {
    assert!(packed(&trained(3)).bytes() == packed(&trained(3)).bytes());
}

#[test]
fn the_device_keeps_its_laws() {
    let file = PackFile::from_bytes(&synthetic::model(12, 10, &mut random(4)).pack(&Provenance::default()));
    let pack = file.pack().unwrap();
    let model = HostFace::load(&pack).unwrap();
    for seed in 0..40 {
        let face = synthetic::landmarks(0.3, (seed as f32 - 20.0) / 20.0, &mut random(seed));
        let mut state = FaceState::new();
        let mut offsets = [[1.0; 2]; POINTS];
        model.step(&mut state, &face, &mut offsets);
        assert_eq!(offsets, [[0.0; 2]; POINTS], "no change, no offset");
        state.change = 0.7;
        model.step(&mut state, &face, &mut offsets);
        assert_eq!(offsets[..CONTOUR], [[0.0; 2]; CONTOUR], "the contour stays");
        assert!(offsets[CONTOUR..].iter().any(|offset| *offset != [0.0; 2]));
        let reading = state.reading().unwrap();
        assert_eq!(reading.target, reading.strength + 0.7);

        // A picture at another place, three times as large, turned by a right angle.
        let other = face.map(|[x, y]| [40.0 - 3.0 * y, 3.0 * x - 7.0]);
        let (mut turned, mut there) = (FaceState::new(), [[0.0; 2]; POINTS]);
        turned.change = 0.7;
        model.step(&mut turned, &other, &mut there);
        assert!((turned.reading().unwrap().strength - reading.strength).abs() < 1e-3);
        for ([x, y], [u, v]) in offsets.iter().zip(there) {
            assert!((u + 3.0 * y).abs() < 0.05 && (v - 3.0 * x).abs() < 0.05, "{x} {y} {u} {v}");
        }

        // What is no face changes nothing.
        let (before, held) = (state, offsets);
        for nothing in [[[f32::NAN; 2]; POINTS], [[5.0; 2]; POINTS], [[f32::INFINITY, 0.0]; POINTS]] {
            model.step(&mut state, &nothing, &mut offsets);
            assert!(offsets == held && state == before);
            assert_eq!(model.read(&nothing), None);
        }
        state.change = 1e9;
        model.step(&mut state, &face, &mut offsets);
        assert!(state.reading().unwrap().target <= model.meta().strength[1].max(reading.strength));
    }
}

#[test]
fn a_warp_moves_landmarks_folds_nowhere_and_leaves_the_background() {
    let file = packed(&trained(1));
    let pack = file.pack().unwrap();
    let mut picture = RgbImage::from_fn(250, 250, |x, y| Rgb([x as u8, y as u8, ((x * y) % 251) as u8]));
    picture.put_pixel(0, 0, Rgb([1, 2, 3]));
    let picture = DynamicImage::ImageRgb8(picture);
    for seed in 0..8 {
        let face = synthetic::landmarks(0.2, 0.1 * seed as f32 - 0.4, &mut random(seed));
        let edit = edit(&pack, &face, Wish::Change(0.8)).unwrap().unwrap();
        let warp = Warp::new(&face, &edit.offsets).unwrap();
        assert!(warp.least_jacobian() > 0.0, "folds: {}", warp.least_jacobian());
        let largest = edit.offsets.iter().map(|[x, y]| x.hypot(*y)).fold(0.0, f32::max);
        assert!(warp.missed() < 0.4 * f64::from(largest), "{} of {largest}", warp.missed());
        let made = warp.apply(&picture).unwrap();
        assert_ne!(made, picture);
        let (old, new) = (picture.to_rgb8(), made.to_rgb8());
        for (x, y, pixel) in new.enumerate_pixels() {
            if warp.displacement([f64::from(x), f64::from(y)]) == [0.0; 2] {
                assert_eq!(pixel, old.get_pixel(x, y));
            }
        }
        // Far from the face everything is background.
        let [left, right] =
            [f32::min as fn(f32, f32) -> f32, f32::max].map(|pick| face.iter().map(|p| p[0]).reduce(pick).unwrap());
        for x in (0..250).filter(|x| (*x as f32) < left - 12.0 || (*x as f32) > right + 12.0) {
            assert!((0..250).all(|y| warp.displacement([f64::from(x), f64::from(y)]) == [0.0; 2]));
        }
    }
}

#[test]
fn a_warp_by_nothing_is_the_picture_and_nonsense_is_refused() {
    let face = synthetic::landmarks(0.2, 0.0, &mut random(1));
    let picture = DynamicImage::ImageLuma8(image::GrayImage::from_fn(250, 250, |x, y| image::Luma([(x ^ y) as u8])));
    let warp = Warp::new(&face, &[[0.0; 2]; POINTS]).unwrap();
    assert_eq!(warp.apply(&picture).unwrap(), picture);
    let mut offsets: Landmarks = [[0.0; 2]; POINTS];
    offsets[50][1] = f32::NAN;
    assert_eq!(Warp::new(&face, &offsets).unwrap_err(), WarpError::Offset { landmark: 50 });
    assert_eq!(Warp::new(&[[0.0; 2]; POINTS], &[[0.0; 2]; POINTS]).unwrap_err(), WarpError::NoFace);
    // Even a wild wish does not fold.
    let wild: Landmarks =
        std::array::from_fn(|i| if i < CONTOUR { [0.0; 2] } else { [40.0 * (i % 3) as f32 - 40.0, 25.0] });
    assert!(Warp::new(&face, &wild).unwrap().least_jacobian() > 0.0);
}

/// A table of made faces.
fn table(faces: &[Face]) -> String {
    let header = (0..POINTS).map(|i| format!(",x{i},y{i}")).collect::<String>();
    let row = |face: &Face| {
        let label = face.label.map(|label| label.to_string()).unwrap_or_default();
        let numbers = face.landmarks.iter().map(|[x, y]| format!(",{x},{y}")).collect::<String>();
        format!("{},{},{label}{numbers}\n", face.picture, face.person)
    };
    format!("image,subject,smile{header}\n") + &faces.iter().map(row).collect::<String>()
}

#[test]
fn a_table_is_read_as_written_and_faults_name_line_and_column() {
    let faces = synthetic::faces(5, &mut random(7));
    let text = table(&faces);
    assert_eq!(landmarks::parse(text.as_bytes(), Some("smile")).unwrap(), faces);
    let fault = |change: &dyn Fn(&mut Vec<Vec<String>>)| {
        let mut cells: Vec<Vec<String>> = text.lines().map(|l| l.split(',').map(str::to_owned).collect()).collect();
        change(&mut cells);
        let text: String = cells.iter().map(|row| row.join(",") + "\n").collect();
        landmarks::parse(text.as_bytes(), Some("smile")).unwrap_err()
    };
    let found = fault(&|cells| cells[3][5] = "left".into());
    assert_eq!(found, LandmarksFault::NotANumber { line: 4, column: "x1".into(), found: "left".into() });
    assert!(matches!(fault(&|cells| cells[2].truncate(9)), LandmarksFault::Row { line: 3, found: 9, expected: 139 }));
    assert!(
        matches!(fault(&|cells| cells[0][138] = "z".into()), LandmarksFault::MissingColumn { column } if column == "y67")
    );
    assert!(matches!(fault(&|cells| cells[0][2] = "frown".into()), LandmarksFault::NoAttribute { .. }));
    assert!(matches!(fault(&|cells| cells[1][3..].fill("1".into())), LandmarksFault::Degenerate { line: 2 }));
    assert_eq!(landmarks::parse(b"", None).unwrap_err(), LandmarksFault::Empty);
    assert_eq!(landmarks::parse(text.lines().next().unwrap().as_bytes(), None).unwrap_err(), LandmarksFault::NoFace);
}

#[test]
fn training_says_what_is_missing() {
    let mut faces = synthetic::faces(60, &mut random(8));
    let all = |faces: &[Face], clusters| train(faces, "smile", &TrainOptions { clusters, ..TrainOptions::default() });
    assert_eq!(all(&faces, 61).unwrap_err(), TrainError::Clusters { found: 61, faces: 60 });
    let hidden = TrainOptions { hidden: 65, ..TrainOptions::default() };
    assert_eq!(train(&faces, "smile", &hidden).unwrap_err(), TrainError::Hidden { found: 65 });
    // Twelve clusters of five faces cannot be ranked: they are joined, and the notes say so.
    let few = all(&faces, 12).unwrap();
    assert!(few.model.clusters.len() < 12 && !few.notes.is_empty(), "{:?}", few.notes);
    faces.iter_mut().for_each(|face| face.label = Some(1.0));
    assert_eq!(all(&faces, 1).unwrap_err(), TrainError::Labels { low: 0, high: 0 });
}

#[test]
fn the_commands_work_together() {
    let folder = tempfile::tempdir().unwrap();
    let kinesic = |args: &str| {
        let run = std::process::Command::new(env!("CARGO_BIN_EXE_kinesic"))
            .args(args.split(' '))
            .current_dir(folder.path())
            .output()
            .unwrap();
        (run.status.success(), String::from_utf8(run.stdout).unwrap() + &String::from_utf8(run.stderr).unwrap())
    };
    let succeed = |args: &str| {
        let (success, text) = kinesic(args);
        assert!(success, "{args}: {text}");
        text
    };
    let faces = synthetic::faces(400, &mut random(9));
    std::fs::write(folder.path().join("faces.csv"), table(&faces)).unwrap();
    RgbImage::from_fn(250, 250, |x, y| Rgb([x as u8, y as u8, 9])).save(folder.path().join("7.png")).unwrap();
    let train = "train face --landmarks faces.csv --attribute smile --clusters 2 --out smile.kin";
    assert!(succeed(train).contains("held out"));
    assert!(succeed("inspect smile.kin").contains("Face pack \"smile\""));
    let json: serde_json::Value =
        serde_json::from_str(&succeed("eval face smile.kin --landmarks faces.csv --scores scores.csv --json")).unwrap();
    assert!(json["pair_accuracy"].as_f64().unwrap() > 0.95 && json["pairs"].as_u64().unwrap() > 10_000, "{json}");
    assert!(json["spearman"].as_f64().unwrap() > 0.8);
    assert_eq!(std::fs::read_to_string(folder.path().join("scores.csv")).unwrap().lines().count(), 401);
    let change = "face smile.kin --image 7.png --landmarks faces.csv --change +0.5 --out out.png --landmarks-out moved.csv --json";
    let json: serde_json::Value = serde_json::from_str(&succeed(change)).unwrap();
    let of = |name: &str| json["faces"][0][name].as_f64().unwrap();
    assert!((of("strength_after") - of("strength_target")).abs() < 0.05, "{json}");
    assert!(of("least_jacobian") > 0.0);
    assert_eq!(image::open(folder.path().join("out.png")).unwrap().width(), 250);
    assert_eq!(landmarks::read(&folder.path().join("moved.csv"), None).unwrap().len(), 1);
    succeed("face smile.kin --image 7.png --landmarks faces.csv --change 0.5 --sheet --out sheet.png");
    assert_eq!(image::open(folder.path().join("sheet.png")).unwrap().width(), 768);
    for (args, why) in [
        ("face smile.kin --image 7.png --landmarks faces.csv --out a.png", "--change"),
        ("face smile.kin --image 7.png --image 7.png --landmarks faces.csv --to 1 --out a.png", "--sheet"),
        ("face smile.kin --image other.png --landmarks faces.csv --to 1 --out a.png", "400 lines"),
        ("face smile.kin --image 7.png --landmarks faces.csv --to 1 --out a.jpg", ".png"),
        ("train face --landmarks faces.csv --attribute anger --out a.kin", "anger"),
    ] {
        let (success, text) = kinesic(args);
        assert!(!success && text.contains(why), "{args}: {text}");
    }
    assert!(!folder.path().join("a.png").exists());
}

#[test]
fn human_smile_labels_of_unseen_people() {
    let Some(folder) = kinesic_tests::data("human_smile_labels_of_unseen_people") else { return };
    let faces = landmarks::read(&folder.join("faces/wild_landmarks68.csv"), Some("smile")).unwrap();
    let out = hold_out(&faces, 0.5, 1);
    let part =
        |held: bool| faces.iter().zip(&out).filter(|(_, o)| **o == held).map(|(f, _)| f.clone()).collect::<Vec<_>>();
    let (kept, held) = (part(false), part(true));
    assert!(kept.iter().all(|face| held.iter().all(|other| other.person != face.person)));
    let file = packed(&train(&kept, "smile", &TrainOptions::default()).unwrap());
    let report = evaluate(&file.pack().unwrap(), &held).unwrap();
    println!("{report:?}");
    assert!(report.pair_accuracy > 0.955, "{}", report.pair_accuracy);
}
