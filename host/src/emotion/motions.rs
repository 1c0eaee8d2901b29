//! Labelled clips, cut into motions.

use super::features;
use super::keyframes::Keyframes;
use super::pairs::Pairs;
use super::segment::{Cut, Segment, cut};
use crate::clip::Clip;
use crate::rig::Rig;

/// A clip on the rig, and what is known about it.
#[derive(Clone, Debug)]
pub struct Example {
    /// Name for messages.
    pub name: String,
    /// The clip, at [`FRAME_RATE`](super::segment::FRAME_RATE).
    pub clip: Clip,
    /// Level of each attribute, `None` where nobody said.
    pub levels: Vec<Option<f64>>,
    /// Only clips of one group are compared.
    pub group: usize,
    /// Clips of one take are held out together.
    pub take: usize,
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
