//! Tables of docs/emotion.md that need more than one training: `docs/emotion.sh` runs it.
//!
//! - `accuracy TABLE.tsv ORDER...`: ranking accuracy on unseen takes by share of training pairs and by components
//! - `transfer TRAIN.tsv TEST.tsv COLUMN...`: rank correlation with known strengths, trained on other clips; baselines
//! - `keyframes TABLE.tsv ORDER`: error of the spline by number of keyframes, chosen in three ways
//! - `synthesis PACK.kin`: 21 strengths of each attribute, what is read from the played motion, hand speed
//! - `mix PACK.kin`: two strengths at once
//! - `turns PACK.kin TABLE.tsv ORDER`: by how much head and hands turn from the weakest label to the strongest

use std::path::Path;

use kinesic::Pack;
use kinesic::model::ATTRIBUTES;
use kinesic_host::clip::{Canonical, Clip, ReadOptions};
use kinesic_host::emotion::evaluate::{Scorer, evaluate, mean};
use kinesic_host::emotion::features::Projection;
use kinesic_host::emotion::keyframes::{Curve, Keyframes};
use kinesic_host::emotion::labels::{self, Attribute};
use kinesic_host::emotion::motions::{self, Example, Motion, features, pairs, takes};
use kinesic_host::emotion::play::{Settings, play};
use kinesic_host::emotion::segment::{Cut, FRAME_RATE, Segment};
use kinesic_host::emotion::{HostEmotion, TrainOptions, train};
use kinesic_host::learn::{RankOptions, Samples, choose_cost, pair_accuracy, rank, spearman};
use kinesic_host::pack::{PackFile, Provenance};
use kinesic_host::rig::Rig;
use nalgebra::{UnitQuaternion, Vector4};
use rand::SeedableRng;
use rand::rngs::ChaCha8Rng;
use rand::seq::SliceRandom;

type Failure = Box<dyn std::error::Error>;

const SHARES: [f64; 5] = [0.1, 0.3, 0.5, 0.7, 0.9];
const REPETITIONS: u64 = 3;
const KEYFRAMES: usize = 13;
const SHUFFLES: u64 = 10;
const STEPS: usize = 21;

