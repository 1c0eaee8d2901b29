//! How matrices lie in a pack: the order in which the device's loops read them.

use kinesic::Pack;
use kinesic::kernel::{ROWS, TILE};
use kinesic::model::LoadError;

/// A layer in the integers that [`kinesic::kernel::Quantised`] reads.
#[derive(Clone, Debug)]
pub struct IntegerLayer {
    /// Tiles of 4 rows, columns in groups of four.
    pub weights: Vec<i8>,
    /// One a row, for the sum.
    pub multipliers: Vec<i32>,
    /// One a row, in units of the result.
    pub bias: Vec<i32>,
}

/// `tile[t][column][row in tile]`, rows padded with zeros to a multiple of [`ROWS`].
pub(crate) fn tile(columns: usize, row_major: &[f32]) -> Vec<f32> {
    let rows = row_major.len().checked_div(columns).unwrap_or(0);
    let mut tiles = vec![0.0; rows.next_multiple_of(ROWS) * columns];
    for (row, values) in row_major.chunks_exact(columns.max(1)).enumerate() {
        for (column, value) in values.iter().enumerate() {
            tiles[(row / ROWS * columns + column) * ROWS + row % ROWS] = *value;
        }
    }
    tiles
}

/// A tiled matrix of a pack, row-major.
pub(crate) fn row_major(pack: &Pack, name: &'static str, rows: usize, columns: usize) -> Result<Vec<f32>, LoadError> {
    let tiles: &[[f32; ROWS]] = pack.slice(name, rows.div_ceil(ROWS) * columns)?;
    let entry = |row: usize, column: usize| tiles[row / ROWS * columns + column][row % ROWS];
    Ok((0..rows).flat_map(|row| (0..columns).map(move |column| entry(row, column))).collect())
}

/// Rows of int8 weights in tiles of 4 rows, columns in groups of four, padded with zeros.
pub(crate) fn tile_bytes(columns: usize, rows: &[Vec<i8>]) -> Vec<i8> {
    let groups = columns.div_ceil(TILE);
    let mut tiles = vec![0; rows.len().div_ceil(TILE) * groups * TILE * TILE];
    for (row, values) in rows.iter().enumerate() {
        for (column, value) in values.iter().enumerate() {
            // Bytes of a word are the columns 0, 2, 1, 3 of a group: see `kinesic_kernel_arch::Weights`.
            let byte = [0, 2, 1, 3][column % TILE];
            let word = (row / TILE * groups + column / TILE) * TILE + row % TILE;
            tiles[word * TILE + byte] = *value;
        }
    }
    tiles
}
