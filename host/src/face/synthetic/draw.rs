//! A face drawn from its landmarks, where no photograph may be.

use image::{Rgb, RgbImage};
use kinesic::face::Landmarks;

type Point = [f32; 2];

const GROUND: Rgb<u8> = Rgb([222, 231, 238]);
const HAIR: Rgb<u8> = Rgb([74, 52, 40]);
const SKIN: Rgb<u8> = Rgb([231, 186, 155]);
const SHADE: Rgb<u8> = Rgb([206, 152, 122]);
const WHITE: Rgb<u8> = Rgb([250, 250, 248]);
const IRIS: Rgb<u8> = Rgb([62, 92, 120]);
const LIPS: Rgb<u8> = Rgb([181, 80, 80]);
const MOUTH: Rgb<u8> = Rgb([92, 34, 38]);

/// A picture of `size` by `size` pixels of the face.
pub fn draw(landmarks: &Landmarks, size: u32) -> RgbImage {
    let mut picture = RgbImage::from_pixel(size, size, GROUND);
    let middle = mean(&landmarks[27..36]);
    let round: Vec<Point> = landmarks[..17].iter().chain(&forehead(landmarks)).copied().collect();
    let wide = |k: f32, by: f32| {
        move |p: &Point| [middle[0] + k * (p[0] - middle[0]), middle[1] + k * (p[1] - middle[1]) + by]
    };
    let unit = distance(landmarks[0], landmarks[16]) / 100.0;
    fill(&mut picture, &round.iter().map(wide(1.14, -7.0 * unit)).collect::<Vec<_>>(), HAIR);
    fill(&mut picture, &round, SKIN);
    line(&mut picture, &landmarks[27..31], 1.4 * unit, SHADE);
    line(&mut picture, &landmarks[31..36], 1.8 * unit, SHADE);
    for eye in [&landmarks[36..42], &landmarks[42..48]] {
        fill(&mut picture, eye, WHITE);
        // Held inside the lids.
        let iris = disc(mean(eye), 3.2 * unit).into_iter().filter(|p| inside(eye, *p)).collect::<Vec<_>>();
        fill(&mut picture, &iris, IRIS);
        line(&mut picture, &eye[..4], 0.9 * unit, HAIR);
    }
    for brow in [&landmarks[17..22], &landmarks[22..27]] {
        line(&mut picture, brow, 2.0 * unit, HAIR);
    }
    fill(&mut picture, &landmarks[48..60], LIPS);
    fill(&mut picture, &landmarks[60..68], MOUTH);
    picture
}

/// Half an ellipse over the brows, from the last point of the contour to the first.
fn forehead(landmarks: &Landmarks) -> Vec<Point> {
    let (right, left) = (landmarks[0], landmarks[16]);
    let middle = mean(&[right, left]);
    let half = [(left[0] - right[0]) / 2.0, (left[1] - right[1]) / 2.0];
    let arc = |i: usize| {
        let (sin, cos) = kinesic::kernel::sin_cos(std::f32::consts::PI * i as f32 / 16.0);
        let up = [1.15 * half[1] * sin, -1.15 * half[0] * sin];
        [middle[0] + cos * half[0] + up[0], middle[1] + cos * half[1] + up[1]]
    };
    (1..16).map(arc).collect()
}

fn mean(points: &[Point]) -> Point {
    let sum = points.iter().fold([0.0, 0.0], |[x, y], p| [x + p[0], y + p[1]]);
    sum.map(|x| x / points.len() as f32)
}

fn distance(a: Point, b: Point) -> f32 {
    ((a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2)).sqrt()
}

fn disc(at: Point, radius: f32) -> Vec<Point> {
    let point = |i: usize| {
        let (sin, cos) = kinesic::kernel::sin_cos(std::f32::consts::TAU * i as f32 / 24.0);
        [at[0] + radius * cos, at[1] + radius * sin]
    };
    (0..24).map(point).collect()
}

/// By the number of edges to the right of the point.
fn inside(corners: &[Point], [x, y]: Point) -> bool {
    let next = corners.iter().cycle().skip(1);
    let crosses =
        |(a, b): (&Point, &Point)| (a[1] > y) != (b[1] > y) && x < a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
    corners.iter().zip(next).filter(|edge| crosses(*edge)).count() % 2 == 1
}

fn fill(picture: &mut RgbImage, corners: &[Point], colour: Rgb<u8>) {
    paint(picture, corners, 0.0, colour, |at| inside(corners, at));
}

/// A line of a width, with round ends.
fn line(picture: &mut RgbImage, points: &[Point], width: f32, colour: Rgb<u8>) {
    let near = |at: Point| {
        points.windows(2).any(|pair| {
            let along = [pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]];
            let dot = (at[0] - pair[0][0]) * along[0] + (at[1] - pair[0][1]) * along[1];
            let t = (dot / (along[0] * along[0] + along[1] * along[1])).clamp(0.0, 1.0);
            distance(at, [pair[0][0] + t * along[0], pair[0][1] + t * along[1]]) < width
        })
    };
    paint(picture, points, width, colour, near);
}

/// Paints what is covered, with nine samples a pixel.
fn paint(picture: &mut RgbImage, points: &[Point], margin: f32, colour: Rgb<u8>, covered: impl Fn(Point) -> bool) {
    let range = |axis: usize, size: u32| {
        let low = points.iter().map(|p| p[axis]).fold(f32::INFINITY, f32::min) - margin - 1.0;
        let high = points.iter().map(|p| p[axis]).fold(f32::NEG_INFINITY, f32::max) + margin + 2.0;
        // Casts saturate.
        low as u32..(high as u32).min(size)
    };
    for y in range(1, picture.height()) {
        for x in range(0, picture.width()) {
            let samples = (0..9)
                .map(|i| [x as f32 + (i % 3) as f32 / 3.0 - 1.0 / 3.0, y as f32 + (i / 3) as f32 / 3.0 - 1.0 / 3.0]);
            let share = samples.filter(|at| covered(*at)).count() as f32 / 9.0;
            for (to, from) in picture.get_pixel_mut(x, y).0.iter_mut().zip(colour.0) {
                *to = (f32::from(*to) + share * (f32::from(from) - f32::from(*to))).round() as u8;
            }
        }
    }
}