fn main() -> Result<(), Failure> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    match args.iter().map(String::as_str).collect::<Vec<_>>().as_slice() {
        ["accuracy", table, orders @ ..] => accuracy(Path::new(table), orders),
        ["transfer", train, test, columns @ ..] => transfer(Path::new(train), Path::new(test), columns),
        ["keyframes", table, orders @ ..] => keyframes(Path::new(table), orders),
        ["synthesis", pack] => synthesis(Path::new(pack)),
        ["mix", pack] => mix(Path::new(pack)),
        ["turns", pack, table, order] => turns(Path::new(pack), Path::new(table), order),
        _ => Err("usage: see the first lines of host/examples/emotion_bench.rs".into()),
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

/// Trained with the library's defaults, as `kinesic train emotion` does.
fn pack(rig: &Rig, attributes: &[Attribute], examples: &[Example]) -> Result<PackFile, Failure> {
    let names: Vec<String> = attributes.iter().map(|attribute| attribute.name.clone()).collect();
    let trained = train(rig, "bench", &names, examples, &TrainOptions::default())?;
    Ok(PackFile::from_bytes(&trained.model.pack(&trained.rig, &Provenance::default())))
}

fn transfer(trained: &Path, test: &Path, columns: &[&str]) -> Result<(), Failure> {
    let attributes = attributes(columns)?;
    let (rig, examples) = read(trained, &attributes)?;
    let (_, others) =
        motions::read(labels::read(test, &attributes)?, Some(rig.clone()), &ReadOptions::default(), &|_| ())?;
    let file = pack(&rig, &attributes, &examples)?;
    let view = file.pack()?;
    let report = evaluate(&Scorer::load(&view)?, &others);
    let mut shuffled = vec![0.0; attributes.len()];
    for seed in 0..SHUFFLES {
        let mut levels: Vec<_> = examples.iter().map(|example| example.levels.clone()).collect();
        levels.shuffle(&mut ChaCha8Rng::seed_from_u64(seed));
        let lied: Vec<Example> =
            examples.iter().zip(levels).map(|(example, levels)| Example { levels, ..example.clone() }).collect();
        // Where lies teach nothing, nothing is read.
        let Ok(file) = pack(&rig, &attributes, &lied) else { continue };
        let view = file.pack()?;
        let report = evaluate(&Scorer::load(&view)?, &others);
        shuffled.iter_mut().zip(report.attributes).for_each(|(sum, a)| *sum += a.spearman.abs() / SHUFFLES as f64);
    }
    let speed = |of: &dyn Fn(&Example) -> f64, attribute: usize| {
        let known = others.iter().filter_map(|example| Some((example.levels[attribute]?, of(example))));
        let (levels, speeds): (Vec<f64>, Vec<f64>) = known.unzip();
        spearman(&levels, &speeds)
    };
    for (index, a) in report.attributes.iter().enumerate() {
        println!(
            "| {} | {} | {} | {} | {:.3} | {:.1} | {:.3} | {:.3} | {:.3} |",
            trained.file_stem().unwrap_or_default().display(),
            test.file_stem().unwrap_or_default().display(),
            a.attribute,
            a.labelled,
            a.spearman,
            100.0 * a.pair_accuracy,
            speed(&|example| root_speed(&example.clip), index),
            speed(&|example| hand_speed(&rig, &example.clip), index),
            shuffled[index],
        );
    }
    Ok(())
}

/// Mean speed of the root along the ground, m/s.
fn root_speed(clip: &Clip) -> f64 {
    let way: f64 = clip.root.windows(2).map(|pair| (pair[1] - pair[0]).xz().norm()).sum();
    way / clip.duration()
}

/// Mean speed of the hands against the root, m/s.
fn hand_speed(rig: &Rig, clip: &Clip) -> f64 {
    let hands = [Canonical::LWrist, Canonical::RWrist].map(|hand| rig.map.joint(hand).unwrap_or_default());
    let positions: Vec<_> = (0..clip.frames()).map(|frame| clip.positions(frame)).collect();
    let step = |pair: &[Vec<nalgebra::Vector3<f64>>]| {
        hands.iter().map(|hand| ((pair[1][*hand] - pair[1][0]) - (pair[0][*hand] - pair[0][0])).norm()).sum::<f64>()
    };
    positions.windows(2).map(step).sum::<f64>() / (2.0 * clip.duration())
}

fn keyframes(table: &Path, orders: &[&str]) -> Result<(), Failure> {
    let (rig, examples) = read(table, &attributes(orders)?)?;
    let cut = Cut::suggested(&rig, examples.iter().map(|example| &example.clip));
    let all = motions::motions(&rig, &examples, cut);
    let segments: Vec<&Segment> = all.iter().map(|motion| &motion.segment).filter(|s| s.frames() >= 25).collect();
    let curves: Vec<Curve> = segments.iter().map(|segment| Curve::of(segment)).collect();
    let mean = |errors: Vec<f64>| 100.0 * (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt();
    eprintln!("{} motions", segments.len());
    for count in [5, 7, 9, 11, 13, 15, 17, 19, 21, 23, 25] {
        let shared = Keyframes::learn(&rig, &segments, count);
        let found = segments.iter().zip(&curves).filter_map(|(s, curve)| Some(curve.error(&shared.find(s)?)));
        println!(
            "| {count} | {:.2} | {:.2} | {:.2} |",
            mean(curves.iter().map(|curve| curve.error(&curve.uniform(count))).collect()),
            mean(found.collect()),
            mean(curves.iter().map(|curve| curve.error(&curve.simplify(count))).collect()),
        );
    }
    Ok(())
}

/// What is read from the motion that the device plays at these strengths, and its clip.
fn played(view: &Pack, scorer: &Scorer, strengths: &[f32]) -> Result<(Vec<f64>, Clip), Failure> {
    let mut asked = [0.0; ATTRIBUTES];
    asked[..strengths.len()].copy_from_slice(strengths);
    let settings = Settings { from: asked, to: asked, fps: FRAME_RATE, seconds: None };
    let one = play(view, &settings)?;
    // Cycles are read between strikes: the first and the last round are cut.
    let rounds = if HostEmotion::load(view)?.meta().cycle { 5.0 } else { 1.0 };
    let seconds = f64::from(rounds * one.round[0]);
    let clip = play(view, &Settings { seconds: Some(seconds), ..settings })?.clip;
    let read = mean(&scorer.read(&clip));
    if read.is_empty() { Err(format!("nothing is read at {strengths:?}").into()) } else { Ok((read, clip)) }
}

fn ranges(view: &Pack) -> Result<Vec<(String, [f32; 2])>, Failure> {
    let emotion = HostEmotion::load(view)?;
    Ok(emotion.meta().attributes.iter().flatten().map(|a| (a.name.to_owned(), a.strength)).collect())
}

fn synthesis(path: &Path) -> Result<(), Failure> {
    let file = PackFile::read(path)?;
    let view = file.pack()?;
    let (scorer, ranges) = (Scorer::load(&view)?, ranges(&view)?);
    for (index, (name, [low, high])) in ranges.iter().enumerate() {
        let (mut asked, mut read, mut hands) = (Vec::new(), Vec::new(), Vec::new());
        for step in 0..STEPS {
            let mut strengths: Vec<f32> = ranges.iter().map(|(_, [low, high])| 0.5 * (low + high)).collect();
            strengths[index] = low + (high - low) * step as f32 / (STEPS - 1) as f32;
            let (scores, clip) = played(&view, &scorer, &strengths)?;
            asked.push(f64::from(strengths[index]));
            read.push(scores[index]);
            hands.push(hand_speed(&scorer.rig, &clip));
            println!("| {name} | {:.3} | {:.3} | {:.3} |", asked[step], read[step], hands[step]);
        }
        let worst = asked.iter().zip(&read).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        println!(
            "{name}: Spearman of asked and read {:.4}, off by at most {worst:.3}; of asked and hand speed {:.4}",
            spearman(&asked, &read),
            spearman(&asked, &hands)
        );
    }
    Ok(())
}

fn mix(path: &Path) -> Result<(), Failure> {
    let file = PackFile::read(path)?;
    let view = file.pack()?;
    let (scorer, ranges) = (Scorer::load(&view)?, ranges(&view)?);
    let [(first, a), (second, b), ..] = ranges.as_slice() else { return Err("the pack has one attribute".into()) };
    println!("| {first} asked | {second} asked | {first} read | {second} read |\n|---|---|---|---|");
    let at = |[low, high]: [f32; 2], part: f32| low + part * (high - low);
    let (mut asked, mut read) = ([Vec::new(), Vec::new()], [Vec::new(), Vec::new()]);
    for x in [0.1, 0.3, 0.5, 0.7, 0.9] {
        for y in [0.1, 0.3, 0.5, 0.7, 0.9] {
            let mut strengths: Vec<f32> = ranges.iter().map(|(_, range)| at(*range, 0.5)).collect();
            (strengths[0], strengths[1]) = (at(*a, x), at(*b, y));
            let (scores, _) = played(&view, &scorer, &strengths)?;
            println!("| {:.2} | {:.2} | {:.2} | {:.2} |", strengths[0], strengths[1], scores[0], scores[1]);
            for k in 0..2 {
                asked[k].push(f64::from(strengths[k]));
                read[k].push(scores[k]);
            }
        }
    }
    println!("Spearman of asked and read: {:.4}, {:.4}", spearman(&asked[0], &read[0]), spearman(&asked[1], &read[1]));
    Ok(())
}

/// Mean local rotation of a joint.
fn mean_rotation<'a>(clips: impl Iterator<Item = &'a Clip>, joint: usize) -> UnitQuaternion<f64> {
    let mut sum = Vector4::zeros();
    for q in clips.flat_map(|clip| clip.rotations.iter().skip(joint).step_by(clip.skeleton.joints.len())) {
        sum += if sum.dot(&q.coords) < 0.0 { -q.coords } else { q.coords };
    }
    UnitQuaternion::new_normalize(sum.into())
}

fn turns(path: &Path, table: &Path, order: &str) -> Result<(), Failure> {
    let file = PackFile::read(path)?;
    let view = file.pack()?;
    let scorer = Scorer::load(&view)?;
    let rows = labels::read(table, &attributes(&[order])?)?;
    let (_, examples) = motions::read(rows, Some(scorer.rig.clone()), &ReadOptions::default(), &|_| ())?;
    let made = [played(&view, &scorer, &[0.0])?.1, played(&view, &scorer, &[1.0])?.1];
    let labelled = |level: f64| examples.iter().filter(move |e| e.levels[0] == Some(level)).map(|e| &e.clip);
    let (mut cells, mut heads) = (Vec::new(), Vec::new());
    for (name, joint) in
        [("head", Canonical::Head), ("left hand", Canonical::LWrist), ("right hand", Canonical::RWrist)]
    {
        let Some(joint) = scorer.rig.map.joint(joint) else { continue };
        let [weak, strong] = made.each_ref().map(|clip| mean_rotation(std::iter::once(clip), joint));
        let recorded = mean_rotation(labelled(0.0), joint).angle_to(&mean_rotation(labelled(1.0), joint));
        heads.push(name);
        cells.push(format!("{:.1} ({:.1})", weak.angle_to(&strong).to_degrees(), recorded.to_degrees()));
    }
    println!("| {} | {} | ({})", path.file_stem().unwrap_or_default().display(), cells.join(" | "), heads.join(", "));
    Ok(())
}
