//! What a translator of several actions adds for the one that it sees: a low-rank output stage a cluster of its [gate](super::gate).

use super::gate::{Gate, Sight};
use crate::kernel::{ROWS as TILE, Tiled};
use crate::model::{LoadError, Pack, TranslatorMeta};

/// Most directions in which experts write.
const RANK: usize = 4 * TILE;

#[derive(Clone, Copy, Debug)]
pub(super) struct Experts<'a> {
    rank: usize,
    /// States and principal coordinates that an expert reads.
    reads: usize,
    /// `rank x (states + drives)` of each expert, one below the other: whole tiles.
    input: Tiled<'a>,
    /// `rank` of each expert.
    bias: &'a [f32],
    /// Rows from the directions, `3 rows x rank`, rad or m.
    output: Tiled<'a>,
}

impl<'a> Experts<'a> {
    /// `None` for a pack of one action.
    pub fn load(
        pack: &Pack<'a>,
        meta: &TranslatorMeta,
        gate: Option<&Gate>,
        rows: usize,
    ) -> Result<Option<Self>, LoadError> {
        let tensor = "translate/expert_bias";
        let found = match pack.rows(tensor) {
            Err(LoadError::NoTensor { .. }) => return Ok(None),
            found => found?,
        };
        let count = gate.map_or(0, Gate::count);
        let rank = found.checked_div(count).unwrap_or(0);
        if rank == 0 || !rank.is_multiple_of(TILE) || rank > RANK {
            return Err(LoadError::Shape { tensor, found, expected: TILE * count });
        }
        let reads = 2 * meta.blocks as usize + meta.drives as usize;
        Ok(Some(Self {
            rank,
            reads,
            input: Tiled::load(pack, "translate/expert_input", count * rank, reads)?,
            bias: pack.slice(tensor, count * rank)?,
            output: Tiled::load(pack, "translate/expert_output", 3 * rows, rank)?,
        }))
    }

    /// Multiply-adds of one frame.
    pub fn multiply_adds(&self, rows: usize) -> usize {
        2 * self.rank * (self.reads + 1) + 3 * rows * self.rank
    }

    /// `y += P sum w (M [x; p] + b)` over the two experts that are near.
    #[inline(never)]
    pub fn add(&self, sight: &Sight, filters: &[f32], output: &mut [[f32; 3]]) {
        let mut sum = [0.0; RANK];
        let filters = filters.get(..self.reads).unwrap_or_default();
        for (expert, weight) in sight.near {
            let (Some(matrix), Some(bias)) =
                (self.input.part(self.rank / TILE, expert), self.bias.chunks_exact(self.rank.max(1)).nth(expert))
            else {
                continue;
            };
            let mut own = [0.0; RANK];
            own.iter_mut().zip(bias).for_each(|(own, bias)| *own = *bias);
            matrix.multiply_add(filters, &mut own);
            sum.iter_mut().zip(own).for_each(|(sum, own)| *sum += weight * own);
        }
        self.output.multiply_add(sum.get(..self.rank).unwrap_or_default(), output.as_flattened_mut());
    }
}
