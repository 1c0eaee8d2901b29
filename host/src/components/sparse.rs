//! The sparse factorisation as a whole: gather, descend, prune, refit.

use faer::MatRef;

use super::factor::{Descent, Factors, descend};
use super::gather::gather;
use super::prune::{exchange, thin};
use super::refit::{Fit, ROUNDS, Scatter};

/// Rounds of least squares on a support that pruning will change: more cost time and lower no error in the end.
const BEFORE_PRUNING: usize = 8;

/// How sparse, and how much work.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sparsity {
    /// Weight of the group norm, in deviations.
    pub penalty: f64,
    /// Share of joint groups to keep; `None`: those that the penalty leaves.
    pub density: Option<f64>,
    /// When to stop the descent.
    pub descent: Descent,
    /// Rounds in which groups move to where they are worth more.
    pub exchanges: usize,
}

impl Default for Sparsity {
    fn default() -> Self {
        Self { penalty: 0.01, density: Some(0.15), descent: Descent::default(), exchanges: 2 }
    }
}

/// Sparse components and how they came about.
#[derive(Clone, Debug)]
pub struct Sparse {
    /// The components, least squares on their support, strongest first.
    pub factors: Factors,
    /// Penalised objective at the start of the descent and after every sweep: never rises.
    pub history: Vec<f64>,
}

/// At most `count` sparse components of a motion.
///
/// 1. [`gather`]: every joint's directions, joined where they move together;
/// 2. [`descend`]: the penalised objective by exact block updates;
/// 3. least squares on what is left, so that the penalty does not shrink the motion;
/// 4. [`prune`](super::prune()) and exchange of joint groups at the wanted density, and least squares again.
pub fn sparse(motion: MatRef<'_, f64>, count: usize, sparsity: &Sparsity) -> Sparse {
    let (factors, history) = descend(motion, gather(motion, count), sparsity.penalty, &sparsity.descent);
    let scatter = Scatter::new(motion);
    let mut fit = Fit::new(&scatter, &factors.components);
    fit.rounds(if sparsity.density.is_some() { BEFORE_PRUNING } else { ROUNDS });
    if let Some(density) = sparsity.density {
        let groups = factors.count() * motion.ncols() / 3;
        thin(&mut fit, (density * groups as f64).round() as usize);
        exchange(&mut fit, sparsity.exchanges);
        fit.rounds(ROUNDS);
    }
    Sparse { factors: fit.factors(), history }
}
