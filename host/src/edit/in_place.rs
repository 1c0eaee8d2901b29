//! A walk on the spot: the way along the ground is taken out.

use nalgebra::Vector3;

use super::EditError;
use super::smooth::Bell;
use crate::clip::Clip;

/// What stays of the root's motion along the ground.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sway {
    /// Nothing: the root is above one place.
    None,
    /// What is faster than the way itself: the sway of every step.
    Kept,
    /// The same of a cycle, whose way is an even one: it ends where it began.
    KeptInCycle,
}

/// What is slower than this, s, is a way and no sway.
const WAY: f64 = 2.0;

/// The clip above the place where it begins, and how far it went from there, m. Heights and turns stay.
pub fn stay(clip: &Clip, sway: Sway) -> Result<(Clip, f64), EditError> {
    if clip.coordinates.is_some() {
        return Err(EditError::Stands);
    }
    let mut out = clip.clone();
    let (Some(first), Some(last)) = (clip.root.first(), clip.root.last()) else { return Ok((out, 0.0)) };
    let end = clip.frames().saturating_sub(1).max(1) as f64;
    let way: Vec<Vector3<f64>> = match sway {
        Sway::None => clip.root.clone(),
        Sway::Kept => Bell::new(WAY, clip.frame_time).points(&clip.root),
        Sway::KeptInCycle => (0..clip.frames()).map(|frame| first.lerp(last, frame as f64 / end)).collect(),
    };
    for (root, way) in out.root.iter_mut().zip(&way) {
        root.x += first.x - way.x;
        root.z += first.z - way.z;
    }
    Ok((out, (last - first).xz().norm()))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::gait::{Manner, walk};

    /// A walk whose root sways 3 cm to either side once a second.
    fn swaying() -> Clip {
        let mut clip = walk(&Manner::NEUTRAL, 5.0, 60.0, 0.0, 1);
        let sway = |frame: usize| 0.03 * (TAU * frame as f64 / 60.0).sin();
        clip.root.iter_mut().enumerate().for_each(|(frame, p)| p.x = sway(frame));
        clip
    }

    #[test]
    fn the_way_goes_and_the_sway_stays_where_it_is_asked_for() {
        let clip = swaying();
        let (still, way) = stay(&clip, Sway::None).unwrap();
        assert!(way > 2.0 && still.root.iter().all(|p| (p - still.root[0]).xz().norm() < 1e-12));
        assert_eq!(still.root.iter().map(|p| p.y).sum::<f64>(), clip.root.iter().map(|p| p.y).sum::<f64>());
        let (swaying, _) = stay(&clip, Sway::Kept).unwrap();
        let middle = |of: &Clip| of.root[100..220].iter().map(|p| p.x).fold(0.0, f64::max);
        assert!((middle(&swaying) / middle(&clip) - 1.0).abs() < 0.1, "{}", middle(&swaying));
        let farthest = swaying.root.iter().map(|p| (p.z - swaying.root[0].z).abs()).fold(0.0, f64::max);
        // The made-up walk is less even than people, whose 2 to 4 cm stay.
        assert!(farthest < 0.3, "{farthest}");
        let (cycle, _) = stay(&clip, Sway::KeptInCycle).unwrap();
        assert!((cycle.root[299] - cycle.root[0]).xz().norm() < 1e-12);
        assert_eq!(cycle.rotations, clip.rotations);
    }
}
