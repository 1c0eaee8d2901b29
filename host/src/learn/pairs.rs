//! Which sample shows more than which, and how well a score agrees.

use rand::RngExt;
use rand::rngs::ChaCha8Rng;

/// A graph over samples: its edges are compared, their differences are never formed.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Pairs {
    /// `[i, j]`: sample `i` shows more than sample `j`.
    pub ordered: Vec<[u32; 2]>,
    /// Samples that show it alike.
    pub similar: Vec<[u32; 2]>,
}

impl Pairs {
    /// All pairs of samples with a level, within groups: ordered where the levels differ by more than `alike`, else similar.
    ///
    /// `level[i]` is `None` for a sample that says nothing; samples are compared if their `group` is the same.
    pub fn of_levels(levels: &[Option<f64>], groups: &[usize], alike: f64) -> Self {
        let mut pairs = Self::default();
        let known: Vec<(u32, f64, usize)> = levels
            .iter()
            .zip(groups)
            .enumerate()
            .filter_map(|(index, (level, group))| Some((index as u32, (*level)?, *group)))
            .collect();
        for (at, (i, a, group)) in known.iter().enumerate() {
            for (j, b, _) in known[at + 1..].iter().filter(|(_, _, other)| other == group) {
                if (a - b).abs() <= alike {
                    pairs.similar.push([*i, *j]);
                } else {
                    pairs.ordered.push(if a > b { [*i, *j] } else { [*j, *i] });
                }
            }
        }
        pairs
    }

    /// The pairs both of whose samples are kept.
    pub fn among(&self, keep: &[bool]) -> Self {
        let both = |pair: &&[u32; 2]| pair.iter().all(|i| keep[*i as usize]);
        let filter = |pairs: &[[u32; 2]]| pairs.iter().filter(both).copied().collect();
        Self { ordered: filter(&self.ordered), similar: filter(&self.similar) }
    }

    /// The same pairs by their first sample, in the order in which they are now: a sum over the pairs then stays where it is.
    pub(super) fn by_first(&self) -> Self {
        Self { ordered: by_first(&self.ordered), similar: by_first(&self.similar) }
    }

    /// A share of the ordered and of the similar pairs, drawn without repetition.
    pub fn sample(&self, share: f64, random: &mut ChaCha8Rng) -> Self {
        Self { ordered: draw(&self.ordered, share, random), similar: draw(&self.similar, share, random) }
    }

    /// Number of pairs.
    pub fn len(&self) -> usize {
        self.ordered.len() + self.similar.len()
    }

    /// True if there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// Sorts by counting.
fn by_first(pairs: &[[u32; 2]]) -> Vec<[u32; 2]> {
    let samples = pairs.iter().map(|[i, _]| *i as usize + 1).max().unwrap_or(0);
    let mut next = vec![0; samples + 1];
    pairs.iter().for_each(|[i, _]| next[*i as usize + 1] += 1);
    (0..samples).for_each(|i| next[i + 1] += next[i]);
    let mut sorted = vec![[0; 2]; pairs.len()];
    for pair in pairs {
        let at = &mut next[pair[0] as usize];
        sorted[*at] = *pair;
        *at += 1;
    }
    sorted
}

fn draw(pairs: &[[u32; 2]], share: f64, random: &mut ChaCha8Rng) -> Vec<[u32; 2]> {
    let count = (share.clamp(0.0, 1.0) * pairs.len() as f64).round() as usize;
    let mut drawn = pairs.to_vec();
    for at in 0..count {
        let other = random.random_range(at..drawn.len());
        drawn.swap(at, other);
    }
    drawn.truncate(count);
    drawn
}

/// Share of the ordered pairs whose scores are in that order; a tie counts half. NaN without pairs.
pub fn pair_accuracy(scores: &[f64], ordered: &[[u32; 2]]) -> f64 {
    let right = |[i, j]: &[u32; 2]| match scores[*i as usize].total_cmp(&scores[*j as usize]) {
        std::cmp::Ordering::Greater => 1.0,
        std::cmp::Ordering::Equal => 0.5,
        std::cmp::Ordering::Less => 0.0,
    };
    ordered.iter().map(right).sum::<f64>() / ordered.len() as f64
}

/// Spearman's rank correlation, ties at their mean rank. NaN where one side is constant.
pub fn spearman(a: &[f64], b: &[f64]) -> f64 {
    let (a, b) = (ranks(a), ranks(b));
    let middle = (a.len() as f64 - 1.0) / 2.0;
    let product = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| (x - middle) * (y - middle)).sum::<f64>();
    product(&a, &b) / (product(&a, &a) * product(&b, &b)).sqrt()
}

fn ranks(values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|a, b| values[*a].total_cmp(&values[*b]));
    let mut ranks = vec![0.0; values.len()];
    let mut start = 0;
    for tied in order.chunk_by(|a, b| values[*a] == values[*b]) {
        let rank = start as f64 + (tied.len() as f64 - 1.0) / 2.0;
        tied.iter().for_each(|i| ranks[*i] = rank);
        start += tied.len();
    }
    ranks
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;

    #[test]
    fn pairs_by_first_keep_their_order() {
        let pairs = Pairs { ordered: vec![[3, 1], [0, 2], [3, 0], [1, 4], [0, 1]], similar: vec![] };
        assert_eq!(pairs.by_first().ordered, [[0, 2], [0, 1], [1, 4], [3, 1], [3, 0]]);
        assert_eq!(Pairs::default().by_first(), Pairs::default());
    }

    #[test]
    fn levels_make_pairs_within_groups() {
        let levels = [Some(1.0), Some(0.5), None, Some(0.5), Some(0.0)];
        let pairs = Pairs::of_levels(&levels, &[0, 0, 0, 0, 1], 1e-6);
        assert_eq!(pairs.ordered, [[0, 1], [0, 3]]);
        assert_eq!(pairs.similar, [[1, 3]]);
        assert_eq!(pairs.among(&[true, true, true, false, true]).len(), 1);
        let half = pairs.sample(0.5, &mut ChaCha8Rng::seed_from_u64(1));
        assert_eq!((half.ordered.len(), half.similar.len()), (1, 1));
    }

    #[test]
    fn correlation_and_accuracy_of_known_orders() {
        assert_eq!(spearman(&[1.0, 2.0, 5.0], &[-3.0, 0.0, 0.1]), 1.0);
        assert_eq!(spearman(&[1.0, 2.0, 5.0], &[3.0, 2.0, 1.0]), -1.0);
        // Ties at their mean rank: computed by hand from ranks 0, 1.5, 1.5, 3 against 0, 1, 2, 3.
        assert!((spearman(&[0.0, 1.0, 1.0, 2.0], &[0.0, 1.0, 2.0, 3.0]) - 4.5 / (4.5f64 * 5.0).sqrt()).abs() < 1e-12);
        assert_eq!(pair_accuracy(&[3.0, 1.0, 1.0], &[[0, 1], [1, 0], [1, 2]]), 0.5);
    }
}
