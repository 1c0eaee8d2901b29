//! Where a clip comes back to what it did before: the pair of frames whose ways there are most alike.

use nalgebra::{UnitQuaternion, Vector3};

use crate::clip::Clip;

/// Frames that are compared with each other; of longer clips every other one, or fewer, and then all near the best.
const COMPARED: usize = 4000;

/// Poses as they look from where a person stands and to where the person faces, `[frames x width]`: m, or a machine's coordinates.
pub(super) struct Looks {
    width: usize,
    values: Vec<f64>,
}

impl Looks {
    pub fn of(clip: &Clip) -> Self {
        let width = match &clip.coordinates {
            Some(all) => all.len() / clip.frames().max(1),
            None => 3 * clip.skeleton.len(),
        };
        let values = match &clip.coordinates {
            Some(all) => all.clone(),
            None => (0..clip.frames()).flat_map(|frame| local(clip, frame)).collect(),
        };
        Self { width, values }
    }

    fn frames(&self) -> usize {
        self.values.len() / self.width.max(1)
    }

    /// Mean squared distance of two frames, over joints.
    fn apart(&self, a: usize, b: usize) -> f64 {
        let row = |frame: usize| self.values.get(frame * self.width..(frame + 1) * self.width).unwrap_or(&[]);
        let sum: f64 = row(a).iter().zip(row(b)).map(|(a, b)| (a - b) * (a - b)).sum();
        3.0 * sum / self.width.max(1) as f64
    }

    /// Mean squared distance of two ends with the frames before them.
    pub fn ways_apart(&self, a: usize, b: usize, before: usize) -> f64 {
        let sum: f64 = (0..=before).map(|k| self.apart(a.saturating_sub(k), b.saturating_sub(k))).sum();
        sum / (before + 1) as f64
    }

    fn every(&self, step: usize) -> Self {
        let rows = self.values.chunks_exact(self.width.max(1)).step_by(step);
        Self { width: self.width, values: rows.flatten().copied().collect() }
    }
}

/// Joints from above the root's place on the ground, turned to where the first frame faces.
fn local(clip: &Clip, frame: usize) -> Vec<f64> {
    let root = clip.root.get(frame).copied().unwrap_or_default();
    let back = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), -yaw(clip, frame));
    let place = Vector3::new(root.x, 0.0, root.z);
    clip.positions(frame).iter().flat_map(|p| <[f64; 3]>::from(back * (p - place))).collect()
}

/// How far the root has turned about the vertical since the first frame, rad.
pub(super) fn yaw(clip: &Clip, frame: usize) -> f64 {
    let joints = clip.skeleton.len();
    let turn = |frame: usize| clip.rotations.get(frame * joints).copied().unwrap_or_default();
    let since = turn(frame) * turn(0).inverse();
    2.0 * since.j.atan2(since.w)
}

/// The best pair of frames `lengths` apart with `before` frames before the first: first frame and distance. Lengths nearer to `asked` count more.
pub(super) fn find(
    looks: &Looks,
    before: usize,
    lengths: std::ops::RangeInclusive<usize>,
    asked: Option<f64>,
) -> Option<(usize, usize)> {
    let step = looks.frames().div_ceil(COMPARED).max(1);
    if step == 1 {
        return search(looks, before, lengths, asked);
    }
    let (least, most) = (*lengths.start(), *lengths.end());
    let coarse = looks.every(step);
    let few = before.div_ceil(step);
    let (start, length) =
        search(&coarse, few, least.div_ceil(step)..=most / step, asked.map(|asked| asked / step as f64))
            .or_else(|| search(looks, before, least..=least, None))?;
    let around = |at: usize| (at * step).saturating_sub(step)..=at * step + step;
    let pairs = around(start).flat_map(|start| around(length).map(move |length| (start, length)));
    let allowed =
        pairs.filter(|(start, length)| lengths.contains(length) && *start >= before && start + length < looks.frames());
    let cost = |(start, length): &(usize, usize)| {
        looks.ways_apart(*start, start + length, before) * unlike(*length as f64, asked)
    };
    allowed.min_by(|a, b| cost(a).total_cmp(&cost(b)))
}

/// Along every length a window slides over the clip, so that each pair of frames is compared once.
fn search(
    looks: &Looks,
    before: usize,
    lengths: std::ops::RangeInclusive<usize>,
    asked: Option<f64>,
) -> Option<(usize, usize)> {
    let frames = looks.frames();
    let mut best: Option<(f64, usize, usize)> = None;
    for length in lengths {
        let Some(count) = frames.checked_sub(length) else { break };
        let apart: Vec<f64> = (0..count).map(|frame| looks.apart(frame, frame + length)).collect();
        let penalty = unlike(length as f64, asked) / (before + 1) as f64;
        let mut sum: f64 = apart.iter().take(before).sum();
        for start in before..count {
            sum += apart[start];
            // What rounding leaves of a sum that should be 0.
            let cost = sum.max(0.0) * penalty;
            if best.is_none_or(|(least, ..)| cost < least) {
                best = Some((cost, start, length));
            }
            sum -= apart[start - before];
        }
    }
    best.map(|(_, start, length)| (start, length))
}

/// What a length counts for: half as much again at a quarter beside the asked one.
fn unlike(length: f64, asked: Option<f64>) -> f64 {
    asked.map_or(1.0, |asked| 1.0 + 2.0 * (length - asked).abs() / asked.max(1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gait::{Manner, walk};

    #[test]
    fn a_walk_comes_back_after_a_stride() {
        let clip = walk(&Manner::NEUTRAL, 6.0, 60.0, 0.0, 1);
        let looks = Looks::of(&clip);
        let stride = 60.0 / Manner::NEUTRAL.cadence;
        let (start, length) = find(&looks, 12, 50..=83, Some(65.0)).unwrap();
        // Steps of the made-up walk are not quite even.
        assert!((length as f64 - stride).abs() <= 4.0, "{length} {stride}");
        assert!(start >= 12 && start + length < clip.frames());
        // As near when only every fourth frame is looked at first.
        let dense = Looks { width: looks.width, values: looks.values.repeat(50) };
        let (_, found) = find(&dense, 12, 50..=83, Some(65.0)).unwrap();
        assert!((found as f64 - stride).abs() <= 4.0, "{found}");
        assert!(find(&looks, 12, 355..=358, None).is_none());
    }
}
