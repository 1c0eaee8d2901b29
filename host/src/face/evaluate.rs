//! Reads faces through the device's code, and says how well their order agrees with the labels.

use kinesic::Pack;
use kinesic::face::{FaceSynth, Reading};
use kinesic::model::LoadError;
use serde::Serialize;

use super::landmarks::Face;
use super::model::{HostFace, MAX_UNITS};
use crate::learn::spearman;

/// A face and what the device reads from it.
#[derive(Clone, Debug)]
pub struct Read<'a> {
    /// The face.
    pub face: &'a Face,
    /// Cluster and strength.
    pub reading: Reading,
}

/// How well the strengths agree with the labels. NaN, `null` in JSON, where there is no pair.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// Faces in the table.
    pub faces: usize,
    /// Those with a label.
    pub labelled: usize,
    /// Pairs of faces with different labels.
    pub pairs: u64,
    /// Share of these pairs whose strengths are in the order of the labels; a tie counts half.
    pub pair_accuracy: f64,
    /// Spearman's rank correlation of strength and label.
    pub spearman: f64,
    /// Pairs within a cluster of head pose.
    pub pairs_within_clusters: u64,
    /// Share of those in the right order.
    pub pair_accuracy_within_clusters: f64,
    /// Cluster by cluster.
    pub clusters: Vec<ClusterReport>,
}

/// The same within one cluster.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ClusterReport {
    /// Labelled faces.
    pub labelled: usize,
    /// Pairs of them with different labels.
    pub pairs: u64,
    /// Share in the right order.
    pub pair_accuracy: f64,
    /// Rank correlation.
    pub spearman: f64,
}

/// Every face through the device's code, each as the first of a stream.
pub fn read_all<'a>(pack: &Pack, faces: &'a [Face]) -> Result<Vec<Read<'a>>, LoadError> {
    let model = HostFace::load(pack)?;
    // What is no face has been refused while reading.
    let one = |face: &'a Face| Some(Read { face, reading: model.read(&face.landmarks)? });
    Ok(faces.iter().filter_map(one).collect())
}

/// Measures a pack on faces.
pub fn evaluate(pack: &Pack, faces: &[Face]) -> Result<Report, LoadError> {
    let clusters = FaceSynth::<MAX_UNITS>::load(pack)?.meta().clusters as usize;
    let read = read_all(pack, faces)?;
    let of = |chosen: &dyn Fn(&Read) -> bool| {
        let labelled = read.iter().filter(|read| chosen(read)).filter_map(|read| Some((read.face.label?, read)));
        labelled.map(|(label, read)| (label, f64::from(read.reading.strength))).unzip::<_, _, Vec<f64>, Vec<f64>>()
    };
    let (labels, strengths) = of(&|_| true);
    let (pairs, right) = pair_accuracy(&labels, &strengths);
    let (mut within, mut within_right) = (0, 0.0);
    let mut reports = Vec::with_capacity(clusters);
    for cluster in 0..clusters {
        let (labels, strengths) = of(&|read| read.reading.cluster == cluster);
        let (pairs, right) = pair_accuracy(&labels, &strengths);
        within += pairs;
        within_right += right;
        reports.push(ClusterReport {
            labelled: labels.len(),
            pairs,
            pair_accuracy: right / pairs as f64,
            spearman: spearman(&labels, &strengths),
        });
    }
    Ok(Report {
        faces: faces.len(),
        labelled: labels.len(),
        pairs,
        pair_accuracy: right / pairs as f64,
        spearman: spearman(&labels, &strengths),
        pairs_within_clusters: within,
        pair_accuracy_within_clusters: within_right / within as f64,
        clusters: reports,
    })
}

/// Number of pairs with different labels, and how many of them the scores put in that order; a tie counts half.
///
/// Millions of pairs, so they are counted and not kept.
pub fn pair_accuracy(labels: &[f64], scores: &[f64]) -> (u64, f64) {
    let mut order: Vec<usize> = (0..labels.len().min(scores.len())).collect();
    order.sort_by(|a, b| labels[*a].total_cmp(&labels[*b]));
    // Faces sorted by label, level by level: all before are weaker.
    let (mut pairs, mut right) = (0, 0.0);
    let mut weaker: Vec<f64> = Vec::new();
    for level in order.chunk_by(|a, b| labels[*a] == labels[*b]) {
        for face in level {
            let below = weaker.partition_point(|score| *score < scores[*face]);
            let up_to = weaker.partition_point(|score| *score <= scores[*face]);
            pairs += weaker.len() as u64;
            right += below as f64 + 0.5 * (up_to - below) as f64;
        }
        weaker.extend(level.iter().map(|face| scores[*face]));
        weaker.sort_by(f64::total_cmp);
    }
    (pairs, right)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::learn::Pairs;

    #[test]
    fn counted_pairs_are_those_that_a_list_holds() {
        let labels: Vec<f64> = (0..40).map(|i| f64::from(i * 7 % 5)).collect();
        let scores: Vec<f64> = (0..40).map(|i| f64::from(i * 11 % 13)).collect();
        let levels: Vec<Option<f64>> = labels.iter().copied().map(Some).collect();
        let list = Pairs::of_levels(&levels, &[0; 40], 0.0).ordered;
        let (pairs, right) = pair_accuracy(&labels, &scores);
        assert_eq!(pairs, list.len() as u64);
        assert!((right / pairs as f64 - crate::learn::pair_accuracy(&scores, &list)).abs() < 1e-12);
    }

    #[test]
    fn equal_labels_make_no_pair() {
        assert_eq!(pair_accuracy(&[1.0, 1.0], &[0.0, 2.0]), (0, 0.0));
    }
}
