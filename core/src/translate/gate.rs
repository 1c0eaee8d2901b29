//! What the body is doing, beside what it did in the training: how familiar a frame is, and which of several experts know it.
//!
//! A few features of the input are smoothed, and so is how fast they change: a point. The training's points make clusters. Novelty `n` is
//! the squared distance to the nearest cluster, in units of what the training allows; the style counts `1 / (1 + n^8)`, and for the rest a
//! change that suits any motion. Experts are weighted by how much nearer than the third nearest cluster their own is.

use crate::kernel::{ROWS as TILE, Tiled};
use crate::model::{LoadError, Pack};

/// The tensor that only a pack with a gate has: a factor for each feature.
pub(super) const PRESENT: &str = "translate/gate_speed";
/// Most features: one tile of the projection.
const FEATURES: usize = TILE;
/// Words before those of the features: started or not, novelty, and how familiar the last second was.
const HEAD: usize = 3;
/// Words of a feature: its last value, and what is smoothed of it and of its speed.
const MEMORY: usize = 3;
/// Novelties beyond are this one.
const LARGEST: f32 = 1e6;
/// Rate at which the last second is remembered, in rates of novelty.
const SECOND: f32 = 0.1;
/// How familiar the last second must be for any of the style's travel, and 1 / how much more for all of it.
const TRAVEL: [f32; 2] = [0.5, 1.0 / 0.4];

#[derive(Clone, Copy, Debug)]
pub(super) struct Gate<'a> {
    /// Features from the normalised input, `features x 3 rows`.
    project: Tiled<'a>,
    /// Factor of each feature's change in a frame.
    speed: &'a [f32],
    /// A cluster after the other: of each feature where it is and how fast it changes.
    centres: &'a [[f32; 2]],
    /// Part that a smoothed feature, speed and novelty take of a new value; 1 / the novelty at which half of the style counts.
    rates: [f32; 4],
    /// Change that suits any motion, `rows`, rad or m.
    coarse: &'a [[f32; 3]],
}

/// What a gate makes of a frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sight {
    /// Part of the style that counts, 0 to 1.
    pub familiar: f32,
    /// Part of that which counts for travel: one step that looks familiar carries nobody away.
    pub travel: f32,
    /// The two nearest clusters and their weights, which add up to 1.
    pub near: [(usize, f32); 2],
}

impl<'a> Gate<'a> {
    /// The gate of a pack in which [`PRESENT`] has so many `features`.
    pub fn load(pack: &Pack<'a>, features: usize, rows: usize) -> Result<Self, LoadError> {
        if features == 0 || features > FEATURES {
            return Err(LoadError::Shape { tensor: PRESENT, found: features, expected: FEATURES });
        }
        let tensor = "translate/gate_centres";
        let numbers = pack.rows(tensor)?;
        // The weights of two clusters need a third.
        let count = numbers / features;
        if count < 3 {
            return Err(LoadError::Shape { tensor, found: numbers, expected: 3 * features });
        }
        let rates = match pack.slice::<[f32; 4]>("translate/gate_rates", 1)? {
            [rates] => *rates,
            _ => [0.0; 4],
        };
        let [feature, speed, novelty, inverse] = rates;
        let wild = [feature, speed, novelty].iter().position(|rate| !(0.0..=1.0).contains(rate));
        if let Some(index) = wild.or((inverse < 0.0).then_some(3)) {
            return Err(LoadError::Value { tensor: "translate/gate_rates", index });
        }
        Ok(Self {
            project: Tiled::load(pack, "translate/gate_project", features, 3 * rows)?,
            speed: pack.slice(PRESENT, features)?,
            centres: pack.slice(tensor, count * features)?,
            rates,
            coarse: pack.slice("translate/gate_coarse", rows)?,
        })
    }

    /// Clusters.
    pub fn count(&self) -> usize {
        self.centres.len() / self.speed.len().max(1)
    }

    /// Words that it remembers.
    pub fn words(&self) -> usize {
        HEAD + MEMORY * self.speed.len()
    }

