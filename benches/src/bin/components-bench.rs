//! The numbers of `docs/components.md`, from the clips in `KINESIC_DATA` (default `../shared/data`):
//! `cargo run --release -p kinesic-benches --bin components-bench -- TABLE [FOLDER]`, where `TABLE` is one of
//!
//! - `motions FOLDER`: ten clips and a made one, `motion0.csv` to `motion10.csv`, for `benches/peers/components.py`
//! - `factor FOLDER`: factorises those that `FOLDER/wanted.csv` names (motion, components, density): times and supports
//! - `penalty`: density, error and objective over the sparsity weight
//! - `explained`: explained content against the number of components used
//! - `transfer`: distances and jerk of sparse components and PCA, with and without the smoothness term
//! - `count`: the automatic number of components beside held-out errors
//! - `learn FOLDER`: 500 steps of Adam, and the matrices for `benches/peers/components.py`

use std::error::Error;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

use faer::linalg::solvers::Solve;
use faer::{Mat, MatRef};
use kinesic_benches::measure::seconds_a_call;
use kinesic_benches::synthetic;
use kinesic_host::clip::ReadOptions;
use kinesic_host::components::{
    FRAME_RATE, Factors, Motion, Objective, Optimiser, Sparsity, Weights, choose, content_distance, gram, jerk, learn,
    noise, pca, refit, sparse, style_distance,
};
use kinesic_host::prepare::Source;
use kinesic_host::rig::Rig;

type Fallible<T> = Result<T, Box<dyn Error>>;

/// Clips of pairs marked `d`, 120 to 320 frames at 60 fps.
const CLIPS: [&str; 10] = [
    "bandai1/guide_normal_001.bvh",
    "bandai1/guide_angry_001.bvh",
    "bandai1/guide_tired_001.bvh",
    "bandai1/bow_normal_001.bvh",
    "bandai1/bow_active_001.bvh",
    "bandai1/bow_masculinity_001.bvh",
    "bandai1/bye_normal_001.bvh",
    "bandai1/bye_angry_001.bvh",
    "xia/neutral_01_000.bvh",
    "xia/angry_01_000.bvh",
];

/// Content and style.
const PAIRS: [[&str; 2]; 5] = [
    ["bandai1/guide_normal_001.bvh", "bandai1/guide_angry_001.bvh"],
    ["bandai1/bow_normal_001.bvh", "bandai1/bow_active_001.bvh"],
    ["bandai1/bye_normal_001.bvh", "bandai1/bye_angry_001.bvh"],
    ["xia/neutral_01_000.bvh", "xia/angry_01_000.bvh"],
    ["xia/neutral_01_000.bvh", "xia/old_01_000.bvh"],
];

const COUNTS: [usize; 3] = [10, 30, 50];
/// Frames and channels of the made motion.
const MADE: [usize; 2] = [200, 69];

fn main() -> Fallible<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let folder = arguments.get(1).map(PathBuf::from);
    match (arguments.first().map(String::as_str), folder) {
        (Some("motions"), Some(folder)) => motions(&folder),
        (Some("factor"), Some(folder)) => factor(&folder),
        (Some("penalty"), _) => penalty(),
        (Some("explained"), _) => explained(),
        (Some("transfer"), _) => transfer(),
        (Some("count"), _) => count(),
        (Some("learn"), Some(folder)) => learning(&folder),
        _ => Err("expected: motions FOLDER, factor FOLDER, penalty, explained, transfer, count or learn FOLDER".into()),
    }
}

fn data() -> PathBuf {
    std::env::var_os("KINESIC_DATA").map_or_else(|| PathBuf::from("../shared/data"), PathBuf::from)
}

fn source(name: &str) -> Fallible<Source> {
    Ok(Source::read(&data().join(name), &ReadOptions::default())?)
}

/// A clip on its own rig, centred on it.
fn own(name: &str) -> Fallible<(Rig, Motion)> {
    let source = source(name)?;
    let rig = source.rig()?;
    let poses = rig.poses(&source.on_rig(&rig, FRAME_RATE)?);
    let rig = rig.centred(&[&poses]);
    let motion = Motion::new(&rig, &rig.locals(&poses));
    Ok((rig, motion))
}

/// Content and style on the content's rig, centred on both.
fn pair([content, style]: [&str; 2]) -> Fallible<(Rig, Motion, Motion)> {
    let content = source(content)?;
    let rig = content.rig()?;
    let content = rig.poses(&content.on_rig(&rig, FRAME_RATE)?);
    let style = rig.poses(&source(style)?.on_rig(&rig, FRAME_RATE)?);
    let rig = rig.centred(&[&content, &style]);
    let motion = Motion::new(&rig, &rig.locals(&content));
    let other = Motion::scaled(&rig, &rig.locals(&style), motion.deviation);
    Ok((rig, motion, other))
}

