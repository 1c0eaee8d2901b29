//! Squared distances from one frame to many, laid out so that the compiler vectorises them.

/// Frames in a tile.
pub(super) const TILE: usize = 16;

/// A clip in tiles of 16 frames: `[tile][channel][16 frames]`. One source value meets 16 target values in a row, the 16 sums
/// stay in registers, and memory is read in order. f32 halves the traffic; the caller evaluates final costs in f64.
#[derive(Debug, Clone)]
pub(super) struct Tiles {
    data: Vec<f32>,
    frames: usize,
    channels: usize,
}

impl Tiles {
    /// From `frames` rows of `channels` values each.
    pub fn new<'a>(rows: impl ExactSizeIterator<Item = &'a [f32]>, channels: usize) -> Self {
        let frames = rows.len();
        let mut data = vec![0.0; frames.div_ceil(TILE) * TILE * channels];
        for (j, row) in rows.enumerate() {
            let tile = (j / TILE) * TILE * channels + j % TILE;
            for (slot, &v) in data[tile..].iter_mut().step_by(TILE).zip(row) {
                *slot = v;
            }
        }
        Self { data, frames, channels }
    }

    pub fn frames(&self) -> usize {
        self.frames
    }

    /// Distance from `row` to one frame, summed in f64.
    pub fn distance(&self, row: &[f32], frame: usize) -> f64 {
        let at = (frame / TILE) * TILE * self.channels + frame % TILE;
        let values = self.data.get(at..).unwrap_or(&[]).iter().step_by(TILE);
        row.iter().zip(values).map(|(&p, &v)| f64::from(p - v).powi(2)).sum()
    }

    /// Distances from `row` to the frames `first_tile * 16 ..`, as many as `out` has room for. O(out x channels).
    pub fn distances(&self, row: &[f32], first_tile: usize, out: &mut [f32]) {
        let size = TILE * self.channels;
        let tiles = self.data[first_tile * size..].chunks_exact(size);
        let (out, _) = out.as_chunks_mut::<TILE>();
        for (out, tile) in out.iter_mut().zip(tiles) {
            let mut sum = [0.0f32; TILE];
            for (values, &p) in tile.as_chunks::<TILE>().0.iter().zip(row) {
                for (s, &v) in sum.iter_mut().zip(values) {
                    let d = p - v;
                    *s += d * d;
                }
            }
            *out = sum;
        }
    }
}
