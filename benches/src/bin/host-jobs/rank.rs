//! The ranking function: 1,000 motions, 100,000 pairs, tested on 1,000 motions more.

use std::error::Error;
use std::path::Path;

use kinesic_host::learn::{Pairs, RankOptions, Samples, choose_cost, pair_accuracy, rank};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use serde_json::{Value, json};

use crate::motions::{self, CHANNELS, COMPONENTS, KEYFRAMES};
use kinesic_benches::measure::{peak_mib, timed, write};

const MOTIONS: f64 = 1000.0;
const PAIRS: f64 = 100_000.0;
/// Judged strengths that differ by less are alike.
const ALIKE: f64 = 0.4;

/// What the motions are ranked by.
#[derive(Clone, Copy, PartialEq)]
pub enum Kind {
    /// 13 keyframes of 40 principal components; ordered pairs only, which every peer knows.
    Reduced,
    /// The same with similar pairs among the others.
    Similar,
    /// 13 keyframes of 120 numbers; ordered pairs only.
    Full,
}

pub fn run(folder: &Path, scale: f64, kind: Kind) -> Result<Value, Box<dyn Error>> {
    let count = (MOTIONS * scale).round() as usize;
    let made = motions::made(2 * count);
    let (values, columns) = match kind {
        Kind::Full => (made.values, KEYFRAMES * CHANNELS),
        _ => (made.reduced(count), KEYFRAMES * COMPONENTS),
    };
    let mut random = ChaCha8Rng::seed_from_u64(12);
    let wanted = (PAIRS * scale).round() as usize;
    let pairs = drawn(&made.judged[..count], wanted, kind == Kind::Similar, &mut random);
    let held = drawn(&made.judged[count..], wanted, false, &mut random).ordered;
    let (train, test) = values.split_at(count * columns);
    write(folder, "train.f64", train)?;
    write(folder, "test.f64", test)?;
    for (name, pairs) in [("ordered.u32", &pairs.ordered), ("similar.u32", &pairs.similar), ("held.u32", &held)] {
        write(folder, name, pairs.as_flattened())?;
    }
    let (train, test) = (Samples::new(train, columns), Samples::new(test, columns));
    let takes: Vec<usize> = (0..count).collect();
    let (choosing, choice) = timed(|| choose_cost(&train, &pairs, &takes, &RankOptions::default()));
    let options = RankOptions { cost: choice.cost, ..RankOptions::default() };
    let (seconds, ranked) = timed(|| rank(&train, &pairs, &options, &[]));
    Ok(json!({
        "seconds": seconds, "choosing": choosing, "peak_mib": peak_mib(), "cost": choice.cost, "validated": choice.accuracy,
        "objective": ranked.history.last(), "accuracy": pair_accuracy(&ranked.scores(&test), &held),
        "motions": count, "columns": columns, "ordered": pairs.ordered.len(), "similar": pairs.similar.len(),
    }))
}

/// So many pairs of motions drawn at random; those that are alike are kept or not.
fn drawn(judged: &[f64], wanted: usize, alike: bool, random: &mut ChaCha8Rng) -> Pairs {
    let mut pairs = Pairs::default();
    while pairs.len() < wanted {
        let [i, j] = [0; 2].map(|_: usize| random.random_range(0..judged.len()));
        let apart = judged[i] - judged[j];
        if apart.abs() > ALIKE {
            pairs.ordered.push(if apart > 0.0 { [i as u32, j as u32] } else { [j as u32, i as u32] });
        } else if alike && i != j {
            pairs.similar.push([i as u32, j as u32]);
        }
    }
    pairs
}
