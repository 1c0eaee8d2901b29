//! Trained components, in f64, and how they go into a pack.

use faer::{Mat, MatRef};
use kinesic::model::{ComponentsMeta, Kind, ModelMeta};

use super::factor::{Factors, product};
use super::refit::solve;
use crate::pack::{PackWriter, Provenance};
use crate::rig::Rig;

/// Damping of the projection, as a share of a component's mean energy: a live pose is not one of the training poses.
const DAMPING: f64 = 1e-4;

/// Trained components. Matrices hold one component a column, `[3 joints x K]`, in deviations.
#[derive(Clone, Debug)]
pub struct ComponentsModel {
    /// Name of the style.
    pub style: String,
    /// Frames per second.
    pub frame_rate: f64,
    /// Mean pose of the content, m, `[3 joints]`.
    pub mean: Vec<f64>,
    /// What the style adds to the mean pose, m, `[3 joints]`.
    pub shift: Vec<f64>,
    /// Metres in a deviation.
    pub scale: f64,
    /// `W_C` and `C_C`.
    pub content: Factors,
    /// `C_X`.
    pub learned: Mat<f64>,
    /// `[travel x, travel z, sine, cosine of the turn]` of every frame of the content.
    pub track: Vec<[f32; 4]>,
    /// Local rotations `[i, j, k, w]` of the reference pose.
    pub reference: Vec<[f32; 4]>,
    /// Plausible strengths.
    pub strength: [f64; 2],
}

impl ComponentsModel {
    /// The model as a pack for `rig`.
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
        pack.tiled("components/project", self.mean.len(), &rows(self.projection().as_ref(), 1.0 / self.scale));
        pack.tiled("components/compose", count, &rows(self.content.components.as_ref(), self.scale));
        let change = &self.learned - &self.content.components;
        pack.tiled("components/change", count, &rows(change.as_ref(), self.scale));
        pack.f32s("components/weights", count, &rows(self.content.weights.as_ref(), 1.0));
        pack.f32s("components/track", 4, self.track.as_flattened());
        pack.f32s("components/reference", 4, self.reference.as_flattened());
        pack.finish(provenance)
    }

    /// Pseudo-inverse `[K x 3 joints]` of the content components.
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
fn rows(matrix: MatRef<'_, f64>, factor: f64) -> Vec<f32> {
    let row = |r: usize| (0..matrix.ncols()).map(move |c| (factor * matrix[(r, c)]) as f32);
    (0..matrix.nrows()).flat_map(row).collect()
}
