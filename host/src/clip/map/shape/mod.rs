//! Which joint is which where names say nothing: by hierarchy, lengths of bones and motion.
//!
//! | file | finds |
//! |---|---|
//! | `seen` | the clip as points over time |
//! | `limbs` | chains that could be a leg or an arm, in pairs that mirror each other |
//! | `body` | which pair is the legs and which the arms, and the head |
//! | `trunk` | spine, chest, neck, head, collars, toes |
//! | `sides` | left and right |
//! | `text` | the map file |
//!
//! Nothing takes such a map by itself: somebody reads it first.

mod body;
mod limbs;
mod seen;
mod sides;
#[cfg(test)]
mod tests;
mod text;
mod trunk;

pub use sides::{Sides, Sure, Witness};

use nalgebra::Vector3;

use self::seen::Seen;
use super::{CANONICAL, Canonical, JointMap, MapError, SkeletonMap};
use crate::clip::Clip;

/// A suggested map, and how sure it is.
#[derive(Clone, Debug)]
pub struct Suggestion {
    /// The joints.
    pub map: JointMap,
    /// Whether legs, arms and head are those: how much better this choice is than the next.
    pub limbs: Sure,
    /// Left and right.
    pub sides: Sides,
    /// Direction from the ankles to the head over the motion, in the clip's axes.
    pub up: [f64; 3],
    /// Lengths of thigh, shin, upper arm and forearm, mean of both sides, in the clip's unit.
    pub bones: [f64; 4],
    /// How far the two sides are apart in these lengths, at most.
    pub uneven: f64,
    /// The map file.
    pub toml: String,
}

/// A choice that is better than the next by so much is certain, by so much likely.
const CERTAIN: f64 = 8.0;
const LIKELY: f64 = 2.0;

/// Suggests which joint is which. The map must be looked at before it is used, see [`Suggestion::toml`].
///
/// Refused where there are no two legs, two arms and a trunk between them.
pub fn suggest(clip: &Clip) -> Result<Suggestion, MapError> {
    let refuse = |found: String| MapError::NoBody { found };
    if clip.frames() == 0 {
        return Err(refuse("found no frame".into()));
    }
    let seen = Seen::new(clip);
    let mut body = body::body(&seen).map_err(refuse)?;
    // The first arm on the side of the first leg.
    let across = |p: &[Vector3<f64>]| {
        let way = |pair: &limbs::Pair| p[pair.limbs[0].joints[0]] - p[pair.limbs[1].joints[0]];
        Some(way(&body.legs).dot(&way(&body.arms)))
    };
    if seen.mean(across).is_some_and(|same| same < 0.0) {
        body.arms.limbs.swap(0, 1);
        body.arms.children.swap(0, 1);
    }
    let toes = [0, 1].map(|side| trunk::toe(&seen, &body.legs.limbs[side]));
    let (first_is_right, sides) = sides::sides(&seen, &body.legs, &body.arms, toes);
    let joints = trunk::joints(&seen, &body, usize::from(first_is_right));
    let map = JointMap::from_indices("suggested", joints, &clip.skeleton);
    let limbs = match body.next - body.cost {
        margin if margin >= CERTAIN => Sure::Certain,
        margin if margin >= LIKELY => Sure::Likely,
        _ => Sure::Open,
    };
    let [legs, arms] = [&body.legs, &body.arms].map(|pair| pair.limbs.map(|limb| limb.bones));
    let pairs = [0, 1].map(|b| [legs[0][b], legs[1][b]]).into_iter().chain([0, 1].map(|b| [arms[0][b], arms[1][b]]));
    let pairs: Vec<[f64; 2]> = pairs.collect();
    let mut suggestion = Suggestion {
        map,
        limbs,
        sides,
        up: up(&seen, &joints),
        bones: std::array::from_fn(|b| pairs[b].iter().sum::<f64>() / 2.0),
        uneven: pairs.iter().map(|[a, b]| (a / b).max(b / a) - 1.0).fold(0.0, f64::max),
        toml: String::new(),
    };
    suggestion.toml = text::toml(&seen, &suggestion);
    // Names decide in a map file: two joints of one name would be one.
    let read = SkeletonMap::parse(&suggestion.toml).and_then(|map| map.resolve(&clip.skeleton));
    let same = |map: &JointMap| Canonical::ALL.into_iter().all(|c| map.joint(c) == suggestion.map.joint(c));
    match read {
        Ok(map) if same(&map) => Ok(suggestion),
        _ => {
            Err(refuse("found joints that share a name, which a map cannot tell apart; rename them in the file".into()))
        }
    }
}

/// Mean direction from the ankles to the head, or to the chest.
fn up(seen: &Seen, joints: &[Option<usize>; CANONICAL]) -> [f64; 3] {
    let at = |c: Canonical| joints[c as usize];
    let top = at(Canonical::Head).or(at(Canonical::Chest));
    let (Some(top), Some(left), Some(right)) = (top, at(Canonical::LAnkle), at(Canonical::RAnkle)) else {
        return [0.0; 3];
    };
    let all = seen.frames.iter().filter_map(|p| (p[top] - (p[left] + p[right]) / 2.0).try_normalize(1e-9));
    let (sum, count) = all.fold((Vector3::zeros(), 0), |s: (Vector3<f64>, usize), u| (s.0 + u, s.1 + 1));
    (sum / count.max(1) as f64).into()
}
