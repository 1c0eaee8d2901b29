//! How many components: the paper leaves it open (its open point 1).

use super::factor::{Factors, flat, unflat};
use super::matrix::Motion;
use super::sparse::{Sparse, Sparsity, sparse};
use crate::step_cache::StepCache;

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
    choose_kept(motion, sparsity, &StepCache::nothing())
}

/// The same, going on from what an earlier run has reached.
pub(super) fn choose_kept(motion: &Motion, sparsity: &Sparsity, cache: &StepCache) -> (Choice, Sparse) {
    let sparse = |count| kept(motion, count, sparsity, cache, "content");
    let most = motion.channels().min(motion.frames());
    let mut tried: Vec<(usize, f64)> = Vec::new();
    let mut last: Option<(usize, Sparse)> = None;
    for count in CANDIDATES.map(|step| step * STRIDE) {
        let count = count.min(most);
        let found = sparse(count);
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
    let found = last.map_or_else(|| sparse(1), |(_, sparse)| sparse);
    (Choice { count: count.max(1), reason, tried }, found)
}

/// Whether the result of a step of [`kept`] can be one of so many components of this motion.
pub(super) fn fits(motion: &Motion, count: &str, result: &[f64]) -> bool {
    let Some((columns, rest)) = result.split_first() else { return false };
    let most = count.parse::<usize>().unwrap_or(0).min(motion.channels());
    let columns = (1..=most).find(|count| *count as f64 == *columns);
    let needed = columns.map(|columns| columns * (motion.frames() + motion.channels()));
    needed.is_some_and(|needed| rest.len() >= needed) && rest.iter().all(|x| x.is_finite())
}

/// [`sparse`] of a motion of this name, or what an earlier run has found.
pub(super) fn kept(motion: &Motion, count: usize, sparsity: &Sparsity, cache: &StepCache, name: &str) -> Sparse {
    let found = cache.always(&format!("{name} {count}"), || {
        let Sparse { factors, history } = sparse(motion.values.as_ref(), count, sparsity);
        [&[factors.weights.ncols() as f64], &flat(&factors.weights)[..], &flat(&factors.components), &history].concat()
    });
    // The number of columns, both matrices, and the rest.
    let (columns, rest) = found.split_first().map_or((0, &[][..]), |(columns, rest)| (*columns as usize, rest));
    let (weights, rest) = rest.split_at(motion.frames() * columns);
    let (components, history) = rest.split_at(motion.channels() * columns);
    let factors = Factors { weights: unflat(weights, columns), components: unflat(components, columns) };
    Sparse { factors, history: history.to_vec() }
}

/// Root mean square distance of a joint from where it should be, cm, to first order: what the levers say.
pub fn joint_error(motion: &Motion, found: &Sparse) -> f64 {
    let rest = (&motion.values - found.factors.product()).squared_norm_l2();
    100.0 * motion.deviation * (3.0 * rest / (motion.frames() * motion.channels()).max(1) as f64).sqrt()
}
