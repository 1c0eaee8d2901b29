//! Clusters: k-means.

use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

/// Starts, of which the tightest clustering is kept.
const STARTS: usize = 5;
/// At most so many rounds a start.
const ROUNDS: usize = 100;

/// Middles and who belongs where.
#[derive(Clone, Debug, PartialEq)]
pub struct Clusters {
    /// The middles.
    pub middles: Vec<Vec<f64>>,
    /// Cluster of each sample.
    pub members: Vec<usize>,
    /// Sum of squared distances to the middles.
    pub spread: f64,
}

impl Clusters {
    /// The samples among the given middles.
    pub fn assign(middles: Vec<Vec<f64>>, samples: &[Vec<f64>]) -> Self {
        let nearest: Vec<(usize, f64)> = samples.iter().map(|sample| nearest(&middles, sample)).collect();
        let members = nearest.iter().map(|(index, _)| *index).collect();
        Self { middles, members, spread: nearest.iter().map(|(_, distance)| distance).sum() }
    }

    /// The clustering without one of the middles: its samples go to the next nearest.
    pub fn without(&self, cluster: usize, samples: &[Vec<f64>]) -> Self {
        let mut middles = self.middles.clone();
        middles.remove(cluster);
        Self::assign(middles, samples)
    }

    /// Number of clusters.
    pub fn count(&self) -> usize {
        self.middles.len()
    }
}

/// k-means (Lloyd's rounds from k-means++ starts, Arthur and Vassilvitskii 2007): `count` clusters, fewer only if the samples
/// have fewer distinct places. The same seed gives the same clusters.
pub fn k_means(samples: &[Vec<f64>], count: usize, seed: u64) -> Clusters {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut best: Option<Clusters> = None;
    for _ in 0..STARTS {
        let mut now = Clusters::assign(start(samples, count, &mut random), samples);
        for _ in 0..ROUNDS {
            let next = Clusters::assign(means(&now, samples), samples);
            let done = next.members == now.members;
            now = next;
            if done {
                break;
            }
        }
        if best.as_ref().is_none_or(|best| now.spread < best.spread) {
            best = Some(now);
        }
    }
    best.unwrap_or(Clusters { middles: Vec::new(), members: Vec::new(), spread: 0.0 })
}

/// Samples far from those already chosen, by chance in proportion to the squared distance.
fn start(samples: &[Vec<f64>], count: usize, random: &mut ChaCha8Rng) -> Vec<Vec<f64>> {
    let mut middles: Vec<Vec<f64>> = Vec::new();
    let mut distances = vec![1.0; samples.len()];
    while middles.len() < count {
        let total: f64 = distances.iter().sum();
        if total <= 0.0 {
            break;
        }
        let mut rest = random.random_range(0.0..total);
        let chosen = distances.iter().position(|distance| {
            rest -= distance;
            rest < 0.0
        });
        // Rounding may leave a little: then the farthest.
        let chosen = chosen
            .unwrap_or_else(|| (0..samples.len()).max_by(|a, b| distances[*a].total_cmp(&distances[*b])).unwrap_or(0));
        middles.push(samples[chosen].clone());
        let first = middles.len() == 1;
        for (distance, sample) in distances.iter_mut().zip(samples) {
            let new = squared(&samples[chosen], sample);
            *distance = if first { new } else { distance.min(new) };
        }
    }
    middles
}

/// Means of the members; a cluster that lost them all stays where it was.
fn means(clusters: &Clusters, samples: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let mean = |(index, old): (usize, &Vec<f64>)| {
        let mut sum = vec![0.0; old.len()];
        let mut count = 0.0;
        for (_, sample) in clusters.members.iter().zip(samples).filter(|(member, _)| **member == index) {
            sum.iter_mut().zip(sample).for_each(|(s, x)| *s += x);
            count += 1.0;
        }
        if count == 0.0 { old.clone() } else { sum.iter().map(|s| s / count).collect() }
    };
    clusters.middles.iter().enumerate().map(mean).collect()
}

fn nearest(middles: &[Vec<f64>], sample: &[f64]) -> (usize, f64) {
    let distances = middles.iter().map(|middle| squared(middle, sample)).enumerate();
    distances.fold((0, f64::INFINITY), |best, next| if next.1 < best.1 { next } else { best })
}

fn squared(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn heaps() -> Vec<Vec<f64>> {
        let heap = |i: usize| [[0.0, 0.0], [10.0, 0.0], [0.0, 10.0]][i % 3];
        (0..60).map(|i| heap(i).iter().map(|x| x + (i * 7 % 11) as f64 * 0.1).collect()).collect()
    }

    #[test]
    fn heaps_are_found_and_no_round_loosens_them() {
        let samples = heaps();
        let clusters = k_means(&samples, 3, 1);
        for i in 3..60 {
            assert_eq!(clusters.members[i], clusters.members[i % 3]);
        }
        assert_eq!(clusters, k_means(&samples, 3, 1));
        let again = Clusters::assign(means(&clusters, &samples), &samples);
        assert!(again.spread <= clusters.spread + 1e-12);
        assert!(k_means(&samples, 4, 1).spread < clusters.spread);
    }

    #[test]
    fn equal_samples_make_one_cluster_and_a_dropped_one_goes_to_the_next() {
        let samples = vec![vec![1.0, 2.0]; 9];
        assert_eq!(k_means(&samples, 3, 1).count(), 1);
        let samples = heaps();
        let two = k_means(&samples, 3, 1).without(0, &samples);
        assert_eq!(two.count(), 2);
        assert!(two.members.iter().all(|member| *member < 2));
    }
}