/// Principal components thinned to their strongest groups: the baseline at equal density.
fn strongest(motion: MatRef<'_, f64>, count: usize, density: f64) -> Factors {
    let mut factors = pca(motion, count);
    let channels = factors.components.nrows();
    let size = |f: &Factors, k: usize, j: usize| (0..3).map(|c| f.components[(3 * j + c, k)].powi(2)).sum::<f64>();
    let mut groups: Vec<(f64, usize, usize)> = (0..count)
        .flat_map(|k| (0..channels / 3).map(move |j| (k, j)))
        .map(|(k, j)| (size(&factors, k, j), k, j))
        .collect();
    groups.sort_by(|a, b| b.0.total_cmp(&a.0));
    for (_, k, j) in groups.iter().skip((density * groups.len() as f64).round() as usize) {
        (0..3).for_each(|c| factors.components[(3 * j + c, *k)] = 0.0);
    }
    factors
}

/// The ten clips, and one that is made: gait-like, less its mean.
fn all_motions() -> Fallible<Vec<Mat<f64>>> {
    let mut motions = CLIPS.iter().map(|name| Ok(own(name)?.1.values)).collect::<Fallible<Vec<_>>>()?;
    let [frames, channels] = MADE;
    let rows = synthetic::rows(&synthetic::channels(channels, 21), frames, |t| t, 22);
    motions.push(synthetic::centred(MatRef::from_row_major_slice(&rows, frames, channels)));
    Ok(motions)
}

fn motions(folder: &Path) -> Fallible<()> {
    fs::create_dir_all(folder)?;
    for (index, motion) in all_motions()?.iter().enumerate() {
        write_matrix(&folder.join(format!("motion{index}.csv")), motion.as_ref())?;
    }
    Ok(())
}

fn factor(folder: &Path) -> Fallible<()> {
    let motions = all_motions()?;
    let mut lines = String::from("motion,components,wanted,method,file,seconds\n");
    for (line, wanted) in fs::read_to_string(folder.join("wanted.csv"))?.lines().enumerate() {
        let [index, count, density] = wanted.split(',').collect::<Vec<_>>()[..] else {
            return Err(format!("wanted.csv, line {}: expected motion,components,density", line + 1).into());
        };
        let motion: &Mat<f64> = motions.get(index.parse::<usize>()?).ok_or("no such motion")?;
        let (m, count, density) = (motion.as_ref(), count.parse()?, density.parse()?);
        let sparsity = Sparsity { density: Some(density), ..Sparsity::default() };
        let seconds = seconds_a_call(0.2, || drop(sparse(m, count, &sparsity)));
        let found = sparse(m, count, &sparsity).factors;
        for (method, factors, seconds) in
            [("kinesic", &found, seconds), ("pca", &strongest(m, count, density), f64::NAN)]
        {
            let file = format!("{method}-{line}.csv");
            write_matrix(&folder.join(&file), factors.components.transpose())?;
            writeln!(lines, "{index},{count},{density},{method},{file},{seconds}")?;
        }
    }
    Ok(fs::write(folder.join("ours.csv"), lines)?)
}

