//! Which strengths are plausible, found by playing them.
//!
//! Training clips show what a body or a robot does; what is played may do a little more of it. Each strength is played through the device's
//! code and looked at as an animator would: joints that turn farther than they do, a body that falls over its feet, feet that never stand,
//! jerks, and joints that fly.
//!
//! | file | holds |
//! |---|---|
//! | `figures` | [`Figures`]: speed, jerk, ranges of joints, balance and standing of some motions |

mod figures;

use std::fmt;

pub use figures::{Figures, Stand};

use crate::clip::Clip;
use crate::rig::Rig;

/// From strength to strength.
const STEP: f64 = 0.25;
/// The fastest joint may be so many times faster than the fastest of the training clips.
const SPEED: f64 = 1.5;
/// The jerk may be so many times that of the rougher side of the training clips.
const JERK: f64 = 1.5;
/// What a recorded walk of a person jerks, m/s^3: less is smooth, however even the training clips are.
const SMOOTH: f64 = 100.0;
/// The centre of mass may be so much farther from the foot that stands, as a share of the leg's length.
const REACH: f64 = 0.15;
/// A foot may stand for so small a share of the time for which it stands on the side of the training clips where it stands less.
const STANDS: f64 = 0.5;

/// What a played motion does that no training clip does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Broken {
    /// A joint is faster.
    Speed,
    /// The motion is rougher.
    Jerk,
    /// A joint turns or slides farther.
    Joints,
    /// The centre of mass is farther from the foot that stands.
    Balance,
    /// Feet hardly stand.
    Feet,
}

impl fmt::Display for Broken {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(match self {
            Self::Speed => "a joint is faster than any of the training clips",
            Self::Jerk => "the motion jerks more than the training clips",
            Self::Joints => "a joint leaves the range that it has in the training clips",
            Self::Balance => "the body leans out farther from its feet than in the training clips",
            Self::Feet => "feet hardly stand any more",
        })
    }
}

/// What is plausible, and what ends it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Plausible {
    /// The largest strength that is.
    pub largest: f64,
    /// What breaks at the next one; nothing up to the largest that was tried.
    pub broken: Option<Broken>,
}

impl Plausible {
    /// From 0 to the largest.
    pub fn range(&self) -> [f64; 2] {
        [0.0, self.largest]
    }

    /// What ends the range, as a sentence.
    pub fn why(&self) -> Option<String> {
        self.broken.map(|broken| format!("at strength {} {broken}", self.largest + STEP))
    }
}

/// What training clips do, as a bound for what is played.
#[derive(Clone, Debug)]
pub struct Bounds {
    seen: Figures,
}

impl Bounds {
    /// The larger of what the sources do and what the targets do.
    pub fn new<'a>(
        rig: &Rig,
        sources: impl Iterator<Item = &'a Clip>,
        targets: impl Iterator<Item = &'a Clip>,
    ) -> Self {
        Self { seen: Figures::of(rig, sources).or(Figures::of(rig, targets)) }
    }

    /// What motions do that the training clips do not.
    pub fn broken(&self, rig: &Rig, played: &[Clip]) -> Option<Broken> {
        let found = Figures::of(rig, played.iter());
        self.rough(rig, &found).or_else(|| (self.seen.outside(rig, &found) > 1.0).then_some(Broken::Joints))
    }

    /// The same without the joints' rotations.
    fn rough(&self, rig: &Rig, found: &Figures) -> Option<Broken> {
        let seen = &self.seen;
        if found.speed_m_s > SPEED * seen.speed_m_s {
            return Some(Broken::Speed);
        }
        let smooth = if rig.frames().travels() { SMOOTH } else { 0.0 };
        if found.jerk_m_s3 > (JERK * seen.jerk_m_s3).max(smooth) {
            return Some(Broken::Jerk);
        }
        let (Some(stood), stands) = (seen.stand, found.stand) else { return None };
        let standing = stands.map_or(0.0, |stand| stand.standing_percent);
        if standing < STANDS * stood.standing_percent {
            return Some(Broken::Feet);
        }
        let leans = |stand: Stand| stand.reach_m > stood.reach_m + REACH * stood.leg_m;
        stands.is_some_and(leans).then_some(Broken::Balance)
    }

    /// Strengths from a quarter to `limit` are played in turn; the first that breaks a bound is the first that is not plausible.
    ///
    /// Between source and target a joint passes where neither of them is, so joints are looked at beyond strength 1, and may go farther than they
    /// do there.
    pub fn largest<E>(
        &self,
        rig: &Rig,
        limit: f64,
        mut play: impl FnMut(f64) -> Result<Vec<Clip>, E>,
    ) -> Result<Plausible, E> {
        let mut found = Plausible::default();
        let mut turned = self.seen.clone();
        while found.largest < limit && found.broken.is_none() {
            let strength = found.largest + STEP;
            let figures = Figures::of(rig, play(strength)?.iter());
            let outside = || (strength > 1.0 && turned.outside(rig, &figures) > 1.0).then_some(Broken::Joints);
            found.broken = self.rough(rig, &figures).or_else(outside);
            if strength <= 1.0 {
                turned = turned.or(figures);
            }
            if found.broken.is_none() {
                found.largest = strength;
            }
        }
        Ok(found)
    }
}

