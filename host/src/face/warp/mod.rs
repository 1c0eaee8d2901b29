//! Moves the landmarks of a picture: a smooth map of the face that has no hole and no fold, and is the identity outside of it.
//!
//! | file | holds |
//! |---|---|
//! | `region` | the face: hull of landmarks and forehead, and the window that vanishes at its edge |
//! | `spline` | displacement between landmarks: radial basis functions of compact support |
//! | `grid` | the displacement on a grid, bilinear in between; the least Jacobian, exactly |
//! | `resample` | bicubic sampling, for every pixel type |

mod grid;
mod region;
mod resample;
mod spline;

use image::DynamicImage;
use kinesic::face::{CONTOUR, FaceFrame, Landmarks, POINTS};
use nalgebra::Vector2;

use grid::Grid;
use region::Region;
use spline::Spline;

pub use resample::ResampleError;

/// Farthest that a landmark may be asked to move, in the face's unit: more than a third of the height of a face. What folds is damped anyway.
const FARTHEST: f64 = 1.5;
/// Least Jacobian that counts as unfolded; 1 is unchanged.
const UNFOLDED: f64 = 0.02;
/// First damping of the spline, and the factor by which it grows while the map folds.
const DAMPING: [f64; 2] = [1e-5, 8.0];
/// Halvings of the last step of the damping: what folds by a hair must not be damped eight times as much as its neighbour.
const HALVINGS: usize = 5;
/// Pairs of upper and lower inner lip.
const LIPS: [(usize, usize); 3] = [(61, 67), (62, 66), (63, 65)];
/// What stays of the opening of the mouth at least: lips that cross would fold the picture.
const OPENING: f64 = 0.1;

/// Why there is no warp.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum WarpError {
    /// The landmarks are no face.
    #[error("the landmarks are no face: they are not finite, or in one place")]
    NoFace,
    /// Farther than any expression moves a face.
    #[error(
        "landmark {landmark} is to move by {found:.3e} pixels, at most {most:.1} (one and a half times the unit of the face) are warped: ask for \
         less, or check the pack"
    )]
    Far {
        /// Index of the landmark.
        landmark: usize,
        /// How far, pixels.
        found: f64,
        /// The farthest, pixels.
        most: f64,
    },
    /// An offset is not a number.
    #[error("the offset of landmark {landmark} is not finite")]
    Offset {
        /// Index of the landmark.
        landmark: usize,
    },
}

/// A map from the pixels of the new picture to places in the old one.
#[derive(Clone, Debug)]
pub struct Warp {
    grid: Grid,
    missed: f64,
    damping: f64,
}

impl Warp {
    /// The map that takes every landmark to landmark + offset; contour and everything outside the face stay.
    ///
    /// The spline is damped until no place folds: at a damping large enough nothing moves, so there always is an end. Landmarks
    /// then come short of their target by at most [`missed`](Self::missed).
    pub fn new(landmarks: &Landmarks, offsets: &Landmarks) -> Result<Self, WarpError> {
        let scale = f64::from(FaceFrame::of(landmarks).ok_or(WarpError::NoFace)?.scale());
        if let Some(landmark) = offsets.iter().position(|offset| !offset.iter().all(|x| x.is_finite())) {
            return Err(WarpError::Offset { landmark });
        }
        // The region that moves grows with the offsets, and what a warp costs with the region.
        let length = |[x, y]: &[f32; 2]| f64::from(*x).hypot(f64::from(*y));
        if let Some((landmark, found)) = offsets.iter().map(length).enumerate().find(|(_, far)| *far > FARTHEST * scale)
        {
            return Err(WarpError::Far { landmark, found, most: FARTHEST * scale });
        }
        let [from, offset] = [landmarks, offsets].map(|of| of.map(|[x, y]| Vector2::new(f64::from(x), f64::from(y))));
        let to = apart(&from, &std::array::from_fn(|i| from[i] + offset[i]));
        let region = Region::new(&from, &to, scale);
        let centres: Vec<_> = to.iter().chain(region.forehead()).copied().collect();
        let wanted: Vec<_> = from.iter().zip(&to).map(|(from, to)| from - to).collect();
        let damped = |damping: f64| {
            let spline = Spline::fit(&centres, &wanted, scale, damping);
            let grid = Grid::new(&region, scale, |at| spline.at(at));
            (grid.least_jacobian() >= UNFOLDED).then_some(grid)
        };
        let [mut damping, step] = DAMPING;
        let mut grid = loop {
            match damped(damping) {
                Some(grid) => break grid,
                None => damping *= step,
            }
        };
        if damping > DAMPING[0] {
            let mut folded = damping / step;
            for _ in 0..HALVINGS {
                let middle = (folded * damping).sqrt();
                match damped(middle) {
                    Some(better) => (grid, damping) = (better, middle),
                    None => folded = middle,
                }
            }
        }
        let miss = |i: usize| (grid.at(to[i]) - wanted[i]).norm();
        let missed = (CONTOUR..POINTS).map(miss).fold(0.0, f64::max);
        Ok(Self { grid, missed, damping })
    }

    /// The picture through the map. Pixels outside the face are copied.
    pub fn apply(&self, picture: &DynamicImage) -> Result<DynamicImage, ResampleError> {
        resample::resample(picture, &self.grid)
    }

    /// Least determinant of the map's Jacobian: above 0 there is no fold.
    pub fn least_jacobian(&self) -> f64 {
        self.grid.least_jacobian()
    }

    /// Largest distance by which a landmark that was to move misses its target, in pixels of the old picture.
    pub fn missed(&self) -> f64 {
        self.missed
    }

    /// Damping at which the map does not fold; see [`new`](Self::new).
    pub fn damping(&self) -> f64 {
        self.damping
    }

    /// Least and largest corner of the box outside of which nothing moves.
    pub fn bounds(&self) -> [[f64; 2]; 2] {
        self.grid.bounds().map(Into::into)
    }

    /// Where the pixel at `[x, y]` comes from, less `[x, y]`. Exactly 0 outside the face.
    pub fn displacement(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        self.grid.at(Vector2::new(x, y)).into()
    }
}

/// The targets with lips that do not cross.
fn apart(from: &[Vector2<f64>; POINTS], to: &[Vector2<f64>; POINTS]) -> [Vector2<f64>; POINTS] {
    let mut to = *to;
    let middle = |first: usize| from[first..first + 6].iter().sum::<Vector2<f64>>() / 6.0;
    let across = (middle(42) - middle(36)).normalize();
    let down = Vector2::new(-across.y, across.x);
    for (upper, lower) in LIPS {
        let before = (from[lower] - from[upper]).dot(&down);
        let after = (to[lower] - to[upper]).dot(&down);
        // Landmarks of a closed mouth may be crossed a little as they come.
        let least = if before > 0.0 { OPENING * before } else { before };
        let lacking = (least - after).max(0.0) / 2.0;
        to[lower] += lacking * down;
        to[upper] -= lacking * down;
    }
    to
}
