//! What validation chooses among.

use super::dynamics::Poles;
use super::moments::Base;

/// A form, its dynamics and its penalties.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Candidate {
    /// Principal coordinates of the whole-body form; `None` for the per-joint form.
    pub coordinates: Option<usize>,
    /// Dynamics.
    pub poles: Poles,
    /// Direct map of a joint to itself.
    pub base: Base,
    /// Penalty of the static features, in units of their variance.
    pub penalty: f64,
    /// Penalty of the filter states.
    pub dynamic_penalty: f64,
    /// An output stage for each cluster of a gate, for several actions; whole body only.
    pub experts: bool,
}

/// Memoryless model that judges alignments.
pub const JUDGE: Candidate = Candidate { poles: Poles::Static, ..QUICK };

/// The same for a machine. How a servo reacts is what is learned, and a model without states would have a warp hide it.
pub const MACHINE_JUDGE: Candidate = Candidate { poles: Poles::Identified(24), ..QUICK };

/// The static affine map of each joint: the baseline, as a candidate.
pub const AFFINE: Candidate = Candidate {
    coordinates: None,
    poles: Poles::Static,
    base: Base::Joint,
    penalty: 1e6,
    dynamic_penalty: 1e6,
    experts: false,
};

/// Small whole-body model that refines alignments.
pub const QUICK: Candidate = Candidate {
    coordinates: Some(8),
    poles: Poles::Harmonics2,
    base: Base::Mean,
    penalty: 1e-2,
    dynamic_penalty: 1e-2,
    experts: false,
};

impl Candidate {
    /// Penalty of each feature: filter states, then drives.
    pub fn penalties(&self, states: usize, drives: usize) -> Vec<f64> {
        [vec![self.dynamic_penalty; states], vec![self.penalty; drives]].concat()
    }
}
