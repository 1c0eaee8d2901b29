//! Fewer joints for the same error: backward elimination of joint groups.

use faer::{Mat, MatRef};

use super::factor::{Factors, column, column_mut, product};
use super::refit::{rounds, solve};

/// Groups that leave at once, as a share of those that are left.
const SHARE: f64 = 0.08;

/// Takes away the joint groups whose loss costs least, a few at a time with least squares in between, until `density` is
/// reached.
///
/// The loss of group `(k, i)` at fixed weights is `|C_ki|^2 / [(W_S' W_S)^-1]_kk`, `S` the components that move joint `i`
/// (optimal brain surgeon, Hassibi 1993): what the other components cannot take over.
pub fn prune(motion: MatRef<'_, f64>, factors: &Factors, density: f64) -> Factors {
    let mut pruned = factors.clone();
    let all = pruned.count() * pruned.components.nrows() / 3;
    let wanted = (density * all as f64).round() as usize;
    loop {
        let mut losses = losses(&pruned);
        let surplus = losses.len().saturating_sub(wanted);
        if surplus == 0 {
            return pruned;
        }
        let leave = ((SHARE * losses.len() as f64).ceil() as usize).min(surplus);
        losses.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        for (_, [k, joint]) in losses.iter().take(leave) {
            column_mut(&mut pruned.components, *k)[3 * joint..][..3].fill(0.0);
        }
        rounds(motion, &mut pruned, 2);
    }
}

/// What every joint group that is not zero is worth, and which it is: `[component, joint]`.
fn losses(factors: &Factors) -> Vec<(f64, [usize; 2])> {
    let inner = product(factors.weights.transpose(), factors.weights.as_ref());
    let support = factors.support();
    let mut losses = Vec::new();
    for joint in 0..factors.components.nrows() / 3 {
        let active: Vec<usize> = (0..support.len()).filter(|k| support[*k][joint]).collect();
        let gram = Mat::from_fn(active.len(), active.len(), |a, b| inner[(active[a], active[b])]);
        let Some(inverse) = solve(gram, &Mat::identity(active.len(), active.len())) else { continue };
        for (a, k) in active.iter().enumerate() {
            let group = &column(&factors.components, *k)[3 * joint..][..3];
            let squares: f64 = group.iter().map(|c| c * c).sum();
            losses.push((squares / inverse[(a, a)].max(1e-300), [*k, joint]));
        }
    }
    losses
}

/// Moves joint groups to where they are worth more, at the same density: grow by a share, fit, prune back; as long as the
/// error falls.
pub fn exchange(motion: MatRef<'_, f64>, factors: &Factors, count: usize) -> Factors {
    let density = factors.density();
    let mut best = factors.clone();
    let mut lowest = best.error(motion);
    let mut share = 0.2;
    for _ in 0..count {
        let mut grown = best.clone();
        grow(motion, &mut grown, share);
        rounds(motion, &mut grown, 4);
        let mut trial = prune(motion, &grown, density);
        rounds(motion, &mut trial, 4);
        let error = trial.error(motion);
        if error < lowest {
            (best, lowest) = (trial, error);
        } else {
            share *= 0.5;
        }
    }
    best
}

/// Adds the groups that would lower the error most at fixed weights.
fn grow(motion: MatRef<'_, f64>, factors: &mut Factors, share: f64) {
    let inner = product(factors.weights.as_ref().transpose(), factors.weights.as_ref());
    let rest = motion - factors.product();
    let open = product(rest.as_ref().transpose(), factors.weights.as_ref());
    let support = factors.support();
    let mut gains = Vec::new();
    let mut held = 0;
    for joint in 0..factors.components.nrows() / 3 {
        let active: Vec<usize> = (0..support.len()).filter(|k| support[*k][joint]).collect();
        let idle: Vec<usize> = (0..support.len()).filter(|k| !support[*k][joint]).collect();
        held += active.len();
        let gram = Mat::from_fn(active.len(), active.len(), |a, b| inner[(active[a], active[b])]);
        let right = Mat::from_fn(active.len(), idle.len(), |a, b| inner[(active[a], idle[b])]);
        let shadow = solve(gram, &right);
        for (b, k) in idle.iter().enumerate() {
            let taken: f64 =
                shadow.as_ref().map_or(0.0, |s| (0..active.len()).map(|a| s[(a, b)] * right[(a, b)]).sum());
            let free = inner[(*k, *k)] - taken;
            let step: [f64; 3] = std::array::from_fn(|c| open[(3 * joint + c, *k)]);
            let squares: f64 = step.iter().map(|s| s * s).sum();
            if free > 1e-6 * inner[(*k, *k)] && squares > 0.0 {
                gains.push((squares / free, [*k, joint], step.map(|s| s / free)));
            }
        }
    }
    gains.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    for (_, [k, joint], step) in gains.iter().take((share * held as f64).ceil() as usize) {
        column_mut(&mut factors.components, *k)[3 * joint..][..3].copy_from_slice(step);
    }
}
