//! Made faces, where no recorded ones may be: tests and the firmware workload.

mod draw;

use kinesic::face::{CONTOUR, FEATURES, FaceFrame, Landmarks, MOVING, POINTS};
use rand::RngExt;
use rand::rngs::ChaCha8Rng;

use super::landmarks::Face;
use super::model::{ClusterModel, FaceModel};

pub use draw::draw;

/// A face of a picture of 250 x 250 pixels with a smile of `strength`, the head turned by `yaw` (-1 to 1), and the chance
/// differences of a person.
pub fn landmarks(strength: f32, yaw: f32, random: &mut ChaCha8Rng) -> Landmarks {
    let mut face = upright(strength);
    let own = |random: &mut ChaCha8Rng, size: f32| random.random_range(-size..size);
    let (wide, high) = (1.0 + own(random, 0.06), 1.0 + own(random, 0.06));
    let (roll, size) = (own(random, 0.2), 70.0 * (1.0 + own(random, 0.2)));
    let place = [125.0 + own(random, 10.0), 125.0 + own(random, 10.0)];
    for [x, y] in &mut face {
        // Farther from the axis, nearer to the camera: a turned head shifts its middle more than its rim.
        let depth = (1.2 - *x * *x).max(0.0);
        let (u, v) = (wide * *x + 0.3 * yaw * depth + own(random, 0.012), high * *y + own(random, 0.012));
        [*x, *y] = [place[0] + size * (u - roll * v), place[1] + size * (v + roll * u)];
    }
    face
}

/// Right is left in the picture; y down; half the width of the face is 1.
fn upright(strength: f32) -> Landmarks {
    let mut face = [[0.0; 2]; POINTS];
    let ring = |t: f32| {
        let (sin, cos) = kinesic::kernel::sin_cos(t);
        [cos, sin]
    };
    let turn = std::f32::consts::TAU;
    for (i, point) in face.iter_mut().enumerate() {
        let at = |first: usize, count: usize| (i - first) as f32 / (count - 1) as f32;
        *point = match i {
            0..17 => {
                let [x, y] = ring(turn / 2.0 * (1.0 - at(0, 17)));
                [x, 1.2 * y - 0.1]
            }
            17..22 => [-0.75 + 0.5 * at(17, 5), -0.45 - 0.1 * ring(turn / 2.0 * at(17, 5))[1]],
            22..27 => [0.25 + 0.5 * at(22, 5), -0.45 - 0.1 * ring(turn / 2.0 * at(22, 5))[1]],
            27..31 => [0.0, -0.25 + 0.4 * at(27, 4)],
            31..36 => [-0.17 + 0.34 * at(31, 5), 0.25],
            36..48 => {
                let (middle, first) = if i < 42 { (-0.45, 36) } else { (0.45, 42) };
                let [x, y] = ring(turn / 2.0 + turn * (i - first) as f32 / 6.0);
                [middle + 0.15 * x, -0.22 + (0.06 - 0.015 * strength) * y]
            }
            _ => {
                let (first, count, size) = if i < 60 { (48, 12.0, [0.36, 0.14]) } else { (60, 8.0, [0.3, 0.05]) };
                let [x, y] = ring(turn / 2.0 + turn * (i - first) as f32 / count);
                let wide = (1.0 + 0.3 * strength) * size[0] * x;
                [wide, 0.6 + size[1] * y - 0.12 * strength * x * x]
            }
        };
    }
    face
}

/// `count` faces of `count / 4` people, labelled 0 and 1 by how much they smile.
pub fn faces(count: usize, random: &mut ChaCha8Rng) -> Vec<Face> {
    let one = |i: usize| {
        let strength = random.random_range(0.0..1.0);
        let yaw = random.random_range(-1.0..1.0);
        let label = if strength + random.random_range(-0.1f32..0.1) > 0.5 { 1.0 } else { 0.0 };
        Face {
            picture: format!("{i}.png"),
            person: format!("p{}", i / 4),
            label: Some(label),
            landmarks: landmarks(strength, yaw, random),
            line: i as u64 + 2,
        }
    };
    (0..count).map(one).collect()
}

/// A model of the paper's size whose numbers are drawn, not trained: what an update costs depends on its shape alone.
pub fn model(clusters: usize, units: usize, random: &mut ChaCha8Rng) -> FaceModel {
    let cluster = |_| {
        // Around a face's contour, so that every cluster has faces.
        let face = landmarks(0.5, random.random_range(-1.0..1.0), random);
        let contour = FaceFrame::of(&face).map_or([[0.0; 2]; CONTOUR], |frame| frame.contour(&face));
        let mut drawn = |size: f32| random.random_range(-size..size);
        let mut shape = |size: f32| {
            let mut shape = [[0.0; 2]; MOVING];
            shape.as_flattened_mut().iter_mut().for_each(|x| *x = drawn(size));
            shape
        };
        let (rank, linear, output_bias) = (shape(0.3), shape(0.05), shape(1.0));
        let hidden = (0..units).map(|_| [drawn(2.0), drawn(1.0)]).collect();
        let output = (0..FEATURES * units).map(|_| drawn(0.05)).collect();
        ClusterModel { contour, rank, rank_bias: drawn(0.3), linear, hidden, output, output_bias }
    };
    FaceModel { attribute: "made".to_owned(), strength: [-5.0, 5.0], clusters: (0..clusters).map(cluster).collect() }
}
