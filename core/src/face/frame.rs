//! The face's own frame: where it is, how large, how rolled; and the landmarks in it.

use super::{CONTOUR, Landmarks, MOVING};
use crate::kernel::sqrt;

/// Which landmarks move, region by region: right eye with brow, left eye with brow, nose, mouth without its inner corners.
pub const INNER: [u8; MOVING] = [
    17, 18, 19, 20, 21, 36, 37, 38, 39, 40, 41, // right eye and brow
    22, 23, 24, 25, 26, 42, 43, 44, 45, 46, 47, // left eye and brow
    27, 28, 29, 30, 31, 32, 33, 34, 35, // nose
    48, 49, 50, 51, 52, 53, 54, 55, 56, 57, 58, 59, 61, 62, 63, 65, 66, 67, // mouth
];

/// The moving landmarks in the face's frame, in the order of [`INNER`].
pub type Shape = [[f32; 2]; MOVING];

/// Similarity between picture and face: origin at the mean of the moving landmarks, x along the line through the eyes, unit
/// their root mean square distance from the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaceFrame {
    origin: [f32; 2],
    /// Cosine and sine of the roll.
    roll: [f32; 2],
    scale: f32,
}

impl FaceFrame {
    /// The frame of a face; `None` where the landmarks are none: not finite, in one place, or with the eyes in one place.
    /// Cost: about 350 multiply-adds and two square roots.
    pub fn of(landmarks: &Landmarks) -> Option<Self> {
        let right = mean(landmarks, 36, 6);
        let left = mean(landmarks, 42, 6);
        let [x, y] = [left[0] - right[0], left[1] - right[1]];
        let apart = sqrt(x * x + y * y);
        let origin = mean_of(inner(landmarks));
        let mut squares = 0.0;
        for [x, y] in inner(landmarks) {
            let (x, y) = (x - origin[0], y - origin[1]);
            squares = squares + x * x + y * y;
        }
        let scale = sqrt(squares / MOVING as f32);
        let sound = landmarks.iter().flatten().all(|x| x.is_finite())
            && scale.is_finite()
            && scale > f32::MIN_POSITIVE
            && apart > 1e-3 * scale;
        sound.then(|| Self { origin, roll: [x / apart, y / apart], scale })
    }

    /// Length of the unit in the picture.
    pub fn scale(&self) -> f32 {
        self.scale
    }

    /// The moving landmarks in this frame.
    pub fn shape(&self, landmarks: &Landmarks) -> Shape {
        let mut shape = [[0.0; 2]; MOVING];
        for (to, from) in shape.iter_mut().zip(inner(landmarks)) {
            *to = self.inward(from);
        }
        shape
    }

    /// The contour, rolled upright, its mean removed, in units of its root mean square distance from it: head pose, and not how
    /// large the face is or where. Zeros where all its points are in one place.
    pub fn contour(&self, landmarks: &Landmarks) -> [[f32; 2]; CONTOUR] {
        let mut contour = [[0.0; 2]; CONTOUR];
        for (to, from) in contour.iter_mut().zip(landmarks) {
            *to = self.inward(*from);
        }
        let middle = mean_of(contour.iter().copied());
        let mut squares = 0.0;
        for [x, y] in &mut contour {
            *x -= middle[0];
            *y -= middle[1];
            squares = squares + *x * *x + *y * *y;
        }
        let scale = sqrt(squares / CONTOUR as f32);
        let inverse = if scale > f32::MIN_POSITIVE { 1.0 / scale } else { 0.0 };
        for value in contour.as_flattened_mut() {
            *value *= inverse;
        }
        contour
    }

    /// An offset in this frame as an offset in the picture.
    pub fn outward(&self, [x, y]: [f32; 2]) -> [f32; 2] {
        let [cos, sin] = self.roll;
        [self.scale * (cos * x - sin * y), self.scale * (sin * x + cos * y)]
    }

    /// A point of the picture in this frame.
    fn inward(&self, [x, y]: [f32; 2]) -> [f32; 2] {
        let [cos, sin] = self.roll;
        let (x, y) = (x - self.origin[0], y - self.origin[1]);
        [(cos * x + sin * y) / self.scale, (cos * y - sin * x) / self.scale]
    }
}

/// The moving landmarks in the order of [`INNER`].
fn inner(landmarks: &Landmarks) -> impl Iterator<Item = [f32; 2]> {
    INNER.iter().map(|at| landmarks.get(usize::from(*at)).copied().unwrap_or_default())
}

fn mean(landmarks: &Landmarks, first: usize, count: usize) -> [f32; 2] {
    mean_of(landmarks.iter().skip(first).take(count).copied())
}

fn mean_of(points: impl Iterator<Item = [f32; 2]>) -> [f32; 2] {
    let (mut sum, mut count) = ([0.0, 0.0], 0.0);
    for [x, y] in points {
        sum = [sum[0] + x, sum[1] + y];
        count += 1.0;
    }
    [sum[0] / count, sum[1] / count]
}