    /// Multiply-adds of one frame.
    pub fn multiply_adds(&self) -> usize {
        TILE * self.project.columns() + 4 * self.centres.len() + 6 * self.coarse.len()
    }

    /// Looks at a frame. `memory` has [`words`](Self::words) words; all zero, it begins with this frame, as if it had been held.
    #[inline(never)]
    pub fn look(&self, input: &[[f32; 3]], memory: &mut [f32]) -> Sight {
        let mut features = [0.0; FEATURES];
        self.project.multiply_add(input.as_flattened(), &mut features);
        let Some(([started, novelty, second], memory)) = memory.split_first_chunk_mut::<HEAD>() else {
            return Sight::EVERYTHING;
        };
        let own = memory.as_chunks_mut::<MEMORY>().0;
        let [feature_rate, speed_rate, novelty_rate, inverse] = self.rates;
        let first = *started == 0.0;
        for (([last, slow, speed], now), scale) in own.iter_mut().zip(features).zip(self.speed) {
            if first {
                (*last, *slow, *speed) = (now, now, 0.0);
            }
            let change = (now - *last).abs() * scale;
            *slow += feature_rate * (now - *slow);
            *speed += speed_rate * (change - *speed);
            *last = now;
        }
        *started = 1.0;
        let [(a, first_near), (b, second_near), (c, _)] = self.nearest(own);
        let distance = a.min(LARGEST);
        *novelty = if first { distance } else { *novelty + novelty_rate * (distance - *novelty) };
        // Sharp, so that what is between counts one way or the other.
        let square = (*novelty * inverse) * (*novelty * inverse);
        let fourth = square * square;
        let [of_first, of_second] = [(c - a) * (c - a), (c - b) * (c - b)];
        let sum = of_first + of_second;
        let part = if sum > 0.0 && sum.is_finite() { of_first / sum } else { 0.5 };
        let familiar = 1.0 / (1.0 + fourth * fourth);
        *second = if first { familiar } else { *second + SECOND * novelty_rate * (familiar - *second) };
        let [least, steep] = TRAVEL;
        let travel = ((*second - least) * steep).clamp(0.0, 1.0);
        Sight { familiar, travel, near: [(first_near, part), (second_near, 1.0 - part)] }
    }

    /// Squared distances and numbers of the three nearest clusters, the nearest first.
    fn nearest(&self, own: &[[f32; MEMORY]]) -> [(f32, usize); 3] {
        let mut near = [(f32::MAX, 0); 3];
        for (index, centre) in self.centres.chunks_exact(self.speed.len().max(1)).enumerate() {
            let mut sum = 0.0;
            for ([_, slow, speed], [at, rate]) in own.iter().zip(centre) {
                sum += (slow - at) * (slow - at) + (speed - rate) * (speed - rate);
            }
            let [first, second, third] = near;
            let new = (sum, index);
            near = if sum < first.0 {
                [new, first, second]
            } else if sum < second.0 {
                [first, new, second]
            } else if sum < third.0 {
                [first, second, new]
            } else {
                near
            };
        }
        near
    }

    /// What counts of the style, and of the change that suits any motion: `output` is what the style makes of `rows`.
    pub fn fade(&self, sight: &Sight, rows: &[[f32; 3]], output: &mut [[f32; 3]]) {
        let Sight { familiar, travel, .. } = *sight;
        let strange = 1.0 - familiar;
        if let (Some([x, _, z]), Some([from_x, _, from_z])) = (output.first_mut(), rows.first()) {
            (*x, *z) = (from_x + travel * (*x - from_x), from_z + travel * (*z - from_z));
        }
        for ((y, x), coarse) in output.iter_mut().zip(rows).zip(self.coarse) {
            for ((y, x), coarse) in y.iter_mut().zip(x).zip(coarse) {
                *y = x + (familiar * (*y - x) + strange * coarse);
            }
        }
    }
}

impl Sight {
    /// Everything is familiar.
    pub const EVERYTHING: Self = Self { familiar: 1.0, travel: 1.0, near: [(0, 1.0), (0, 0.0)] };
}
