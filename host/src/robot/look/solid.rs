//! Triangles: of boxes, ellipsoids, cylinders and capsules, and fewer of them.

use std::collections::{HashMap, HashSet};
use std::f64::consts::{PI, TAU};

use nalgebra::{Isometry3, Vector3};

/// Sides of what is round.
const SIDES: usize = 14;
/// Rows of an ellipsoid between its poles.
const ROWS: usize = 7;

/// Triangles in a link's frame, seen from outside in counter-clockwise order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Solid {
    /// m.
    pub vertices: Vec<Vector3<f64>>,
    /// Indices of vertices.
    pub triangles: Vec<[usize; 3]>,
    /// Red, green, blue, 0 to 1; none where nobody says it.
    pub colour: Option<[f64; 3]>,
}

impl Solid {
    /// A box with these edges, m, about the origin.
    pub fn cuboid(size: &Vector3<f64>) -> Self {
        let [x, y, z] = (size / 2.0).into();
        Self::between([[x, y], [-x, y], [-x, -y], [x, -y]].map(|[x, y]| [x, y].into()).to_vec(), [-z, z], [1.0, 1.0])
    }

    /// A cylinder along Z about the origin, m.
    pub fn cylinder(radius: f64, length: f64) -> Self {
        Self::between(ring(radius), [-length / 2.0, length / 2.0], [1.0, 1.0])
    }

    /// An ellipsoid about the origin with these half axes, m.
    pub fn ellipsoid(half: &Vector3<f64>) -> Self {
        let mut solid = Self::rounded(1.0, 0.0);
        solid.vertices.iter_mut().for_each(|vertex| *vertex = vertex.component_mul(half));
        solid
    }

    /// A cylinder along Z with round ends, m; `length` is that of the cylinder alone.
    pub fn capsule(radius: f64, length: f64) -> Self {
        Self::rounded(radius, length)
    }

