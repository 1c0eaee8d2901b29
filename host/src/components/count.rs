//! How many components: the paper leaves it open (its open point 1).

use super::matrix::Motion;
use super::sparse::{Sparse, Sparsity, sparse};

/// Numbers that are tried.
const CANDIDATES: std::ops::RangeInclusive<usize> = 1..=12;
/// Components between two candidates.
const STRIDE: usize = 5;
/// A stride that lowers the error by less than this is not worth it, cm a joint.
const WORTH: f64 = 0.05;

/// A number of components and why it was chosen.
#[derive(Clone, Debug)]
pub struct Choice {
    /// Number of components.
    pub count: usize,
    /// In a sentence.
    pub reason: String,
    /// `[components, RMS joint error in cm]` of every candidate that was tried.
    pub tried: Vec<(usize, f64)>,
}

/// The smallest number from which five more components bring less than half a millimetre.
///
/// Every candidate is factorised at the wanted density and refitted, so that it is judged by what it would do.
pub fn choose(motion: &Motion, sparsity: &Sparsity) -> (Choice, Sparse) {
    let most = motion.channels().min(motion.frames());
    let mut tried: Vec<(usize, f64)> = Vec::new();
    let mut last: Option<(usize, Sparse)> = None;
    for count in CANDIDATES.map(|step| step * STRIDE) {
        let count = count.min(most);
        let found = sparse(motion.values.as_ref(), count, sparsity);
        let error = joint_error(motion, &found);
        if let (Some((before, sparse)), Some((_, old))) = (last, tried.last().copied()) {
            let gain = old - error;
            if gain < WORTH || count == before {
                let reason = format!(
                    "{before} components reproduce the clip to {old:.2} cm a joint; {} more would gain {:.2} cm, less than {WORTH} cm",
                    count - before,
                    gain.max(0.0)
                );
                tried.push((count, error));
                return (Choice { count: before, reason, tried }, sparse);
            }
        }
        tried.push((count, error));
        last = Some((count, found));
    }
    let (count, error) = tried.last().copied().unwrap_or_default();
    let reason = format!("{count} components, the most that are tried, reproduce the clip to {error:.2} cm a joint");
    let found = last.map_or_else(|| sparse(motion.values.as_ref(), 1, sparsity), |(_, sparse)| sparse);
    (Choice { count: count.max(1), reason, tried }, found)
}

/// Root mean square distance of a joint from where it should be, cm.
pub fn joint_error(motion: &Motion, found: &Sparse) -> f64 {
    let rest = (&motion.values - found.factors.product()).squared_norm_l2();
    100.0 * motion.scale * (3.0 * rest / (motion.frames() * motion.channels()).max(1) as f64).sqrt()
}
