//! The displacement on a grid, bilinear in between.

use nalgebra::Vector2;
use rayon::prelude::*;

use super::region::Region;

/// Cells in the face's unit.
const CELLS: f64 = 48.0;

/// Displacements at the nodes of a grid around the face; 0 on its border and beyond.
#[derive(Clone, Debug)]
pub(super) struct Grid {
    origin: Vector2<f64>,
    cell: f64,
    columns: usize,
    rows: usize,
    nodes: Vec<Vector2<f64>>,
    least_jacobian: f64,
}

impl Grid {
    /// `displacement` times the region's window at every node.
    pub fn new(region: &Region, scale: f64, displacement: impl Fn(&Vector2<f64>) -> Vector2<f64> + Sync) -> Self {
        let [low, high] = region.bounds();
        let cell = scale / CELLS;
        // One node more on each side, where the window is 0.
        let origin = low - Vector2::repeat(cell);
        let count = |from: f64, to: f64| ((to - from) / cell).ceil() as usize + 2;
        let (columns, rows) = (count(origin.x, high.x), count(origin.y, high.y));
        let node = |at: usize| {
            let place = origin + cell * Vector2::new((at % columns) as f64, (at / columns) as f64);
            let window = region.window(&place);
            if window > 0.0 { window * displacement(&place) } else { Vector2::zeros() }
        };
        let nodes = (0..columns * rows).into_par_iter().map(node).collect();
        let mut grid = Self { origin, cell, columns, rows, nodes, least_jacobian: 1.0 };
        grid.least_jacobian = grid.jacobian();
        grid
    }

    /// Least determinant of the Jacobian of `y + u(y)`, over the whole plane.
    ///
    /// In a cell the map is bilinear and its determinant linear in each coordinate, so that the least is at a corner. Where it
    /// is positive in every cell, and the border stays, the map is one to one.
    pub fn least_jacobian(&self) -> f64 {
        self.least_jacobian
    }

    fn jacobian(&self) -> f64 {
        let cell = |row: usize, column: usize| {
            let at = |r: usize, c: usize| self.nodes[(row + r) * self.columns + column + c] / self.cell;
            let across = [at(0, 1) - at(0, 0), at(1, 1) - at(1, 0)].map(|d| d + Vector2::x());
            let down = [at(1, 0) - at(0, 0), at(1, 1) - at(0, 1)].map(|d| d + Vector2::y());
            across.iter().flat_map(|a| down.iter().map(move |d| a.perp(d))).fold(f64::INFINITY, f64::min)
        };
        let row = |row: usize| (0..self.columns - 1).map(|column| cell(row, column)).fold(1.0, f64::min);
        (0..self.rows - 1).map(row).fold(1.0, f64::min)
    }

    /// First and last node.
    pub fn bounds(&self) -> [Vector2<f64>; 2] {
        let size = Vector2::new((self.columns - 1) as f64, (self.rows - 1) as f64);
        [self.origin, self.origin + self.cell * size]
    }

    /// The displacement at a place.
    pub fn at(&self, place: Vector2<f64>) -> Vector2<f64> {
        let at = (place - self.origin) / self.cell;
        let inside = |x: f64, count: usize| x >= 0.0 && x < (count - 1) as f64;
        if !(inside(at.x, self.columns) && inside(at.y, self.rows)) {
            return Vector2::zeros();
        }
        let (column, row) = (at.x as usize, at.y as usize);
        let (right, down) = (at.x - column as f64, at.y - row as f64);
        let node = |r: usize, c: usize| self.nodes[(row + r) * self.columns + column + c];
        let across = |r: usize| node(r, 0) + (node(r, 1) - node(r, 0)) * right;
        across(0) + (across(1) - across(0)) * down
    }
}