    /// A bone from the origin to `to`: a thin pyramid of four sides on a short one.
    pub fn bone(to: &Vector3<f64>, half_width: f64) -> Self {
        let length = to.norm();
        let square =
            [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]].map(|[x, y]| (half_width * x, half_width * y));
        let ring = square.map(|(x, y)| nalgebra::Vector2::new(x, y)).to_vec();
        let turn = nalgebra::UnitQuaternion::rotation_between(&Vector3::z(), to)
            .unwrap_or_else(|| nalgebra::UnitQuaternion::from_axis_angle(&Vector3::x_axis(), PI));
        Self::between(ring, [0.0, length], [1.0, 0.55]).placed(&Isometry3::from_parts(Vector3::zeros().into(), turn))
    }

    /// Two rings at heights, the first one's corners times `scale`, with lids.
    fn between(ring: Vec<nalgebra::Vector2<f64>>, heights: [f64; 2], scale: [f64; 2]) -> Self {
        let n = ring.len();
        let at = |end: usize| ring.iter().map(move |corner| Vector3::new(corner.x, corner.y, 0.0) * scale[end]);
        let raised = |end: usize| at(end).map(move |corner| corner + Vector3::z() * heights[end]);
        let vertices = raised(0).chain(raised(1)).collect();
        let mut triangles = Vec::with_capacity(4 * n);
        for side in 0..n {
            let next = (side + 1) % n;
            triangles.extend([[side, next, n + next], [side, n + next, n + side]]);
        }
        for corner in 1..n - 1 {
            triangles.extend([[0, corner + 1, corner], [n, n + corner, n + corner + 1]]);
        }
        Self { vertices, triangles, colour: None }
    }

    /// Half a ball, a cylinder, half a ball.
    fn rounded(radius: f64, length: f64) -> Self {
        let mut vertices = vec![Vector3::z() * -(radius + length / 2.0)];
        for row in 1..=ROWS {
            let up = PI * (row as f64 / (ROWS + 1) as f64 - 0.5);
            // The middle row is there twice where there is a cylinder.
            let shifts: &[f64] = match (2 * row).cmp(&(ROWS + 1)) {
                std::cmp::Ordering::Less => &[-0.5],
                std::cmp::Ordering::Equal if length > 0.0 => &[-0.5, 0.5],
                _ => &[0.5],
            };
            for shift in shifts {
                let lift = Vector3::z() * (radius * up.sin() + shift * length);
                vertices
                    .extend(ring(radius * up.cos()).iter().map(|corner| Vector3::new(corner.x, corner.y, 0.0) + lift));
            }
        }
        let rows = (vertices.len() - 1) / SIDES;
        vertices.push(Vector3::z() * (radius + length / 2.0));
        let top = vertices.len() - 1;
        let mut triangles = Vec::new();
        for side in 0..SIDES {
            let next = (side + 1) % SIDES;
            let at = |row: usize, side: usize| 1 + row * SIDES + side;
            triangles.extend([[0, at(0, next), at(0, side)], [top, at(rows - 1, side), at(rows - 1, next)]]);
            for row in 0..rows - 1 {
                let [a, b, c, d] = [at(row, side), at(row, next), at(row + 1, next), at(row + 1, side)];
                triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
        Self { vertices, triangles, colour: None }
    }

    /// In the frame in which its own is `at`.
    pub fn placed(mut self, at: &Isometry3<f64>) -> Self {
        self.vertices.iter_mut().for_each(|vertex| *vertex = (at * nalgebra::Point3::from(*vertex)).coords);
        self
    }

    /// Of this colour.
    pub fn coloured(self, colour: Option<[f64; 3]>) -> Self {
        Self { colour, ..self }
    }

    /// Fewer triangles: the vertices of a cell of this width, m, become one, their mean. What is smaller than a cell vanishes.
    pub fn coarser(&self, cell: f64) -> Self {
        let mut cells: HashMap<[i64; 3], usize> = HashMap::new();
        let (mut sums, mut of) = (Vec::<(Vector3<f64>, f64)>::new(), Vec::with_capacity(self.vertices.len()));
        for vertex in &self.vertices {
            let next = sums.len();
            let at = *cells.entry(vertex.map(|x| (x / cell).floor() as i64).into()).or_insert(next);
            if at == next {
                sums.push((Vector3::zeros(), 0.0));
            }
            sums[at] = (sums[at].0 + vertex, sums[at].1 + 1.0);
            of.push(at);
        }
        let merged = self.triangles.iter().map(|triangle| triangle.map(|vertex| of[vertex]));
        let mut known = HashSet::new();
        let triangles: Vec<[usize; 3]> = merged
            .filter(|[a, b, c]| a != b && b != c && c != a)
            .filter(|triangle| {
                let mut same = *triangle;
                same.sort_unstable();
                known.insert(same)
            })
            .collect();
        Self { vertices: sums.into_iter().map(|(sum, count)| sum / count).collect(), triangles, colour: self.colour }
            .used()
    }

    /// Whether it has an inside: nearly every edge is there in both directions. Triangles of such a solid that are seen from behind are
    /// hidden by others.
    pub fn is_closed(&self) -> bool {
        let edges = || self.triangles.iter().flat_map(|[a, b, c]| [[*a, *b], [*b, *c], [*c, *a]]);
        let all: HashSet<[usize; 2]> = edges().collect();
        let open = all.iter().filter(|[a, b]| !all.contains(&[*b, *a])).count();
        all.len() >= 12 && open * 50 <= all.len()
    }

    /// Signed volume, m^3: below 0 for a closed solid whose triangles are turned inside.
    pub fn volume(&self) -> f64 {
        let of = |triangle: &[usize; 3]| {
            let [a, b, c] = triangle.map(|at| self.vertices[at]);
            a.dot(&b.cross(&c)) / 6.0
        };
        self.triangles.iter().map(of).sum()
    }

    /// Longest edge of the box around it, m.
    pub(super) fn size(&self) -> f64 {
        let [low, high] = [f64::INFINITY, f64::NEG_INFINITY].map(Vector3::repeat);
        let [low, high] = self.vertices.iter().fold([low, high], |[low, high], v| [low.inf(v), high.sup(v)]);
        (high - low).max().max(1e-9)
    }

    /// With the triangles of a closed solid turned outside.
    fn outward(mut self) -> Self {
        if self.volume() < 0.0 {
            self.triangles.iter_mut().for_each(|[_, b, c]| std::mem::swap(b, c));
        }
        self
    }

    /// Without vertices that no triangle has.
    fn used(self) -> Self {
        let mut index = vec![usize::MAX; self.vertices.len()];
        let mut vertices = Vec::new();
        let triangles = self.triangles.iter().map(|triangle| {
            triangle.map(|vertex| {
                if index[vertex] == usize::MAX {
                    index[vertex] = vertices.len();
                    vertices.push(self.vertices[vertex]);
                }
                index[vertex]
            })
        });
        let triangles = triangles.collect();
        Self { vertices, triangles, colour: self.colour }
    }
}

/// Fewer triangles of several solids, in their order: at most `most`. Cells are smaller in small solids, by the root of how much smaller.
pub(super) fn thinned(mut solids: Vec<Solid>, most: usize) -> Vec<Solid> {
    let total = |solids: &[Solid]| solids.iter().map(|solid| solid.triangles.len()).sum::<usize>();
    let sizes: Vec<f64> = solids.iter().map(Solid::size).collect();
    let largest = sizes.iter().copied().fold(0.0, f64::max);
    let mut cell = largest / 500.0;
    while total(&solids) > most && cell > 0.0 {
        let own = |size: f64| cell * (size / largest).sqrt();
        solids = solids.iter().zip(&sizes).map(|(solid, size)| solid.coarser(own(*size))).collect();
        cell *= 1.08;
    }
    solids.into_iter().map(Solid::outward).collect()
}

fn ring(radius: f64) -> Vec<nalgebra::Vector2<f64>> {
    let corner = |side: usize| {
        let (sin, cos) = (TAU * side as f64 / SIDES as f64).sin_cos();
        nalgebra::Vector2::new(radius * cos, radius * sin)
    };
    (0..SIDES).map(corner).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every edge is there once in each direction.
    fn closed(solid: &Solid) -> bool {
        let edges = solid.triangles.iter().flat_map(|[a, b, c]| [[*a, *b], [*b, *c], [*c, *a]]);
        let all: HashSet<[usize; 2]> = edges.collect();
        all.len() == 3 * solid.triangles.len() && all.iter().all(|[a, b]| all.contains(&[*b, *a]))
    }

    #[test]
    fn solids_are_closed_and_have_their_volume() {
        let half = Vector3::new(0.1, 0.2, 0.3);
        let solids = [
            (Solid::cuboid(&(2.0 * half)), 0.048, 1e-9),
            (Solid::cylinder(0.1, 0.5), PI * 0.005, 0.04),
            (Solid::ellipsoid(&half), 4.0 / 3.0 * PI * 0.006, 0.12),
            (Solid::capsule(0.1, 0.5), PI * (0.005 + 0.004 / 3.0), 0.06),
            (Solid::bone(&Vector3::new(0.0, 0.0, -1.0), 0.05), 0.01 * (1.0 + 0.55 + 0.55 * 0.55) / 3.0, 1e-9),
        ];
        for (at, (solid, expected, off)) in solids.into_iter().enumerate() {
            assert!(closed(&solid), "{at}");
            assert!(solid.is_closed(), "{at}");
            let found = solid.volume();
            assert!((found / expected - 1.0).abs() <= off, "{at}: {found} {expected}");
        }
    }

    #[test]
    fn a_coarser_solid_is_smaller_in_number_and_the_same_in_size() {
        let ball = Solid::ellipsoid(&Vector3::repeat(0.1));
        let fewer = thinned(vec![ball.clone()], 60);
        assert!(fewer[0].triangles.len() <= 60 && !fewer[0].triangles.is_empty());
        assert!((fewer[0].volume() / ball.volume() - 1.0).abs() < 0.35, "{}", fewer[0].volume());
        // Separate triangles, as an STL has them, are joined where they meet.
        let apart = Solid {
            vertices: ball.triangles.iter().flatten().map(|at| ball.vertices[*at]).collect(),
            triangles: (0..ball.triangles.len()).map(|at| [3 * at, 3 * at + 1, 3 * at + 2]).collect(),
            colour: None,
        };
        let joined = apart.coarser(1e-6);
        assert!(closed(&joined) && joined.triangles.len() == ball.triangles.len());
        assert!(!apart.is_closed(), "triangles alone");
        // Mirrored ones are turned outside.
        let mirrored = Solid { vertices: ball.vertices.iter().map(|v| Vector3::new(-v.x, v.y, v.z)).collect(), ..ball };
        assert!(mirrored.volume() < 0.0 && thinned(vec![mirrored], 1000)[0].volume() > 0.0);
    }
}
