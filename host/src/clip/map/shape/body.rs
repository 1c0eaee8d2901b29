//! Which pair of limbs is the legs, which the arms, and where the head is.

use nalgebra::Vector3;

use super::limbs::{Kind, Pair, off, off_ratio, pairs};
use super::seen::Seen;

/// A body as it was found.
#[derive(Clone, Debug)]
pub(super) struct Body {
    pub legs: Pair,
    pub arms: Pair,
    /// The first joint of neck and head, beyond the joint on which the arms hang.
    pub neck: Option<usize>,
    /// Where legs and trunk meet.
    pub pelvis: usize,
    /// How unlike a person's it is.
    pub cost: f64,
    /// The same for the next best choice of limbs.
    pub next: f64,
}

/// What is worse is no body, and a choice that the next one comes so near to is none.
const WORST: f64 = 60.0;

/// The legs, arms and head that are most like a person's; or why there are none.
pub(super) fn body(seen: &Seen) -> Result<Body, String> {
    let (legs, arms) = (pairs(seen, Kind::Leg), pairs(seen, Kind::Arm));
    let mut found: Vec<Body> = Vec::new();
    for leg in &legs {
        for arm in arms.iter().filter(|arm| apart(seen, leg, arm)) {
            found.extend(joined(seen, leg, arm));
        }
    }
    found.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    let count = |pairs: &[Pair]| match pairs.len() {
        0 => "no mirrored pair of chains".to_owned(),
        1 => "1 mirrored pair of chains".to_owned(),
        n => format!("{n} mirrored pairs of chains"),
    };
    let mut all = found.into_iter();
    let best = all.next().ok_or_else(|| {
        let joined = if legs.is_empty() || arms.is_empty() { "" } else { ", none of which go together" };
        format!("found {} that could be legs and {} that could be arms{joined}", count(&legs), count(&arms))
    })?;
    let same = |body: &Body| body.legs.children == best.legs.children && body.arms.children == best.arms.children;
    let next = all.find(|body| !same(body)).map_or(f64::INFINITY, |body| body.cost);
    if best.cost > WORST {
        return Err(format!(
            "the chains most like legs and arms are still {:.1} times as unlike a person's as is taken",
            best.cost / WORST
        ));
    }
    four_legs(seen, &best)?;
    Ok(Body { next, ..best })
}

/// Whether no limb hangs on another.
fn apart(seen: &Seen, legs: &Pair, arms: &Pair) -> bool {
    let free = |a: &Pair, b: &Pair| a.children.iter().all(|&child| !seen.hangs_on(b.on, child));
    free(legs, arms) && free(arms, legs) && legs.children.iter().all(|child| !arms.children.contains(child))
}

fn middle(p: &[Vector3<f64>], pair: &Pair, joint: usize) -> Vector3<f64> {
    (p[pair.limbs[0].joints[joint]] + p[pair.limbs[1].joints[joint]]) / 2.0
}

fn cosine(a: Vector3<f64>, b: Vector3<f64>) -> Option<f64> {
    Some(a.try_normalize(1e-9)?.dot(&b.try_normalize(1e-9)?))
}

/// Legs and arms as one body.
fn joined(seen: &Seen, legs: &Pair, arms: &Pair) -> Option<Body> {
    let pelvis = seen.meet(legs.on, arms.on)?;
    let leg: f64 = legs.limbs.iter().flat_map(|limb| limb.bones).sum::<f64>() / 2.0;
    let arm: f64 = arms.limbs.iter().flat_map(|limb| limb.bones).sum::<f64>() / 2.0;
    let path = |from: usize| seen.above(from).take_while(|&j| j != pelvis).map(|j| seen.bone(j)).sum::<f64>();
    let trunk = |p: &[Vector3<f64>]| middle(p, arms, 0) - middle(p, legs, 0);
    // Legs point away from the trunk; arms hang, and are lifted at times.
    let down = seen.mean(|p| cosine(middle(p, legs, 2) - middle(p, legs, 0), trunk(p)))?;
    let hang = seen.mean(|p| cosine(middle(p, arms, 2) - middle(p, arms, 0), trunk(p))).unwrap_or(0.0);
    let mut cost = legs.cost + arms.cost + off_ratio(arm / leg, 0.6, 0.15);
    cost += off(path(arms.on) / leg, 0.4, 0.25) + off(path(legs.on) / leg, 0.0, 0.2);
    cost += off(down, -1.0, 0.5) + off(hang, -0.4, 0.6);
    let children = seen.children[arms.on].iter().copied();
    let free = children.filter(|&c| !arms.children.contains(&c) && !seen.hangs_on(legs.on, c));
    let necks = free.filter(|c| legs.on != arms.on || !legs.children.contains(c)).filter_map(|child| {
        let length = seen.bone(child) + seen.reach[child];
        let along = seen.mean(|p| cosine(furthest(seen, p, child) - p[arms.on], trunk(p)))?;
        let cost = off_ratio(length / leg, 0.3, 0.6) + off(along, 1.0, 0.5);
        (cost < 8.0).then_some((cost, child))
    });
    let neck = necks.min_by(|a, b| a.0.total_cmp(&b.0));
    cost += neck.map_or(8.0, |(cost, _)| cost);
    Some(Body { legs: *legs, arms: *arms, neck: neck.map(|n| n.1), pelvis, cost, next: f64::INFINITY })
}

/// The outermost joint of a chain.
fn furthest(seen: &Seen, p: &[Vector3<f64>], from: usize) -> Vector3<f64> {
    let longest = |&at: &usize| {
        let far = |c: &usize| seen.bone(*c) + seen.reach[*c];
        seen.children[at].iter().copied().max_by(|a, b| far(a).total_cmp(&far(b)))
    };
    std::iter::successors(Some(from), longest).last().map_or(p[from], |at| p[at])
}

/// Refuses what walks on all four.
fn four_legs(seen: &Seen, body: &Body) -> Result<(), String> {
    let (legs, arms) = (&body.legs, &body.arms);
    let length = |pair: &Pair| pair.limbs.iter().flat_map(|limb| limb.bones).sum::<f64>();
    let ratio = length(arms) / length(legs);
    let down = |p: &[Vector3<f64>], pair: &Pair| middle(p, pair, 2) - middle(p, pair, 0);
    // A person bends down too, but does not stay there.
    let on_four = seen.mean(|p| {
        let trunk = middle(p, arms, 0) - middle(p, legs, 0);
        let across = cosine(down(p, legs), trunk)? > -0.5 && cosine(down(p, legs), down(p, arms))? > 0.7;
        Some(f64::from(u8::from(across)))
    });
    if on_four.is_some_and(|share| share > 0.9) && ratio > 0.7 {
        return Err(format!(
            "found four legs: the front ones have {:.0} % of the length of the hind ones and point the same way, across the trunk",
            100.0 * ratio
        ));
    }
    Ok(())
}
