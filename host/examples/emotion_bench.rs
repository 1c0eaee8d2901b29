//! Tables of docs/emotion.md that need more than one training: `docs/emotion.sh` runs it.
//!
//! `emotion_bench accuracy TABLE.tsv ORDER...`: ranking accuracy on unseen takes by share of training pairs and by components.

use std::path::Path;

use kinesic_host::clip::ReadOptions;
use kinesic_host::emotion::features::Projection;
use kinesic_host::emotion::keyframes::Keyframes;
use kinesic_host::emotion::labels::{self, Attribute};
use kinesic_host::emotion::motions::{self, Example, Motion, features, pairs, takes};
use kinesic_host::emotion::segment::Cut;
use kinesic_host::emotion::{RankOptions, Samples, choose_cost, pair_accuracy, rank};
use kinesic_host::rig::Rig;
use rand::SeedableRng;
use rand::rngs::ChaCha8Rng;
use rand::seq::SliceRandom;

type Failure = Box<dyn std::error::Error>;

const SHARES: [f64; 5] = [0.1, 0.3, 0.5, 0.7, 0.9];
const REPETITIONS: u64 = 3;
const KEYFRAMES: usize = 13;

fn main() -> Result<(), Failure> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    match args.iter().map(String::as_str).collect::<Vec<_>>().as_slice() {
        ["accuracy", table, orders @ ..] => accuracy(Path::new(table), orders),
        _ => Err("usage: emotion_bench accuracy TABLE.tsv ORDER...".into()),
    }
}

fn attributes(orders: &[&str]) -> Result<Vec<Attribute>, Failure> {
    let one = |order: &&str| {
        if order.contains('>') { Attribute::from_order(order) } else { Ok(Attribute::from_column(order)) }
    };
    Ok(orders.iter().map(one).collect::<Result<_, _>>()?)
}

fn read(table: &Path, attributes: &[Attribute]) -> Result<(Rig, Vec<Example>), Failure> {
    let (rig, examples) = motions::read(labels::read(table, attributes)?, None, &ReadOptions::default(), &|_| ())?;
    Ok((rig.ok_or("no rows")?, examples))
}

fn accuracy(table: &Path, orders: &[&str]) -> Result<(), Failure> {
    let attributes = attributes(orders)?;
    let (rig, examples) = read(table, &attributes)?;
    let cut = Cut::suggested(&rig, examples.iter().map(|example| &example.clip));
    let all = motions::motions(&rig, &examples, cut);
    eprintln!("{} clips, {cut:?}, {} motions", examples.len(), all.len());
    let mut numbers: Vec<usize> = examples.iter().map(|example| example.take).collect();
    numbers.sort_unstable();
    numbers.dedup();
    // [attribute][components][share]: right pairs, pairs.
    let mut right = vec![[[[0.0; 2]; SHARES.len()]; 3]; attributes.len()];
    for seed in 1..=REPETITIONS {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        numbers.shuffle(&mut random);
        let trained = &numbers[..numbers.len() / 2];
        let is_trained = |motion: &Motion| trained.contains(&motion.example.take);
        let seen: Vec<_> = all.iter().filter(|m| is_trained(m)).map(|m| &m.segment).collect();
        let keyframes = Keyframes::learn(&rig, &seen, KEYFRAMES);
        let (motions, rows) = features(all.clone(), &keyframes);
        let keep: Vec<bool> = motions.iter().map(is_trained).collect();
        let held: Vec<bool> = keep.iter().map(|keep| !keep).collect();
        let width = 6 * rig.joints();
        let seen: Vec<f64> = rows
            .chunks_exact(KEYFRAMES * width)
            .zip(&keep)
            .filter(|(_, keep)| **keep)
            .flat_map(|(row, _)| row.to_vec())
            .collect();
        let seen = Samples::new(&seen, width);
        let projections = [Projection::learn(&seen, 40), Projection::learn(&seen, 80), Projection::identity(&seen)];
        for (kind, projection) in projections.iter().enumerate() {
            let coordinates = projection.coordinates(&rows);
            let samples = Samples::new(&coordinates, KEYFRAMES * projection.count());
            for (attribute, right) in right.iter_mut().enumerate() {
                let pairs = pairs(&motions, attribute);
                let (fitted, judged) = (pairs.among(&keep), pairs.among(&held).ordered);
                if judged.is_empty() {
                    continue;
                }
                for (share, [hits, count]) in SHARES.iter().zip(&mut right[kind]) {
                    let drawn = fitted.sample(*share, &mut random);
                    let choice = choose_cost(&samples, &drawn, &takes(&motions), &RankOptions::default());
                    let ranked =
                        rank(&samples, &drawn, &RankOptions { cost: choice.cost, ..RankOptions::default() }, &[]);
                    *hits += pair_accuracy(&ranked.scores(&samples), &judged) * judged.len() as f64;
                    *count += judged.len() as f64;
                }
            }
        }
    }
    for (attribute, right) in attributes.iter().zip(&right) {
        for (name, right) in ["40", "80", "no PCA"].iter().zip(right) {
            let cells: Vec<String> = right.iter().map(|[hits, count]| format!("{:.1}", 100.0 * hits / count)).collect();
            println!(
                "| {} | {} | {name} | {} |",
                table.file_stem().unwrap_or_default().display(),
                attribute.name,
                cells.join(" | ")
            );
        }
    }
    Ok(())
}