/// What the sparsity weight alone does: no pruning to a wanted density.
fn penalty() -> Fallible<()> {
    const PENALTIES: [f64; 8] = [0.0, 0.003, 0.01, 0.03, 0.1, 0.3, 1.0, 3.0];
    println!(
        "| K | sparsity weight | density | error, refitted | PCA's strongest groups at that density, refitted | objective, start | objective, end | sweeps | ms |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    let motions = CLIPS.iter().map(|name| Ok(own(name)?.1)).collect::<Fallible<Vec<Motion>>>()?;
    for count in COUNTS {
        for penalty in PENALTIES {
            let mut sums = [0.0; 7];
            for motion in &motions {
                let m = motion.values.as_ref();
                let sparsity = Sparsity { penalty, density: None, ..Sparsity::default() };
                let time = seconds_a_call(0.2, || drop(sparse(m, count, &sparsity)));
                let found = sparse(m, count, &sparsity);
                let density = found.factors.density();
                let row = [
                    density,
                    found.factors.error(m),
                    refit(m, &strongest(m, count, density)).error(m),
                    found.history[0],
                    found.history.last().copied().unwrap_or_default(),
                    (found.history.len() - 1) as f64,
                    1e3 * time,
                ];
                sums.iter_mut().zip(row).for_each(|(sum, x)| *sum += x / motions.len() as f64);
            }
            let [density, error, principal, first, last, sweeps, time] = sums;
            println!(
                "| {count} | {penalty} | {density:.3} | {error:.4} | {principal:.4} | {first:.3} | {last:.3} | {sweeps:.0} | {time:.1} |"
            );
        }
    }
    Ok(())
}

fn explained() -> Fallible<()> {
    const USED: [usize; 8] = [1, 2, 3, 5, 8, 12, 20, 30];
    println!("| clip | {} |\n|---|---|---|---|---|---|---|---|---|", USED.map(|used| used.to_string()).join(" | "));
    let mut sums = [[0.0; USED.len()]; 2];
    let row = |shares: &[f64]| shares.iter().map(|s| format!(" {s:.3} |")).collect::<String>();
    for name in CLIPS {
        let (_, motion) = own(name)?;
        let m = motion.values.as_ref();
        let total = m.squared_norm_l2();
        let share = |factors: &Factors| {
            USED.map(|used| {
                // The first components as they are, with the weights that fit best: nothing else is changed.
                let first = factors.components.subcols(0, used).to_owned();
                let weights = project(m, &first);
                1.0 - (m - weights * first.transpose()).squared_norm_l2() / total
            })
        };
        let shares = [share(&sparse(m, 30, &Sparsity::default()).factors), share(&pca(m, 30))];
        println!("| {name} |{}", row(&shares[0]));
        sums.iter_mut()
            .zip(&shares)
            .for_each(|(s, x)| s.iter_mut().zip(x).for_each(|(s, x)| *s += x / CLIPS.len() as f64));
    }
    println!("| mean |{}", row(&sums[0]));
    println!("| mean, principal components |{}", row(&sums[1]));
    Ok(())
}

/// Means over the pairs.
fn transfer() -> Fallible<()> {
    println!(
        "| K, basis, smooth weight | style distance | content distance | jerk / content's | jerk / style's | steps | seconds |"
    );
    println!("|---|---|---|---|---|---|---|");
    let pairs = PAIRS.into_iter().map(pair).collect::<Fallible<Vec<_>>>()?;
    for count in COUNTS {
        for basis in ["PCA", "sparse"] {
            let factorise = |motion: &Motion| match basis {
                "PCA" => pca(motion.values.as_ref(), count),
                _ => sparse(motion.values.as_ref(), count, &Sparsity::default()).factors,
            };
            for smooth in [0.0, 1.0] {
                let weights = Weights { smooth, ..Weights::default() };
                let mut mean = [0.0f64; 6];
                for (rig, content, style) in &pairs {
                    let row = transferred(rig, content, style, [factorise(content), factorise(style)], weights);
                    mean.iter_mut().zip(row).for_each(|(mean, value)| *mean += value / pairs.len() as f64);
                }
                let [style, content, own, other, steps, seconds] = mean;
                println!(
                    "| {count} {basis} {smooth} | {style:.3} | {content:.3} | {own:.2} | {other:.2} | {steps:.0} | {seconds:.3} |"
                );
            }
        }
    }
    Ok(())
}

/// The columns of `transfer` for one pair.
fn transferred(rig: &Rig, content: &Motion, style: &Motion, [own, wanted]: [Factors; 2], weights: Weights) -> [f64; 6] {
    let objective = Objective::new(&own, &wanted, weights);
    let start = Instant::now();
    let learned = learn(&objective, noise(content.channels(), own.count(), 1), &Optimiser::default());
    let seconds = start.elapsed().as_secs_f64();
    let result = Factors { weights: own.weights.clone(), components: learned.components.clone() };
    let [jerk, of_content, of_style] =
        [(&result.product(), &content.mean), (&content.values, &content.mean), (&style.values, &style.mean)].map(
            |(values, mean)| jerk(&rig.positions(&rows(values, mean, &content.scale)), 3 * rig.joints(), FRAME_RATE),
        );
    [
        style_distance(&wanted.components, &learned.components),
        content_distance(&own.components, &learned.components),
        jerk / of_content,
        jerk / of_style,
        (learned.history.len() - 1) as f64,
        seconds,
    ]
}

/// Coordinates, row-major.
fn rows(values: &Mat<f64>, mean: &[f64], scale: &[f64]) -> Vec<f64> {
    let cells = (0..values.nrows()).flat_map(|f| (0..values.ncols()).map(move |c| (f, c)));
    cells.map(|(f, c)| mean[c] + scale[c] * values[(f, c)]).collect()
}

/// Weights of a motion on given components, damped as a pack's projection.
fn project(motion: MatRef<'_, f64>, components: &Mat<f64>) -> Mat<f64> {
    let count = components.ncols();
    let mut normal = components.transpose() * components;
    let energy: f64 = (0..count).map(|k| normal[(k, k)]).sum();
    (0..count).for_each(|k| normal[(k, k)] += 1e-4 * energy / count as f64);
    normal.partial_piv_lu().solve((motion * components).transpose().to_owned()).transpose().to_owned()
}

/// Error of every tenth-of-a-second block that was not trained on, cm a joint, projected on the components.
fn held_out(motion: &Motion, count: usize) -> f64 {
    let of = |fold: usize| (0..motion.frames()).filter(|f| (f / 6) % 5 == fold).collect::<Vec<_>>();
    let mut sum = 0.0;
    for fold in 0..5 {
        let test = of(fold);
        let train: Vec<usize> = (0..motion.frames()).filter(|f| (f / 6) % 5 != fold).collect();
        let pick =
            |frames: &[usize]| Mat::from_fn(frames.len(), motion.channels(), |f, c| motion.values[(frames[f], c)]);
        let factors = sparse(pick(&train).as_ref(), count, &Sparsity::default()).factors;
        let test = pick(&test);
        let weights = project(test.as_ref(), &factors.components);
        sum += (&test - weights * factors.components.transpose()).squared_norm_l2();
    }
    100.0 * motion.deviation * (3.0 * sum / (motion.frames() * motion.channels()) as f64).sqrt()
}

fn count() -> Fallible<()> {
    const TRIED: [usize; 11] = [5, 10, 15, 20, 25, 30, 35, 40, 45, 50, 55];
    println!("| clip | K = 10 | 20 | 30 | 40 | range | chosen | in it |\n|---|---|---|---|---|---|---|---|");
    let mut inside = 0;
    for name in CLIPS {
        let (_, motion) = own(name)?;
        let (choice, _) = choose(&motion, &Sparsity::default());
        let curve = TRIED.map(|count| held_out(&motion, count));
        let lowest = curve.iter().copied().fold(f64::INFINITY, f64::min);
        let first = |share: f64| {
            let good = |(_, error): &(&usize, &f64)| **error - lowest <= share * (curve[0] - lowest);
            TRIED.iter().zip(&curve).find(good).map_or(0, |(count, _)| *count)
        };
        let (low, high) = (first(0.1), first(0.01));
        let hit = (low..=high).contains(&choice.count);
        inside += usize::from(hit);
        let shown: String = [1, 3, 5, 7].iter().map(|index| format!(" {:.2} |", curve[*index])).collect();
        println!("| {name} |{shown} {low} to {high} | {} | {} |", choice.count, if hit { "yes" } else { "no" });
        eprintln!("{name}: {}", choice.reason);
    }
    eprintln!("{inside} of {}", CLIPS.len());
    Ok(())
}

fn learning(folder: &Path) -> Fallible<()> {
    fs::create_dir_all(folder)?;
    let (_, content, style) = pair(PAIRS[1])?;
    let count = 30;
    let own = sparse(content.values.as_ref(), count, &Sparsity::default()).factors;
    let wanted = sparse(style.values.as_ref(), count, &Sparsity::default()).factors;
    let objective = Objective::new(&own, &wanted, Weights::default());
    let start = noise(content.channels(), count, 1);
    write_matrix(&folder.join("content.csv"), own.components.transpose())?;
    write_matrix(&folder.join("gram.csv"), gram(wanted.components.as_ref()).as_ref())?;
    write_matrix(&folder.join("start.csv"), start.transpose())?;
    let fixed = Optimiser { max_steps: 500, threshold: -1.0, ..Optimiser::default() };
    let mut last = f64::NAN;
    let seconds = seconds_a_call(0.2, || {
        let learned = learn(&objective, start.clone(), &fixed);
        assert_eq!(learned.history.len(), 501);
        last = learned.history[500];
    });
    println!("kinesic,{seconds},{last}");
    Ok(())
}

fn write_matrix(path: &Path, matrix: MatRef<'_, f64>) -> Fallible<()> {
    let mut text = String::new();
    for r in 0..matrix.nrows() {
        let row: Vec<String> = (0..matrix.ncols()).map(|c| format!("{:e}", matrix[(r, c)])).collect();
        writeln!(text, "{}", row.join(","))?;
    }
    Ok(fs::write(path, text)?)
}
