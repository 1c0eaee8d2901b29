//! The face in the picture: what may move.

use kinesic::face::{CONTOUR, POINTS};
use nalgebra::Vector2;

/// Points of the arc over the brows.
const ARC: usize = 9;
/// Height of the arc over the highest brow, in the face's unit.
const FOREHEAD: f64 = 0.9;
/// Width of the rim in which the movement fades out, in the face's unit.
const RIM: f64 = 0.35;

/// The convex hull of landmarks and forehead.
#[derive(Clone, Debug)]
pub(super) struct Region {
    /// Corners, in the order in which the inside is always on the same side.
    hull: Vec<Vector2<f64>>,
    forehead: Vec<Vector2<f64>>,
    rim: f64,
}

impl Region {
    /// The region of a face whose landmarks move from `from` to `to`.
    pub fn new(from: &[Vector2<f64>; POINTS], to: &[Vector2<f64>; POINTS], scale: f64) -> Self {
        let (right, left) = (from[0], from[CONTOUR - 1]);
        let middle = (right + left) / 2.0;
        let mean = |points: &[Vector2<f64>]| points.iter().sum::<Vector2<f64>>() / points.len() as f64;
        let across = (mean(&from[42..48]) - mean(&from[36..42])).normalize();
        let up = Vector2::new(across.y, -across.x);
        let brows = (17..27).map(|i| (from[i] - middle).dot(&up)).fold(0.0, f64::max);
        let arc = |i: usize| {
            // Half a circle by its rational form: the same bits on every machine.
            let side = 1.0 - 2.0 * (i + 1) as f64 / (ARC + 1) as f64;
            let t = 1.0 - side.abs();
            let (sin, cos) = (2.0 * t / (1.0 + t * t), (1.0 - t * t) / (1.0 + t * t));
            // Square roots make the arc full at the temples, where the brows end.
            let along = cos.sqrt().copysign(side);
            middle + (left - middle) * along + up * ((brows + FOREHEAD * scale) * sin.sqrt())
        };
        let forehead: Vec<_> = (0..ARC).map(arc).collect();
        let corners = from.iter().chain(to).chain(&forehead).copied().collect();
        Self { hull: hull(corners), forehead, rim: RIM * scale }
    }

    /// Points of the forehead, which do not move.
    pub fn forehead(&self) -> &[Vector2<f64>] {
        &self.forehead
    }

    /// Least and largest corner of the bounding box.
    pub fn bounds(&self) -> [Vector2<f64>; 2] {
        let first = self.hull.first().copied().unwrap_or_default();
        self.hull.iter().fold([first; 2], |[low, high], corner| [low.inf(corner), high.sup(corner)])
    }

    /// 1 inside, 0 outside, smooth in the rim.
    pub fn window(&self, at: &Vector2<f64>) -> f64 {
        let next = self.hull.iter().cycle().skip(1);
        let inside = |(a, b): (&Vector2<f64>, &Vector2<f64>)| (b - a).normalize().perp(&(at - a));
        let depth = self.hull.iter().zip(next).map(inside).fold(f64::INFINITY, f64::min);
        let t = (depth / self.rim).clamp(0.0, 1.0);
        t * t * (3.0 - 2.0 * t)
    }
}

/// Convex hull (Andrew's monotone chain), corners so that `(b - a).perp(inside - a)` is positive.
fn hull(mut points: Vec<Vector2<f64>>) -> Vec<Vector2<f64>> {
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    points.dedup();
    let chain = |points: &mut dyn Iterator<Item = &Vector2<f64>>| {
        let mut chain: Vec<Vector2<f64>> = Vec::new();
        for point in points {
            while let [.., a, b] = chain[..] {
                if (b - a).perp(&(point - a)) > 0.0 {
                    break;
                }
                chain.pop();
            }
            chain.push(*point);
        }
        chain.pop();
        chain
    };
    let mut corners = chain(&mut points.iter());
    corners.extend(chain(&mut points.iter().rev()));
    corners
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hull_holds_its_corners_only() {
        let points = [[0.0, 0.0], [2.0, 0.0], [1.0, 1.0], [2.0, 2.0], [0.0, 2.0], [1.0, 0.0]].map(Vector2::from);
        let hull = hull(points.to_vec());
        assert_eq!(hull, [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]].map(Vector2::from));
        let region = Region { hull, forehead: Vec::new(), rim: 0.5 };
        let window = |x, y| region.window(&Vector2::new(x, y));
        assert_eq!([window(1.0, 1.0), window(0.0, 1.0), window(3.0, 1.0), window(0.25, 1.0)], [1.0, 0.0, 0.0, 0.5]);
    }
}
