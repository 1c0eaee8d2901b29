//! The cost `C` by validation.

use super::curvature::Curvature;
use super::pairs::{Pairs, pair_accuracy};
use super::rank::{RankOptions, rank_roughly};
use super::samples::Samples;

/// Costs that are tried, times the number of pairs and the mean square of a sample: so that the numbers mean the same for any
/// data. From stiff to loose, each from the solution before.
const TRIED: [f64; 8] = [0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0];
/// Parts of the samples, each held back once.
const FOLDS: usize = 4;

/// A cost and how it was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// `C`.
    pub cost: f64,
    /// Held-out pair accuracy at that cost; NaN if no fold held a pair and the middle of the range was taken.
    pub accuracy: f64,
    /// `[C, held-out pair accuracy]` of all that were tried.
    pub tried: Vec<[f64; 2]>,
}

/// The cost with the best accuracy on samples that were held back; of equals the smallest.
///
/// `takes[i]`: samples of one take are held back together (pass `0..n` if every sample is its own). Takes are dealt to the folds
/// in turn.
pub fn choose_cost(samples: &Samples, pairs: &Pairs, takes: &[usize], options: &RankOptions) -> Choice {
    let unit = unit(samples, pairs);
    let pairs = &pairs.by_first();
    let curvature = Curvature::new(samples);
    let costs = TRIED.map(|c| c * unit);
    let mut right = [0.0; TRIED.len()];
    let mut count = 0.0;
    for fold in 0..FOLDS {
        let keep: Vec<bool> = takes.iter().map(|take| take % FOLDS != fold).collect();
        let held: Vec<bool> = keep.iter().map(|keep| !keep).collect();
        let (fitted, judged) = (pairs.among(&keep), pairs.among(&held).ordered);
        if fitted.ordered.is_empty() || judged.is_empty() {
            continue;
        }
        // A fold has fewer pairs: the same cost for all of them together.
        let share = pairs.len() as f64 / fitted.len() as f64;
        let (mut start, mut scores) = (Vec::new(), Vec::new());
        for (cost, right) in costs.iter().zip(&mut right) {
            // Which cost is best shows in a few digits.
            let options = RankOptions { cost: cost * share, tolerance: 1e-3, ..*options };
            start = rank_roughly(&curvature, &fitted, &options, &start);
            samples.product(&start, &mut scores);
            *right += pair_accuracy(&scores, &judged) * judged.len() as f64;
        }
        count += judged.len() as f64;
    }
    let tried: Vec<[f64; 2]> = costs.iter().zip(right).map(|(cost, right)| [*cost, right / count]).collect();
    let best = tried.iter().fold(None, |best: Option<[f64; 2]>, next| match best {
        Some(best) if next[1] <= best[1] => Some(best),
        _ => Some(*next),
    });
    match best {
        Some([cost, accuracy]) if count > 0.0 => Choice { cost, accuracy, tried },
        _ => Choice { cost: costs[TRIED.len() / 2], accuracy: f64::NAN, tried: Vec::new() },
    }
}

/// `1 / (pairs x mean square distance of a sample from the mean)`.
fn unit(samples: &Samples, pairs: &Pairs) -> f64 {
    let mean = samples.mean();
    let squares: f64 = samples.iter().flat_map(|row| row.iter().zip(&mean)).map(|(x, m)| (x - m).powi(2)).sum();
    let spread = squares / samples.rows().max(1) as f64;
    1.0 / (pairs.len().max(1) as f64 * spread.max(1e-12))
}

#[cfg(test)]
mod tests {
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    use super::*;

    #[test]
    fn noisy_data_get_a_stiff_cost_and_clean_data_a_loose_one() {
        let mut random = ChaCha8Rng::seed_from_u64(5);
        let mut choice = |noise: f64| {
            let values: Vec<f64> = (0..120 * 60).map(|_| random.random_range(-1.0..1.0)).collect();
            let levels: Vec<Option<f64>> =
                values.chunks(60).map(|x| Some(x[0] - x[1] + x[2] + noise * random.random_range(-1.0..1.0))).collect();
            let pairs = Pairs::of_levels(&levels, &[0; 120], 0.0);
            let takes: Vec<usize> = (0..120).collect();
            choose_cost(&Samples::new(&values, 60), &pairs, &takes, &RankOptions::default())
        };
        let (clean, noisy) = (choice(0.0), choice(4.0));
        assert!(clean.accuracy > 0.9 && clean.cost > noisy.cost, "{clean:?} {noisy:?}");
        assert_eq!(clean.tried.len(), TRIED.len());
    }
}
