//! Whether the style of translated motion is recognised, and how near heads and hands come to their targets: the tables of
//! `docs/quality.md`, from the clips of bandai2 in `KINESIC_DATA` (default `../shared/data`):
//! `cargo run --release -p kinesic-benches --bin recognition -- [several] [auto|warp|uniform|in-step|opposite]`
//!
//! Two takes of every action and style teach, the other two judge; then the other way round. A pack is trained for every action and
//! style, with `several` one for all actions of a style, from `normal`, with the library's default options unless an alignment is given. The device's code plays it on the takes of
//! `normal` that judge, and on the mirror images of them. Linear classifiers that have seen the real clips that teach say which style they see.

mod classifier;
mod clips;
mod tally;

use std::error::Error;

use classifier::{Classifier, features};
use clips::{ACTIONS, Clips, FRAME_RATE, Poses, STYLES, Take};
use kinesic::Pose;
use kinesic_host::measure::turns::Turns;
use kinesic_host::pack::{Baselines, PackFile, Provenance};
use kinesic_host::rig::{MAX_JOINTS, Rig};
use kinesic_host::translate::{Alignment, NamedPair, Settings, TrainOptions, TrainPair, evaluate, play, train};
use tally::{SEEN, Shown, Tally};

type Fallible<T> = Result<T, Box<dyn Error>>;

/// Takes that teach, and takes that judge.
const FOLDS: [[[usize; 2]; 2]; 2] = [[[1, 2], [3, 4]], [[3, 4], [1, 2]]];

fn main() -> Fallible<()> {
    let mut several = false;
    let mut alignment = None;
    for argument in std::env::args().skip(1) {
        match argument.as_str() {
            "several" => several = true,
            "auto" => alignment = None,
            "warp" => alignment = Some(Alignment::Warp),
            "uniform" => alignment = Some(Alignment::Uniform),
            "in-step" => alignment = Some(Alignment::InStep),
            "opposite" => alignment = Some(Alignment::Opposite),
            _ => return Err("expected: several; auto, warp, uniform, in-step or opposite".into()),
        }
    }
    let options = TrainOptions { alignment, ..TrainOptions::default() };
    let clips = Clips::read()?;
    let mut tally = Tally::default();
    let all: Vec<usize> = (0..ACTIONS.len()).collect();
    for [teach, judge] in FOLDS {
        let (judges, strangers) = (Judges::new(&clips, &teach)?, Judges::new(&clips, &judge)?);
        for style in 0..STYLES.len() {
            for action in &all {
                for take in judge {
                    let real = &clips.take(*action, style, take).poses;
                    tally.count(Shown::Real, style, judges.styles(&clips.rig, real));
                }
            }
            if style == 0 {
                continue;
            }
            let sets: Vec<&[usize]> = if several { vec![&all] } else { all.chunks(1).collect() };
            for actions in sets {
                let learned = Learned::new(&clips, &options, actions, style, teach)?;
                for action in actions {
                    learned.judge(&clips, [&judges, &strangers], [*action, style], judge, &mut tally)?;
                }
            }
        }
    }
    tally.print();
    Ok(())
}

