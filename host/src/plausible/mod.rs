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
        let (seen, found) = (&self.seen, Figures::of(rig, played.iter()));
        if found.speed_m_s > SPEED * seen.speed_m_s {
            return Some(Broken::Speed);
        }
        if found.jerk_m_s3 > JERK * seen.jerk_m_s3 {
            return Some(Broken::Jerk);
        }
        if seen.outside(rig, &found) > 1.0 {
            return Some(Broken::Joints);
        }
        let (Some(stood), stands) = (seen.stand, found.stand) else { return None };
        let standing = stands.map_or(0.0, |stand| stand.standing_percent);
        if standing < STANDS * stood.standing_percent {
            return Some(Broken::Feet);
        }
        let leans = |stand: Stand| stand.reach_m > stood.reach_m + REACH * stood.leg_m;
        stands.is_some_and(leans).then_some(Broken::Balance)
    }

    /// How far from `middle` to `end` strengths may go: the first of all eighths from the end back to half of the way at which nothing breaks,
    /// and what breaks farther out. The half of the way is taken as it is.
    pub fn end<E>(
        &self,
        rig: &Rig,
        [middle, end]: [f64; 2],
        mut play: impl FnMut(f64) -> Result<Clip, E>,
    ) -> Result<(f64, Option<Broken>), E> {
        let at = |eighths: u8| middle + f64::from(eighths) / 8.0 * (end - middle);
        let mut outside = None;
        for eighths in [8, 7, 6, 5] {
            match self.broken(rig, &[play(at(eighths))?]) {
                None => return Ok((at(eighths), outside)),
                Some(broken) => outside = outside.or(Some(broken)),
            }
        }
        Ok((at(4), outside))
    }

    /// Strengths from a quarter to `limit` are played in turn; the first that breaks a bound is the first that is not plausible.
    pub fn largest<E>(
        &self,
        rig: &Rig,
        limit: f64,
        mut play: impl FnMut(f64) -> Result<Vec<Clip>, E>,
    ) -> Result<Plausible, E> {
        let mut found = Plausible::default();
        while found.largest < limit && found.broken.is_none() {
            found.broken = self.broken(rig, &play(found.largest + STEP)?);
            if found.broken.is_none() {
                found.largest += STEP;
            }
        }
        Ok(found)
    }
}
