//! Which side is the left one: what bends, points and travels forward, and names that have a side.

use nalgebra::Vector3;

use super::limbs::Pair;
use super::seen::Seen;
use crate::clip::map::parts;

/// What one kind of evidence says about sides.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Witness {
    /// `toes`, `knees`, `elbows`, `travel` or `names`.
    pub what: &'static str,
    /// Mean over the frames (of names: joints) of which it says anything: 1 for the sides as suggested, -1 against them.
    pub agreement: f64,
    /// Share of the frames (of names: joints) of which it says anything.
    pub spoke: f64,
    #[serde(skip)]
    weight: f64,
}

/// Left and right, and how sure.
///
/// Names outvote what points and bends: where the two are against each other, the axes are left-handed or the names are wrong.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Sides {
    /// How sure it is.
    pub sure: Sure,
    /// What was asked.
    pub witnesses: Vec<Witness>,
}

impl Sides {
    /// Whether the names decided, and then whether toes or knees are against them.
    pub fn by_names(&self) -> Option<bool> {
        let says = |what: &str| self.witnesses.iter().find(|w| w.what == what);
        let names = says("names").is_some_and(|w| w.spoke > 0.5 && w.agreement > 0.5);
        let against = |what: &str| says(what).is_some_and(|w| w.spoke > 0.2 && w.agreement < -0.3);
        names.then(|| against("toes") || against("knees"))
    }
}

/// How sure a suggestion is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Sure {
    /// Nothing decides.
    Open,
    /// Something speaks for it.
    Likely,
    /// All that speaks agrees, and clearly.
    Certain,
}

/// Whether the first limbs of the pairs are the right ones, and how sure that is. `toes` are the joints beyond the ankles.
pub(super) fn sides(seen: &Seen, legs: &Pair, arms: &Pair, toes: [Option<usize>; 2]) -> (bool, Sides) {
    let way = |p: &[Vector3<f64>], pair: &Pair| p[pair.limbs[0].joints[0]] - p[pair.limbs[1].joints[0]];
    let both = |frame: usize, of: &dyn Fn(usize) -> Option<Vector3<f64>>, pair: &Pair| {
        let turns: Vec<Vector3<f64>> = (0..2).filter_map(of).collect();
        // Below a sixth of a right angle a joint says nothing.
        let sum: Vector3<f64> = turns.into_iter().filter(|t| t.norm() > 0.15).sum();
        let (sum, way) = (sum.try_normalize(0.1)?, way(&seen.frames[frame], pair).try_normalize(1e-9)?);
        Some(sum.dot(&way))
    };
    let unit = |v: Vector3<f64>| v.try_normalize(1e-9);
    let hinge = |frame: usize, pair: &Pair, side: usize| {
        let p = &seen.frames[frame];
        let [a, b, c] = pair.limbs[side].joints;
        Some(unit(p[b] - p[a])?.cross(&unit(p[c] - p[b])?))
    };
    let foot = |frame: usize, side: usize| {
        let p = &seen.frames[frame];
        let [_, knee, ankle] = legs.limbs[side].joints;
        let tip = toes[side].map_or(seen.tips[frame][ankle], |toe| p[toe]);
        Some(unit(p[knee] - p[ankle])?.cross(&unit(tip - p[ankle])?))
    };
    let travel = |frame: usize| {
        let (p, next) = (&seen.frames[frame], seen.frames.get(frame + 1)?);
        let up = unit(p[arms.on] - p[legs.on])?;
        let moved = next[legs.on] - p[legs.on];
        let flat = moved - up * moved.dot(&up);
        // A slow walk, in lengths of the leg.
        let speed = flat.norm() / seen.step.max(1e-9) / (legs.limbs[0].bones.iter().sum::<f64>());
        (speed > 0.5).then(|| up.cross(&flat.normalize()))
    };
    let ask = |what, weight, of: &dyn Fn(usize) -> Option<f64>| {
        let said: Vec<f64> = (0..seen.frames.len()).filter_map(of).collect();
        let agreement = said.iter().sum::<f64>() / said.len().max(1) as f64;
        Witness { what, agreement, spoke: said.len() as f64 / seen.frames.len().max(1) as f64, weight }
    };
    let mut witnesses = vec![
        ask("toes", 3.0, &|f| both(f, &|side| foot(f, side), legs)),
        ask("knees", 2.0, &|f| both(f, &|side| hinge(f, legs, side), legs)),
        ask("elbows", 1.0, &|f| both(f, &|side| hinge(f, arms, side).map(|t| -t), arms)),
        ask("travel", 1.0, &|f| Some(travel(f)?.dot(&unit(way(&seen.frames[f], legs))?))),
    ];
    witnesses.push(names(seen, [legs, arms]));
    let sum: f64 = witnesses.iter().map(|w| w.weight * w.agreement * w.spoke.sqrt()).sum();
    let first_is_right = sum < 0.0;
    if first_is_right {
        witnesses.iter_mut().for_each(|w| w.agreement = -w.agreement);
    }
    // Toes and knees are the better half.
    let both = witnesses.iter().take(2).all(|w| w.spoke > 0.2 && w.agreement > 0.3);
    let sure = match sum.abs() {
        x if x > 1.5 && both => Sure::Certain,
        x if x > 0.3 => Sure::Likely,
        _ => Sure::Open,
    };
    (first_is_right, Sides { sure, witnesses })
}

/// What the limbs' names say, where they say left and right at all.
fn names(seen: &Seen, pairs: [&Pair; 2]) -> Witness {
    let side = |joint: usize| match seen.clip.skeleton.joints[joint].name.as_str() {
        name if name.contains('\u{5de6}') => -1.0,
        name if name.contains('\u{53f3}') => 1.0,
        name => f64::from(parts::side(name)),
    };
    let limbs = pairs.into_iter().flat_map(|pair| pair.limbs.into_iter().zip([-1.0, 1.0]));
    let said: Vec<f64> = limbs.flat_map(|(limb, is)| limb.joints.map(|joint| is * side(joint))).collect();
    let spoke = said.iter().filter(|s| **s != 0.0).count();
    let agreement = said.iter().sum::<f64>() / spoke.max(1) as f64;
    Witness { what: "names", agreement, spoke: spoke as f64 / said.len().max(1) as f64, weight: 8.0 }
}