/// A style of some actions, and what it was learned from.
struct Learned<'a> {
    rig: Rig,
    file: PackFile,
    baselines: Baselines,
    turns: Turns,
    /// Takes of `normal` and of the style, by action.
    taught: Vec<(usize, Vec<[&'a Take; 2]>)>,
}

impl<'a> Learned<'a> {
    fn new(
        clips: &'a Clips,
        options: &TrainOptions,
        actions: &[usize],
        style: usize,
        teach: [usize; 2],
    ) -> Fallible<Self> {
        let pair = |action, take| [0, style].map(|style| clips.take(action, style, take));
        let taught: Vec<(usize, Vec<[&Take; 2]>)> =
            actions.iter().map(|action| (*action, teach.iter().map(|take| pair(*action, *take)).collect())).collect();
        let all = || taught.iter().flat_map(|(_, pairs)| pairs.iter().copied());
        let rig = clips.rig.centred(&all().flatten().map(|take| take.poses.as_slice()).collect::<Vec<_>>());
        let train_pair = |[source, target]: [&Take; 2]| TrainPair {
            source_name: source.name.clone(),
            target_name: target.name.clone(),
            source: rig.locals(&source.poses),
            target: rig.locals(&target.poses),
        };
        let pairs: Vec<TrainPair> = all().map(train_pair).collect();
        let trained = train(&rig, &pairs, STYLES[style], FRAME_RATE, options, &|_| {})?;
        eprintln!("{} of {} actions: {:?}", STYLES[style], actions.len(), trained.candidate);
        let file = PackFile::from_bytes(&trained.model.pack(&rig, &Provenance::default()));
        let turns = Turns::of_pairs(&rig, all().map(|[source, target]| (&source.clip, &target.clip)))?;
        Ok(Self { rig, file, baselines: trained.baselines, turns, taught })
    }

    /// Counts what the classifiers see when it plays takes that it has not seen.
    fn judge(
        &self,
        clips: &Clips,
        [judges, strangers]: [&Judges; 2],
        [action, style]: [usize; 2],
        judge: [usize; 2],
        tally: &mut Tally,
    ) -> Fallible<()> {
        let (rig, pack) = (&self.rig, self.file.pack()?);
        let taught = self.taught.iter().find(|(taught, _)| *taught == action).ok_or("an action that was not taught")?;
        let judge = judge.map(|take| [0, style].map(|style| clips.take(action, style, take)));
        for [source, target] in judge {
            let mut show =
                |shown, poses: &[Pose<MAX_JOINTS>]| tally.count(shown, style, judges.styles(&clips.rig, poses));
            show(Shown::Source, &source.poses);
            show(Shown::Offset, &offset(rig, &taught.1, source));
            let output = rig.poses(&play(&pack, rig, &source.clip, &Settings::default())?);
            show(Shown::Output, &output);
            tally.spread(style, [target.poses.as_slice(), &output].map(|poses| seen(&clips.rig, poses)[1].clone()));
            tally.count(Shown::ToStrangers, style, strangers.styles(&clips.rig, &output));
        }
        let named = judge.map(|pair| {
            let [source, target] = pair.map(|take| (take.name.as_str(), &take.clip));
            NamedPair { source, target }
        });
        let report = evaluate(&pack, rig, &self.baselines, Some(&self.turns), &named)?;
        tally.errors.extend(report.pairs.into_iter().map(|pair| (ACTIONS[action], pair.errors)));
        let sides = rig.sides().ok_or("a body whose sides are not alike")?;
        let images = judge.map(|pair| pair.map(|take| sides.mirrored(&take.clip)));
        let named = images
            .each_ref()
            .map(|[source, target]| NamedPair { source: ("source", source), target: ("target", target) });
        let report = evaluate(&pack, rig, &self.baselines, None, &named)?;
        tally.images.extend(report.pairs.into_iter().map(|pair| (ACTIONS[action], pair.errors)));
        Ok(())
    }
}

/// The source with the mean difference of the clips that teach added to its coordinates, as the device writes it.
fn offset(rig: &Rig, teach: &[[&Take; 2]], source: &Take) -> Poses {
    let mean = |style: usize| -> Vec<f64> {
        let rows: Vec<f64> = teach.iter().flat_map(|pair| rig.locals(&pair[style].poses).coordinates).collect();
        features(&rows, 3 * rig.rows(), 0)
    };
    let change: Vec<f64> = mean(1).iter().zip(mean(0)).map(|(styled, neutral)| styled - neutral).collect();
    rig.restyle(&source.poses, |frame| {
        // Means come before deviations.
        frame.coordinates_mut().iter_mut().zip(&change[..3 * rig.rows()]).for_each(|(x, change)| *x += *change as f32);
    })
}

/// A classifier for each kind of features.
struct Judges([Classifier; SEEN]);

impl Judges {
    fn new(clips: &Clips, takes: &[usize]) -> Fallible<Self> {
        let mut samples = [const { Vec::new() }; SEEN];
        for action in 0..ACTIONS.len() {
            for style in 0..STYLES.len() {
                for take in takes {
                    let seen = seen(&clips.rig, &clips.take(action, style, *take).poses);
                    samples.iter_mut().zip(seen).for_each(|(samples, features)| samples.push((features, style)));
                }
            }
        }
        let fit = |samples: &[_]| Classifier::fit(samples, STYLES.len()).ok_or("the classifier is undetermined");
        let [both, deviations, positions] = samples.each_ref().map(|samples| fit(samples));
        Ok(Self([both?, deviations?, positions?]))
    }

    fn styles(&self, rig: &Rig, poses: &[Pose<MAX_JOINTS>]) -> [usize; SEEN] {
        let seen = seen(rig, poses);
        std::array::from_fn(|kind| self.0[kind].class(&seen[kind]))
    }
}

/// Features, as [`tally::KINDS`] names them. The root is turned against its heading, and positions are heading-local.
fn seen(rig: &Rig, poses: &[Pose<MAX_JOINTS>]) -> [Vec<f64>; SEEN] {
    let locals = rig.locals(poses);
    // The first row is travel and height.
    let rotations = features(&locals.coordinates, 3 * locals.rows, 3);
    // Means come before deviations.
    let deviations = rotations[rotations.len() / 2..].to_vec();
    [rotations, deviations, features(&locals.positions, locals.channels, 0)]
}
