//! A trained face model, and how it goes into a pack.

use kinesic::face::{CONTOUR, FEATURES, FaceSynth, Shape};
use kinesic::kernel::ROWS;
use kinesic::model::{FaceMeta, Kind, ModelMeta};

use crate::pack::{PackWriter, Provenance};

/// Hidden units that the host steps.
pub const MAX_UNITS: usize = 64;

/// The device's face model at the host's capacity.
pub type HostFace<'a> = FaceSynth<'a, MAX_UNITS>;

/// Written into the pack, which needs one: a camera's. A step does not depend on it.
const FRAME_RATE: f32 = 30.0;

/// One cluster of head pose.
#[derive(Clone, Debug, PartialEq)]
pub struct ClusterModel {
    /// Normalised contour in the middle of the cluster.
    pub contour: [[f32; 2]; CONTOUR],
    /// Ranking function: strength of a shape is `rank . shape + rank_bias`.
    pub rank: Shape,
    /// Its constant.
    pub rank_bias: f32,
    /// How the shape moves for one more strength.
    pub linear: Shape,
    /// Weight and bias of every hidden unit.
    pub hidden: Vec<[f32; 2]>,
    /// `[98 x units]`, row-major.
    pub output: Vec<f32>,
    /// Constant of the shape.
    pub output_bias: Shape,
}

/// A face model: what training makes and the device loads.
#[derive(Clone, Debug, PartialEq)]
pub struct FaceModel {
    /// Name of the expression.
    pub attribute: String,
    /// Strengths that nearly all training faces lie between.
    pub strength: [f32; 2],
    /// The clusters, all with the same number of hidden units.
    pub clusters: Vec<ClusterModel>,
}

impl FaceModel {
    /// The model as a pack.
    pub fn pack(&self, provenance: &Provenance) -> Vec<u8> {
        let units = self.clusters.first().map_or(0, |cluster| cluster.hidden.len());
        let mut pack = PackWriter::new(Kind::Face, &self.attribute, FRAME_RATE);
        pack.model(&ModelMeta::Face(FaceMeta {
            attribute: &self.attribute,
            clusters: self.clusters.len() as u32,
            hidden: units as u32,
            strength: self.strength,
        }));
        let all = |part: &dyn Fn(&ClusterModel) -> Vec<f32>| self.clusters.iter().flat_map(part).collect::<Vec<_>>();
        pack.f32s("face/contours", 2 * CONTOUR, &all(&|c| c.contour.as_flattened().to_vec()));
        pack.f32s("face/rank", FEATURES, &all(&|c| c.rank.as_flattened().to_vec()));
        pack.f32s("face/rank_bias", 1, &all(&|c| vec![c.rank_bias]));
        pack.f32s("face/linear", FEATURES, &all(&|c| c.linear.as_flattened().to_vec()));
        pack.f32s("face/hidden", 2, &all(&|c| c.hidden.as_flattened().to_vec()));
        // Every cluster is tiled by itself: its rows are padded to whole tiles.
        let padded = |c: &ClusterModel| {
            let mut rows = c.output.clone();
            rows.resize(FEATURES.next_multiple_of(ROWS) * units, 0.0);
            rows
        };
        pack.tiled("face/output", units, &all(&padded));
        pack.f32s("face/output_bias", FEATURES, &all(&|c| c.output_bias.as_flattened().to_vec()));
        pack.finish(provenance)
    }
}
