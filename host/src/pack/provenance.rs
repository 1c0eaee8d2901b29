//! Where a pack comes from: kept in the file, read by the host only.

use serde::{Deserialize, Serialize};

/// Where a pack comes from and what it was measured to do.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Provenance {
    /// Name and version of the program that wrote the pack.
    pub tool: String,
    /// The command line that made it.
    pub command: String,
    /// Seed of every random choice.
    pub seed: u64,
    /// The training clips.
    pub inputs: Vec<InputFile>,
    /// Figures on the training data.
    pub metrics: Vec<Metric>,
    /// Choices that the training made, one sentence each.
    pub notes: Vec<String>,
    /// What simpler models would do; `kinesic eval` reports them beside the pack's own error.
    pub baselines: Baselines,
    /// Translation: the counterpart of the baselines in rotations, [`Turns::numbers`](crate::measure::turns::Turns::numbers).
    pub turns: Vec<f32>,
}

impl Provenance {
    /// From a pack's metadata; `None` if this release cannot read it.
    pub fn decode(bytes: &[u8]) -> Option<Self> {
        postcard::from_bytes(bytes).ok()
    }
}

/// A training file.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct InputFile {
    /// Path as given.
    pub path: String,
    /// SHA-256 of its bytes, hexadecimal.
    pub sha256: String,
}

/// A named figure.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Metric {
    /// What was measured, with its unit at the end.
    pub name: String,
    /// The figure.
    pub value: f64,
}

impl Metric {
    /// A figure under its name.
    pub fn new(name: impl Into<String>, value: f64) -> Self {
        Self { name: name.into(), value }
    }
}

/// Static models fitted on the same training data. Translation: on heading-local positions in metres, as the fields say. Body
/// mechanics: `offset` is the mean pose (quaternions x, y, z, w of all joints but the hips), `affine` the linear regression
/// from the features to it, `[(features + 1) x 4 (joints - 1)]`, the constant last.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Baselines {
    /// Mean difference of each joint, `[3 joints]`.
    pub offset: Vec<f32>,
    /// Best affine map of each joint, `[joints x 12]`: row-major 3 x 3, then the translation.
    pub affine: Vec<f32>,
}
