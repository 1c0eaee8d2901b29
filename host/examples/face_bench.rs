//! The portrait tables of docs/faces.md: 20 people pushed to neutral and to smiling, and the warped neutral face beside the
//! person's real smiling photograph.
//!
//! `face_bench PACK.kin PORTRAITS_FOLDER PORTRAITS.csv`

use std::path::Path;

use image::{GrayImage, Luma};
use kinesic::face::{FaceFrame, Landmarks};
use kinesic_host::face::warp::Warp;
use kinesic_host::face::{Edit, Face, Wish, edit, landmarks};
use kinesic_host::pack::PackFile;

const PEOPLE: usize = 20;

type Failure = Box<dyn std::error::Error>;

fn main() -> Result<(), Failure> {
    let mut args = std::env::args().skip(1);
    let mut next = || args.next().ok_or("usage: face_bench PACK.kin PORTRAITS_FOLDER PORTRAITS.csv");
    let (pack, folder, table) = (next()?, next()?, next()?);
    let file = PackFile::read(Path::new(&pack))?;
    let faces = landmarks::read(Path::new(&table), Some("smile"))?;
    let pack = file.pack()?;
    let pairs: Vec<(&Face, &Face)> = faces
        .iter()
        .filter(|face| face.label == Some(0.0))
        .filter_map(|neutral| {
            let smiling = |other: &&Face| other.person == neutral.person && other.label == Some(1.0);
            Some((neutral, faces.iter().find(smiling)?))
        })
        .take(PEOPLE)
        .collect();
    println!(
        "| person | neutral photograph | pushed to 1 | smiling photograph | pushed to 0 | least Jacobian | landmarks missed, px |"
    );
    println!("|---|---|---|---|---|---|---|");
    let mut worst = [0.0f32, 0.0, f32::INFINITY, 0.0];
    let mut distances = Vec::new();
    for (neutral, smiling) in &pairs {
        let up = change(&pack, neutral, 1.0)?;
        let down = change(&pack, smiling, 0.0)?;
        let like_smile = change(&pack, neutral, down.reading.strength)?;
        let warps = [Warp::new(&neutral.landmarks, &up.offsets)?, Warp::new(&smiling.landmarks, &down.offsets)?];
        let jacobian = warps.iter().map(Warp::least_jacobian).fold(f64::INFINITY, f64::min) as f32;
        let missed = warps.iter().map(Warp::missed).fold(0.0, f64::max) as f32;
        println!(
            "| {} | {:.2} | {:.3} | {:.2} | {:.3} | {jacobian:.2} | {missed:.2} |",
            neutral.person, up.reading.strength, up.strength_after, down.reading.strength, down.strength_after
        );
        let misses = [(up.strength_after - 1.0).abs(), down.strength_after.abs()];
        worst = [worst[0].max(misses[0]), worst[1].max(misses[1]), worst[2].min(jacobian), worst[3].max(missed)];
        distances.push(distance(&folder, neutral, smiling, &like_smile)?);
    }
    println!("| worst | | off by {:.3} | | off by {:.3} | {:.2} | {:.2} |", worst[0], worst[1], worst[2], worst[3]);
    println!("\n| distance to the real smiling photograph | not edited | edited | people for whom editing is nearer |");
    println!("|---|---|---|---|");
    for (index, name) in [
        "landmarks of the mouth, face units",
        "all moving landmarks, face units",
        "pixels of the mouth, grey levels",
        "pixels of the face, grey levels",
    ]
    .iter()
    .enumerate()
    {
        let mean = |which: usize| distances.iter().map(|d| d[index][which]).sum::<f64>() / distances.len() as f64;
        let nearer = distances.iter().filter(|d| d[index][1] < d[index][0]).count();
        println!("| {name} | {:.4} | {:.4} | {nearer} of {} |", mean(0), mean(1), distances.len());
    }
    Ok(())
}

fn change(pack: &kinesic::Pack, face: &Face, to: f32) -> Result<Edit, Failure> {
    Ok(edit(pack, &face.landmarks, Wish::Strength(to))?.ok_or("no face")?)
}

