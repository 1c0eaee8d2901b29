//! What cameras and detectors of landmarks write: turned pictures, other columns, shares, points that were not found.

use std::path::Path;

use image::imageops::{flip_horizontal, flip_vertical, rotate90, rotate180, rotate270};
use image::{ImageFormat, RgbImage};
use kinesic::face::{Landmarks, POINTS};
use kinesic_host::face::{LandmarksFault, landmarks, photo, synthetic};
use rand::SeedableRng;
use rand::rngs::ChaCha8Rng;

fn face() -> Landmarks {
    synthetic::landmarks(0.4, 0.2, &mut ChaCha8Rng::seed_from_u64(3))
}

/// How a sensor was held, put on its pixels.
type Turn = fn(&RgbImage) -> RgbImage;

/// A picture as a camera writes it: pixels as the sensor has them, and how it was held.
fn photograph(pixels: &RgbImage, orientation: u8, path: &Path) {
    let mut jpeg = std::io::Cursor::new(Vec::new());
    pixels.write_to(&mut jpeg, ImageFormat::Jpeg).unwrap();
    let jpeg = jpeg.into_inner();
    // EXIF, big-endian, with one entry: tag 0x0112, one short.
    let tiff = [&b"Exif\0\0MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0"[..], &[orientation], &b"\0\0\0\0\0\0"[..]]
        .concat();
    let length = (tiff.len() as u16 + 2).to_be_bytes();
    let (start, rest) = jpeg.split_at(2);
    std::fs::write(path, [start, &[0xff, 0xe1], &length, &tiff, rest].concat()).unwrap();
}

#[test]
fn a_turned_photograph_is_upright() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("phone.jpg");
    // Taller than wide, so that a quarter turn shows in the size too.
    let upright = image::imageops::crop_imm(&synthetic::draw(&face(), 250), 20, 0, 210, 250).to_image();
    let held: [(u8, Turn); 6] = [
        (1, |p| p.clone()),
        (2, |p| flip_horizontal(p)),
        (3, |p| rotate180(p)),
        (4, |p| flip_vertical(p)),
        (6, |p| rotate270(p)),
        (8, |p| rotate90(p)),
    ];
    for (orientation, stored) in held {
        photograph(&stored(&upright), orientation, &path);
        let (picture, turned) = photo::open(&path).unwrap();
        let picture = picture.into_rgb8();
        assert_eq!((picture.dimensions(), turned), (upright.dimensions(), orientation != 1), "{orientation}");
        let off: u64 = picture.iter().zip(upright.iter()).map(|(a, b)| u64::from(a.abs_diff(*b))).sum();
        let mean = off as f64 / picture.len() as f64;
        assert!(mean < 3.0, "{orientation}: {mean} levels off");
    }
}

/// A table of one face with such columns.
fn table(column: impl Fn(&str, usize) -> String, face: &Landmarks) -> String {
    let columns = |axis: &str| (0..POINTS).map(|i| column(axis, i)).collect::<Vec<_>>().join(",");
    let numbers = |axis: usize| face.iter().map(|p| format!(" {}", p[axis])).collect::<Vec<_>>().join(",");
    format!("frame,{},{}\n7,{},{}\n", columns("x"), columns("y"), numbers(0), numbers(1))
}

#[test]
fn columns_of_other_detectors_are_read() {
    // OpenFace: all x, then all y, underscores, blanks before names and numbers.
    for column in [
        |axis: &str, i: usize| format!(" {axis}_{i}"),
        |axis: &str, i: usize| format!("{}{i}", axis.to_uppercase()),
        |axis: &str, i: usize| format!("landmark_{i}_{axis}"),
    ] {
        let faces = landmarks::parse(table(column, &face()).as_bytes(), None).unwrap();
        assert_eq!((faces.len(), faces[0].landmarks, faces[0].picture.as_str()), (1, face(), "7"));
    }
    // Semicolons; and OpenFace's tool for pictures, which counts faces.
    let plain = table(|axis, i| format!("{axis}{i}"), &face());
    for text in [plain.replace(',', ";"), plain.replace("frame,", "face,")] {
        assert_eq!(landmarks::parse(text.as_bytes(), None).unwrap()[0].landmarks, face());
    }
}

#[test]
fn what_a_detector_did_not_find_or_means_otherwise_is_refused() {
    let plain = table(|axis, i| format!("{axis}{i}"), &face());
    let refused = |text: String| landmarks::parse(text.as_bytes(), None).unwrap_err();
    let failed = plain.replace("frame,", "frame,success,").replace("\n7,", "\n7,0,");
    assert_eq!(refused(failed), LandmarksFault::Failed { line: 2 });
    let mesh = plain.replace("frame,", "x68,y68,frame,").replace("\n7,", "\n1,1,7,");
    assert_eq!(refused(mesh), LandmarksFault::Mesh { last: "x68".into() });
    let odd = |change: &dyn Fn(&mut Landmarks)| {
        let mut face = face();
        change(&mut face);
        refused(table(|axis, i| format!("{axis}{i}"), &face))
    };
    // A nose in the corner of the picture, a mouth left of it, an eye far away.
    assert!(matches!(odd(&|f| f[30] = [0.0; 2]), LandmarksFault::NotFound { count: 1, .. }));
    assert!(matches!(odd(&|f| f[48][0] = -1.0), LandmarksFault::NotFound { count: 1, .. }));
    let astray = odd(&|f| f[36] = [9999.0, 9999.0]);
    assert!(matches!(&astray, LandmarksFault::Astray { count: 1, list, .. } if list == "36"), "{astray}");
}

#[test]
fn what_is_no_landmark_is_refused_with_its_points() {
    let plain = |axis: &str, i: usize| format!("{axis}{i}");
    let refused = |face: &Landmarks| landmarks::parse(table(plain, face).as_bytes(), None).unwrap_err();
    let shares = face().map(|p| p.map(|x| x / 250.0));
    assert!(matches!(refused(&shares), LandmarksFault::Normalised { line: 2, .. }), "{}", refused(&shares));
    assert!(refused(&shares).to_string().contains("Multiply x by its width"));
    for (points, at, place, list) in [(17..27, -1.0, "-1,-1", "17 18 19"), (48..68, 0.0, "0,0", "48 49 50")] {
        let mut lost = face();
        lost[points.clone()].fill([at; 2]);
        let fault = refused(&lost);
        assert!(matches!(fault, LandmarksFault::NotFound { line: 2, count, .. } if count == points.len()), "{fault}");
        let text = fault.to_string();
        assert!(text.contains(place) && text.contains(list) && text.contains("Detect the face again"), "{text}");
    }
}
