//! Fewer joints for the same error: backward elimination of joint groups.

use faer::MatRef;

use super::cholesky::Cholesky;
use super::factor::{Factors, column, column_mut, product};
use super::refit::{Fit, Scatter};
use crate::vector::{Work, dot, vectorised};

/// Groups that leave at once, as a share of those that are left.
const SHARE: f64 = 0.08;

/// Damping of the systems that say what a group is worth.
const DAMPING: f64 = 1e-5;

/// Takes away the joint groups whose loss costs least, a few at a time with least squares in between, until `density` is
/// reached.
///
/// The loss of group `(k, i)` at fixed weights is `|C_ki|^2 / [(W_S' W_S)^-1]_kk`, `S` the components that move joint `i`
/// (optimal brain surgeon, Hassibi 1993): what the other components cannot take over.
pub fn prune(motion: MatRef<'_, f64>, factors: &Factors, density: f64) -> Factors {
    let scatter = Scatter::new(motion);
    let mut fit = Fit::new(&scatter, &factors.components);
    let all = factors.count() * motion.ncols() / 3;
    thin(&mut fit, (density * all as f64).round() as usize);
    fit.factors()
}

/// Prunes to `wanted` joint groups.
pub(super) fn thin(fit: &mut Fit, wanted: usize) {
    loop {
        let mut losses = vectorised(Losses(fit));
        let surplus = losses.len().saturating_sub(wanted);
        if surplus == 0 {
            return;
        }
        let leave = ((SHARE * losses.len() as f64).ceil() as usize).min(surplus);
        losses.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        for (_, [k, joint]) in losses.iter().take(leave) {
            column_mut(&mut fit.components, *k)[3 * joint..][..3].fill(0.0);
        }
        fit.rounds(2);
    }
}

/// What every joint group that is not zero is worth, and which it is: `[component, joint]`.
struct Losses<'f, 'a>(&'f Fit<'a>);

impl Work for Losses<'_, '_> {
    type Output = Vec<(f64, [usize; 2])>;

    #[inline(always)]
    fn call(self) -> Self::Output {
        let Self(fit) = self;
        let mut cholesky = Cholesky::default();
        let mut losses = Vec::new();
        for (joint, movers) in fit.movers().iter().enumerate() {
            cholesky.factorise(movers.len(), DAMPING, |a, b| fit.inner[(movers[a], movers[b])]);
            for (k, share) in movers.iter().zip(cholesky.inverse_diagonal()) {
                let group = &column(&fit.components, *k)[3 * joint..][..3];
                losses.push((dot(group, group) / share.max(f64::MIN_POSITIVE), [*k, joint]));
            }
        }
        losses
    }
}

/// Moves joint groups to where they are worth more, at the same density: grow by a share, fit, prune back; as long as the
/// error falls.
pub(super) fn exchange(fit: &mut Fit, count: usize) {
    let mut lowest = fit.error();
    let mut share = 0.2;
    for _ in 0..count {
        let mut trial = fit.clone();
        let held = grow(&mut trial, share);
        trial.rounds(4);
        thin(&mut trial, held);
        trial.rounds(4);
        let error = trial.error();
        if error < lowest {
            (*fit, lowest) = (trial, error);
        } else {
            share *= 0.5;
        }
    }
}

/// Adds the groups that would lower the error most at fixed weights; returns how many there were before.
fn grow(fit: &mut Fit, share: f64) -> usize {
    // `(M - W C)' W`, [3R x K].
    let open = &fit.cross - product(fit.components.as_ref(), fit.inner.as_ref());
    let mut cholesky = Cholesky::default();
    let mut shadow = Vec::new();
    let mut gains = Vec::new();
    let mut held = 0;
    for (joint, movers) in fit.movers().iter().enumerate() {
        held += movers.len();
        cholesky.factorise(movers.len(), DAMPING, |a, b| fit.inner[(movers[a], movers[b])]);
        for k in (0..fit.inner.ncols()).filter(|k| !movers.contains(k)) {
            // What the joint's own components already cover of the candidate.
            shadow.clear();
            shadow.extend(movers.iter().map(|a| fit.inner[(*a, k)]));
            cholesky.forward(&mut shadow);
            let free = fit.inner[(k, k)] - dot(&shadow, &shadow);
            let step = &column(&open, k)[3 * joint..][..3];
            let squares = dot(step, step);
            if free > 1e-6 * fit.inner[(k, k)] && squares > 0.0 {
                gains.push((squares / free, [k, joint], [step[0] / free, step[1] / free, step[2] / free]));
            }
        }
    }
    gains.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    for (_, [k, joint], step) in gains.iter().take((share * held as f64).ceil() as usize) {
        column_mut(&mut fit.components, *k)[3 * joint..][..3].copy_from_slice(step);
    }
    held
}