#[cfg(test)]
mod tests {
    use std::convert::Infallible;

    use nalgebra::UnitQuaternion;

    use super::*;
    use crate::gait::{Manner, walk};

    fn of(play: impl Fn(f64, Clip) -> Clip) -> Plausible {
        let plain = walk(&Manner::NEUTRAL, 3.0, 60.0, 0.0, 3);
        let map = crate::clip::JointMap::choose(&plain.skeleton, None).unwrap().unwrap();
        let rig = Rig::new(&plain.skeleton, &map).unwrap();
        let clips = || std::iter::once(&plain);
        let play = |strength: f64| Ok::<_, Infallible>(vec![play(strength, plain.clone())]);
        Bounds::new(&rig, clips(), clips()).largest(&rig, 3.0, play).unwrap_or_else(|never| match never {})
    }

    #[test]
    fn what_stays_as_it_is_stays_plausible() {
        assert_eq!(of(|_, clip| clip), Plausible { largest: 3.0, broken: None });
    }

    #[test]
    fn each_bound_ends_the_range_with_its_name() {
        let shaken = of(|strength, mut clip| {
            let shake = |(frame, root): (usize, &mut nalgebra::Vector3<f64>)| {
                root.y += 0.001 * strength * if frame % 2 == 0 { 1.0 } else { -1.0 };
            };
            clip.root.iter_mut().enumerate().for_each(shake);
            clip
        });
        assert_eq!(shaken.broken, Some(Broken::Jerk), "{shaken:?}");
        assert!(shaken.why().unwrap().contains("jerks more"), "{shaken:?}");
        let carried = of(|strength, mut clip| {
            clip.root.iter_mut().enumerate().for_each(|(frame, root)| root.z += 0.02 * strength * frame as f64);
            clip
        });
        assert_eq!(carried.broken, Some(Broken::Feet), "{carried:?}");
        // 25 degrees a unit: where strength 1 is, and 30 degrees more.
        let bent = of(|strength, mut clip| {
            let joints = clip.skeleton.len();
            let head = clip.skeleton.find("Head").unwrap();
            let bend = UnitQuaternion::from_axis_angle(&nalgebra::Vector3::x_axis(), 0.436 * strength);
            clip.rotations.iter_mut().skip(head).step_by(joints).for_each(|turn| *turn *= bend);
            clip
        });
        assert_eq!(bent.broken, Some(Broken::Joints), "{bent:?}");
        assert!((2.0..=2.25).contains(&bent.largest), "{bent:?}");
    }

    #[test]
    fn what_is_played_too_fast_jerks() {
        let plain = walk(&Manner::NEUTRAL, 3.0, 60.0, 0.0, 3);
        let map = crate::clip::JointMap::choose(&plain.skeleton, None).unwrap().unwrap();
        let rig = Rig::new(&plain.skeleton, &map).unwrap();
        let bounds = Bounds::new(&rig, std::iter::once(&plain), std::iter::empty());
        let faster = |by: f64| Clip { frame_time: plain.frame_time / by, ..plain.clone() };
        assert_eq!(bounds.broken(&rig, &[faster(1.1)]), None);
        assert_eq!(bounds.broken(&rig, &[faster(1.2)]), Some(Broken::Jerk));
    }
}
