//! The face model: a checked, immutable view of a pack.

use super::{CONTOUR, FEATURES, MOVING, Shape};
use crate::kernel::{ROWS, Tiled, dot, tanh};
use crate::model::{FaceMeta, LoadError, ModelMeta, Pack};

/// Rows of tiles that hold a shape.
const TILES: usize = FEATURES.div_ceil(ROWS);

/// Strength of a facial expression, borrowed from a pack, with up to `UNITS` hidden units in a cluster's network.
#[derive(Clone, Copy, Debug)]
pub struct FaceSynth<'a, const UNITS: usize> {
    pub(super) meta: FaceMeta<'a>,
    /// Normalised contours, the middles of the clusters.
    contours: &'a [[[f32; 2]; CONTOUR]],
    /// Ranking function of each cluster, strength a unit. It does not feel a region move as a whole.
    rank: &'a [Shape],
    rank_bias: &'a [f32],
    /// How a shape moves for one more strength; the hidden units add how that differs along the way.
    linear: &'a [Shape],
    /// Weight and bias of each hidden unit, cluster by cluster.
    hidden: &'a [[f32; 2]],
    /// `[98 x units]` of each cluster.
    output: &'a [[f32; ROWS]],
    output_bias: &'a [Shape],
}

/// One cluster's part.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cluster<'a> {
    rank: &'a Shape,
    rank_bias: f32,
    linear: &'a Shape,
    hidden: &'a [[f32; 2]],
    output: Tiled<'a>,
    output_bias: &'a Shape,
}

impl<'a, const UNITS: usize> FaceSynth<'a, UNITS> {
    /// The face model of a pack, after every check that makes [`step`](Self::step) infallible.
    pub fn load(pack: &Pack<'a>) -> Result<Self, LoadError> {
        let meta = pack.metadata().models.iter().find_map(ModelMeta::face);
        let meta = meta.ok_or(LoadError::NoModel { expected: "face model" })?;
        let (clusters, hidden) = (meta.clusters as usize, meta.hidden as usize);
        if hidden > UNITS {
            return Err(LoadError::Capacity { parameter: "UNITS", found: hidden, capacity: UNITS });
        }
        let [low, high] = meta.strength;
        if clusters == 0 || hidden == 0 || !(low.is_finite() && high.is_finite() && low < high) {
            return Err(LoadError::Metadata);
        }
        let units = clusters.saturating_mul(hidden);
        Ok(Self {
            meta,
            contours: pack.slice("face/contours", clusters)?,
            rank: pack.slice("face/rank", clusters)?,
            rank_bias: pack.slice("face/rank_bias", clusters)?,
            linear: pack.slice("face/linear", clusters)?,
            hidden: pack.slice("face/hidden", units)?,
            output: pack.slice("face/output", units.saturating_mul(TILES))?,
            output_bias: pack.slice("face/output_bias", clusters)?,
        })
    }

    /// Name of the expression, shape and plausible strengths.
    pub fn meta(&self) -> &FaceMeta<'a> {
        &self.meta
    }

    /// Multiply-adds of one update: contours, ranking, the linear path, one output layer.
    pub fn multiply_adds(&self) -> usize {
        2 * CONTOUR * self.contours.len() + 2 * FEATURES + TILES * ROWS * self.meta.hidden as usize
    }

    /// Squared distance of a normalised contour to the middle of each cluster.
    pub(super) fn distances(&self, contour: &[[f32; 2]; CONTOUR]) -> impl Iterator<Item = f32> {
        self.contours.iter().map(move |middle| {
            let mut sum = 0.0;
            for (a, b) in middle.as_flattened().iter().zip(contour.as_flattened()) {
                sum += (a - b) * (a - b);
            }
            sum
        })
    }

    /// The parts of cluster `index`; `None` past the last one.
    pub(super) fn cluster(&self, index: usize) -> Option<Cluster<'a>> {
        let hidden = self.meta.hidden as usize;
        let tiles = hidden.checked_mul(TILES)?;
        Some(Cluster {
            rank: self.rank.get(index)?,
            rank_bias: *self.rank_bias.get(index)?,
            linear: self.linear.get(index)?,
            hidden: self.hidden.get(index.checked_mul(hidden)?..)?.get(..hidden)?,
            output: Tiled::new(FEATURES, hidden, self.output.get(index.checked_mul(tiles)?..)?.get(..tiles)?)?,
            output_bias: self.output_bias.get(index)?,
        })
    }

    /// The mean shape of a cluster's faces at a strength, in the face's frame: to draw or drive a face that nobody observes.
    /// `None` past the last cluster. Cost: a tanh a hidden unit and one output layer.
    pub fn shape(&self, cluster: usize, strength: f32) -> Option<Shape> {
        let cluster = self.cluster(cluster)?;
        let mut shape = *cluster.output_bias;
        cluster.add_linear(strength, &mut shape);
        cluster.output.multiply_add(&cluster.units::<UNITS>(strength), shape.as_flattened_mut());
        Some(shape)
    }
}

impl Cluster<'_> {
    /// Strength of a shape by the ranking function.
    pub(super) fn strength(&self, shape: &Shape) -> f32 {
        self.rank_bias + dot(self.rank.as_flattened(), shape.as_flattened())
    }

    fn add_linear(&self, strength: f32, shape: &mut Shape) {
        for (value, slope) in shape.as_flattened_mut().iter_mut().zip(self.linear.as_flattened()) {
            *value += strength * slope;
        }
    }

    /// Hidden units at a strength.
    fn units<const UNITS: usize>(&self, strength: f32) -> [f32; UNITS] {
        let mut units = [0.0; UNITS];
        for (unit, [weight, bias]) in units.iter_mut().zip(self.hidden) {
            *unit = tanh(weight * strength + bias);
        }
        units
    }

    /// How the shape moves from one strength to another.
    pub(super) fn move_between<const UNITS: usize>(&self, from: f32, to: f32) -> Shape {
        let (before, mut units) = (self.units::<UNITS>(from), self.units::<UNITS>(to));
        for (unit, before) in units.iter_mut().zip(before) {
            *unit -= before;
        }
        let mut change = [[0.0; 2]; MOVING];
        self.add_linear(to - from, &mut change);
        self.output.multiply_add(&units, change.as_flattened_mut());
        change
    }
}
