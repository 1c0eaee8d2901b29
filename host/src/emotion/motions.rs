//! Labelled clips, cut into motions.

use rand::SeedableRng;
use rand::rngs::ChaCha8Rng;
use rand::seq::SliceRandom;

use super::features;
use super::keyframes::Keyframes;
use super::labels::Labelled;
use super::segment::{Cut, FRAME_RATE, Segment, cut};
use crate::clip::{Clip, ReadOptions};
use crate::learn::Pairs;
use crate::prepare::{PrepareError, Source};
use crate::rig::Rig;

/// A clip on the rig, and what is known about it.
#[derive(Clone, Debug)]
pub struct Example {
    /// Name for messages.
    pub name: String,
    /// The clip, at [`FRAME_RATE`].
    pub clip: Clip,
    /// Level of each attribute, `None` where nobody said.
    pub levels: Vec<Option<f64>>,
    /// Only clips of one group are compared.
    pub group: usize,
    /// Clips of one take are held out together.
    pub take: usize,
}

/// Reads the clips of a table onto `rig`, or onto the skeleton of the first. `progress` hears of every clip before it is read.
pub fn read(
    rows: Vec<Labelled>,
    rig: Option<Rig>,
    options: &ReadOptions,
    progress: &dyn Fn(usize),
) -> Result<(Option<Rig>, Vec<Example>), PrepareError> {
    let (mut rig, mut examples) = (rig, Vec::with_capacity(rows.len()));
    for (index, row) in rows.into_iter().enumerate() {
        progress(index);
        let source = Source::read(&row.path, options)?;
        let on = match &rig {
            Some(rig) => rig,
            None => rig.insert(source.rig()?),
        };
        let clip = source.on_rig(on, FRAME_RATE)?;
        let Labelled { levels, group, take, .. } = row;
        examples.push(Example { name: source.name(), clip, levels, group, take });
    }
    Ok((rig, examples))
}

/// Which takes to hold out: `share` of them, drawn by the seed. True for their rows.
pub fn hold_out(rows: &[Labelled], share: f64, seed: u64) -> Vec<bool> {
    let mut takes: Vec<usize> = rows.iter().map(|row| row.take).collect();
    takes.sort_unstable();
    takes.dedup();
    takes.shuffle(&mut ChaCha8Rng::seed_from_u64(seed));
    takes.truncate((share.clamp(0.0, 1.0) * takes.len() as f64).round() as usize);
    rows.iter().map(|row| takes.contains(&row.take)).collect()
}

/// One motion of an example.
#[derive(Clone, Debug)]
pub struct Motion<'a> {
    /// Where it comes from.
    pub example: &'a Example,
    /// What happens.
    pub segment: Segment,
}

/// All motions of the examples, in their order.
pub fn motions<'a>(rig: &Rig, examples: &'a [Example], how: Cut) -> Vec<Motion<'a>> {
    let of =
        |example: &'a Example| cut(rig, &example.clip, how).into_iter().map(move |segment| Motion { example, segment });
    examples.iter().flat_map(of).collect()
}

/// Features of the motions, `[motions x (keyframes x 6 joints)]`; a motion that has fewer frames than keyframes is dropped.
pub fn features<'a>(motions: Vec<Motion<'a>>, keyframes: &Keyframes) -> (Vec<Motion<'a>>, Vec<f64>) {
    let mut rows = Vec::new();
    let long = motions.into_iter().filter(|motion| {
        let found = features::features(&motion.segment, keyframes);
        rows.extend(found.iter().flatten());
        found.is_some()
    });
    (long.collect(), rows)
}

/// Pairs of motions by an attribute, within groups.
pub fn pairs(motions: &[Motion], attribute: usize) -> Pairs {
    let levels: Vec<Option<f64>> = motions.iter().map(|motion| motion.example.levels[attribute]).collect();
    let groups: Vec<usize> = motions.iter().map(|motion| motion.example.group).collect();
    Pairs::of_levels(&levels, &groups, 0.0)
}

/// Take of each motion.
pub fn takes(motions: &[Motion]) -> Vec<usize> {
    motions.iter().map(|motion| motion.example.take).collect()
}
