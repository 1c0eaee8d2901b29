//! Matrix x vector with the weights stored in the order in which they are read.

use core::num::NonZeroUsize;

use kinesic_kernel_arch::column_tile;

use crate::model::{LoadError, Pack};

/// Rows of one tile.
pub const ROWS: usize = 8;

/// A matrix stored as tiles of [`ROWS`] rows, columns in order: `tile[t][column][row in tile]`.
///
/// One tile column is 32 bytes: a single block load feeds eight accumulators. Rows past the last one are zero.
#[derive(Clone, Copy, Debug)]
pub struct Tiled<'a> {
    columns: NonZeroUsize,
    tiles: &'a [[f32; ROWS]],
}

impl<'a> Tiled<'a> {
    /// A view of `ceil(rows / 8) * columns` tile columns; `None` unless the shape fits.
    pub fn new(rows: usize, columns: usize, tiles: &'a [[f32; ROWS]]) -> Option<Self> {
        let columns = NonZeroUsize::new(columns)?;
        let expected = rows.div_ceil(ROWS).checked_mul(columns.get())?;
        (expected == tiles.len()).then_some(Self { columns, tiles })
    }

    /// The matrix `name` of a pack, `rows x columns`.
    pub fn load(pack: &Pack<'a>, name: &'static str, rows: usize, columns: usize) -> Result<Self, LoadError> {
        let expected = rows.div_ceil(ROWS).saturating_mul(columns);
        let tiles = pack.slice(name, expected)?;
        Self::new(rows, columns, tiles).ok_or(LoadError::Shape { tensor: name, found: tiles.len(), expected })
    }

    /// Number of columns.
    pub fn columns(&self) -> usize {
        self.columns.get()
    }

    /// Part `index` of a matrix whose parts of `tiles` tiles of rows lie one below the other; `None` past the last one.
    pub fn part(&self, tiles: usize, index: usize) -> Option<Self> {
        let count = tiles.checked_mul(self.columns.get()).filter(|count| *count > 0)?;
        Some(Self { tiles: self.tiles.chunks_exact(count).nth(index)?, ..*self })
    }

    /// `y += W x`. Cost: `rows` (rounded up to 8) x `columns` multiply-adds.
    #[inline(never)]
    pub fn multiply_add(&self, x: &[f32], y: &mut [f32]) {
        for (sums, y) in self.sums(x).zip(y.chunks_mut(ROWS)) {
            for (y, sum) in y.iter_mut().zip(sums) {
                *y += sum;
            }
        }
    }

    /// `W x`, a tile of rows after the other.
    #[inline]
    pub fn sums<'x>(&self, x: &'x [f32]) -> impl Iterator<Item = [f32; ROWS]> + use<'a, 'x> {
        self.tiles.chunks_exact(self.columns.get()).map(move |tile| column_tile(tile, x))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn multiplies_like_the_definition() {
        // 9 x 2: one full tile and one row of the next.
        let entry = |row: usize, column: usize| (row * 2 + column) as f32 - 5.0;
        let mut tiles = [[0.0; ROWS]; 4];
        for row in 0..9 {
            for column in 0..2 {
                tiles[row / ROWS * 2 + column][row % ROWS] = entry(row, column);
            }
        }
        let matrix = Tiled::new(9, 2, &tiles).unwrap();
        let mut y = [1.0; 9];
        matrix.multiply_add(&[2.0, -3.0], &mut y);
        for (row, y) in y.iter().enumerate() {
            assert_eq!(*y, 1.0 + 2.0 * entry(row, 0) - 3.0 * entry(row, 1));
        }
    }

    #[test]
    fn a_part_is_a_matrix_of_its_own() {
        let tiles: [[f32; ROWS]; 6] = core::array::from_fn(|tile| [tile as f32; ROWS]);
        let matrix = Tiled::new(24, 2, &tiles).unwrap();
        let mut y = [0.0; ROWS];
        matrix.part(1, 2).unwrap().multiply_add(&[1.0, 10.0], &mut y);
        assert_eq!(y, [54.0; ROWS]);
        assert!(matrix.part(1, 3).is_none() && matrix.part(0, 0).is_none() && matrix.part(usize::MAX, 0).is_none());
    }

    #[test]
    fn refuses_a_shape_that_does_not_fit() {
        let tiles = [[0.0; ROWS]; 4];
        assert!(Tiled::new(9, 2, &tiles).is_some());
        assert!(Tiled::new(17, 2, &tiles).is_none());
        assert!(Tiled::new(9, 0, &[]).is_none());
        assert!(Tiled::new(usize::MAX, usize::MAX, &tiles).is_none());
    }
}