/// Distances `[not edited, edited]` of the neutral face to the smiling one: landmarks of the mouth and all that move, root mean
/// square in the face's frame; pixels around the mouth and of the face, mean absolute, smiling photograph laid over the neutral
/// one by its contour, eyes and nose bridge.
fn distance(folder: &str, neutral: &Face, smiling: &Face, edited: &Edit) -> Result<[[f64; 2]; 4], Failure> {
    let shape = |landmarks: &Landmarks| FaceFrame::of(landmarks).ok_or("no face").map(|frame| frame.shape(landmarks));
    let wanted = shape(&smiling.landmarks)?;
    let [plain, made] = [shape(&neutral.landmarks)?, shape(&edited.landmarks)?];
    let apart = |a: &[[f32; 2]], b: &[[f32; 2]]| {
        let sum: f32 = a.iter().zip(b).map(|(a, b)| (a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2)).sum();
        f64::from((sum / a.len() as f32).sqrt())
    };
    let open = |face: &Face| -> Result<GrayImage, Failure> {
        Ok(image::open(Path::new(folder).join(&face.picture))?.to_luma8())
    };
    let (before, target) = (open(neutral)?, open(smiling)?);
    let warped = Warp::new(&neutral.landmarks, &edited.offsets)?.apply(&before.clone().into())?.to_luma8();
    let fit = Similarity::between(&neutral.landmarks, &smiling.landmarks);
    // Around the mouth as it is in either photograph.
    let mouths: Vec<[f32; 2]> = neutral.landmarks[48..].iter().chain(&edited.landmarks[48..]).copied().collect();
    let faces: Vec<[f32; 2]> = neutral.landmarks[17..].iter().chain(&edited.landmarks[17..]).copied().collect();
    let pixels = |image: &GrayImage, around: &[[f32; 2]]| {
        let bound = |axis: usize, pick: fn(f32, f32) -> f32, start| around.iter().map(|p| p[axis]).fold(start, pick);
        let (left, right) = (bound(0, f32::min, f32::MAX) as u32, bound(0, f32::max, 0.0) as u32 + 1);
        let (top, bottom) = (bound(1, f32::min, f32::MAX) as u32, bound(1, f32::max, 0.0) as u32 + 1);
        let margin = (right - left) / 10;
        let (mut sum, mut count) = (0.0, 0.0);
        for y in top.saturating_sub(margin)..(bottom + margin).min(image.height()) {
            for x in left.saturating_sub(margin)..(right + margin).min(image.width()) {
                let there = fit.apply([f64::from(x), f64::from(y)]);
                sum += (f64::from(image.get_pixel(x, y).0[0]) - sample(&target, there)).abs();
                count += 1.0;
            }
        }
        sum / count
    };
    Ok([
        [apart(&plain[31..], &wanted[31..]), apart(&made[31..], &wanted[31..])],
        [apart(&plain, &wanted), apart(&made, &wanted)],
        [pixels(&before, &mouths), pixels(&warped, &mouths)],
        [pixels(&before, &faces), pixels(&warped, &faces)],
    ])
}

/// `z -> a z + b` in complex numbers.
struct Similarity([f64; 4]);

impl Similarity {
    /// The best one on landmarks that a smile hardly moves: temples, eyes' corners, bridge of the nose.
    fn between(from: &Landmarks, to: &Landmarks) -> Self {
        const STILL: [usize; 12] = [0, 1, 15, 16, 27, 28, 29, 30, 36, 39, 42, 45];
        let points = |of: &Landmarks| STILL.map(|i| of[i].map(f64::from));
        let mean = |of: &[[f64; 2]; 12]| of.iter().fold([0.0; 2], |s, p| [s[0] + p[0] / 12.0, s[1] + p[1] / 12.0]);
        let (from, to) = (points(from), points(to));
        let (f, t) = (mean(&from), mean(&to));
        let (mut re, mut im, mut squares) = (0.0, 0.0, 0.0);
        for (p, q) in from.iter().zip(&to) {
            let ([x, y], [u, v]) = ([p[0] - f[0], p[1] - f[1]], [q[0] - t[0], q[1] - t[1]]);
            re += x * u + y * v;
            im += x * v - y * u;
            squares += x * x + y * y;
        }
        let (re, im) = (re / squares, im / squares);
        Self([re, im, t[0] - re * f[0] + im * f[1], t[1] - im * f[0] - re * f[1]])
    }

    fn apply(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [re, im, a, b] = self.0;
        [re * x - im * y + a, im * x + re * y + b]
    }
}

/// Bilinear, the edge repeated.
fn sample(image: &GrayImage, [x, y]: [f64; 2]) -> f64 {
    let at = |x: f64, y: f64| {
        let inside = |v: f64, size: u32| v.clamp(0.0, f64::from(size - 1)) as u32;
        let Luma([value]) = image.get_pixel(inside(x, image.width()), inside(y, image.height()));
        f64::from(*value)
    };
    let (column, row) = (x.floor(), y.floor());
    let (right, down) = (x - column, y - row);
    let line = |row: f64| at(column, row) * (1.0 - right) + at(column + 1.0, row) * right;
    line(row) * (1.0 - down) + line(row + 1.0) * down
}
