//! Trained components, in f64, and how they go into a pack.

use faer::{Mat, MatRef};
use kinesic::model::{ComponentsMeta, Kind, ModelMeta};

use super::factor::{Factors, product};
use super::refit::solve;
use crate::pack::{PackWriter, Provenance};
use crate::rig::Rig;

/// Damping of the projection, as a share of a component's mean energy: a live pose is not one of the training poses.
const DAMPING: f64 = 1e-4;

/// Trained components. Matrices hold one component a column, `[3 rows x K]`, in deviations.
#[derive(Clone, Debug)]
pub struct ComponentsModel {
    /// Name of the style.
    pub style: String,
    /// Frames per second.
    pub frame_rate: f64,
    /// Mean coordinates of the content, rad or m, `[3 rows]`.
    pub mean: Vec<f64>,
    /// What the style adds to the mean, rad or m, `[3 rows]`.
    pub shift: Vec<f64>,
    /// Coordinates per deviation, rad or m, `[3 rows]`.
    pub scale: Vec<f64>,
    /// `W_C` and `C_C`.
    pub content: Factors,
    /// `C_X`.
    pub learned: Mat<f64>,
    /// `[travel x, travel z, sine, cosine of the turn]` of every frame of the content.
    pub track: Vec<[f32; 4]>,
    /// Plausible strengths.
    pub strength: [f64; 2],
}

impl ComponentsModel {
    /// The model as a pack for `rig`, the one that it was trained on.
    pub fn pack(&self, rig: &Rig, provenance: &Provenance) -> Vec<u8> {
        let mut pack = PackWriter::new(Kind::Components, &self.style, self.frame_rate as f32);
        rig.write(&mut pack);
        let count = self.content.count();
        pack.model(&ModelMeta::Components(ComponentsMeta {
            style: &self.style,
            count: count as u32,
            frames: self.track.len() as u32,
            strength: self.strength.map(|x| x as f32),
        }));
        let single = |values: &[f64]| values.iter().map(|x| *x as f32).collect::<Vec<_>>();
        pack.f32s("components/mean", 3, &single(&self.mean));
        pack.f32s("components/shift", 3, &single(&self.shift));
        // Learned in deviations, used on coordinates.
        let scaled = |matrix: &Mat<f64>| Mat::from_fn(matrix.nrows(), count, |c, k| self.scale[c] * matrix[(c, k)]);
        let projection = self.projection();
        let projection = Mat::from_fn(count, self.scale.len(), |k, c| projection[(k, c)] / self.scale[c]);
        pack.tiled("components/project", self.scale.len(), &row_major(projection.as_ref()));
        pack.tiled("components/compose", count, &row_major(scaled(&self.content.components).as_ref()));
        let change = &self.learned - &self.content.components;
        pack.tiled("components/change", count, &row_major(scaled(&change).as_ref()));
        pack.f32s("components/weights", count, &row_major(self.content.weights.as_ref()));
        pack.f32s("components/track", 4, self.track.as_flattened());
        pack.finish(provenance)
    }

    /// Pseudo-inverse `[K x 3 rows]` of the content components.
    fn projection(&self) -> Mat<f64> {
        let components = self.content.components.as_ref();
        let mut gram = product(components.transpose(), components);
        let energy: f64 = (0..gram.nrows()).map(|k| gram[(k, k)]).sum();
        (0..gram.nrows()).for_each(|k| gram[(k, k)] += DAMPING * energy / gram.nrows() as f64 + 1e-12);
        // Damped, so positive definite; if it were not, live poses would pass unchanged.
        solve(gram, &components.transpose().to_owned())
            .unwrap_or_else(|| Mat::zeros(self.content.count(), components.nrows()))
    }
}

/// Row-major, single precision.
fn row_major(matrix: MatRef<'_, f64>) -> Vec<f32> {
    let row = |r: usize| (0..matrix.ncols()).map(move |c| matrix[(r, c)] as f32);
    (0..matrix.nrows()).flat_map(row).collect()
}
