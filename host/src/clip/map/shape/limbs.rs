//! Chains that could be a leg or an arm, and pairs of them that mirror each other.

use super::seen::{Chord, DEPTH, Seen};

/// What a chain is tried as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Leg,
    Arm,
}

/// A chain read as a limb.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Limb {
    /// Hip or shoulder, knee or elbow, ankle or wrist.
    pub joints: [usize; 3],
    /// Thigh or upper arm, shin or forearm.
    pub bones: [f64; 2],
    /// How unlike a person's it is; the lower the better.
    pub cost: f64,
}

/// Two limbs that hang on one joint.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pair {
    /// The joint on which both hang.
    pub on: usize,
    /// Its children that carry them.
    pub children: [usize; 2],
    pub limbs: [Limb; 2],
    pub cost: f64,
}

/// Readings of one chain that are kept, best first.
const READINGS: usize = 8;
/// Chains on one joint, and pairs of the whole skeleton, that are kept.
const CHAINS: usize = 12;
/// A reading that is no better is none.
const WORST: f64 = 16.0;

/// Half the square of how many standard deviations a value is off; no single one decides alone.
pub(super) fn off(value: f64, expected: f64, deviation: f64) -> f64 {
    (0.5 * ((value - expected) / deviation).powi(2)).min(10.0)
}

/// As [`off`] for a ratio of lengths, one half as far off as its double.
pub(super) fn off_ratio(value: f64, expected: f64, deviation: f64) -> f64 {
    off(value.max(1e-6).ln(), expected.ln(), deviation)
}

/// A bone is straight, whatever joints lie along it.
fn bent(chord: Chord) -> f64 {
    let path = chord.path.max(1e-9);
    off(chord.mean / path, 1.0, 0.03) + off(chord.spread / path, 0.0, 0.02)
}

/// All pairs of limbs of a kind, best first.
pub(super) fn pairs(seen: &Seen, kind: Kind) -> Vec<Pair> {
    let mut found = Vec::new();
    for on in 0..seen.children.len() {
        if seen.children[on].len() < 2 {
            continue;
        }
        let mut chains: Vec<(usize, Vec<Limb>)> = seen.children[on]
            .iter()
            .map(|&child| (child, readings(seen, kind, child)))
            .filter(|(_, limbs)| !limbs.is_empty())
            .collect();
        chains.sort_by(|a, b| a.1[0].cost.total_cmp(&b.1[0].cost));
        chains.truncate(CHAINS);
        for (at, (a, left)) in chains.iter().enumerate() {
            for (b, right) in &chains[at + 1..] {
                found.extend(best(seen, on, [*a, *b], left, right));
            }
        }
    }
    found.sort_by(|a: &Pair, b| a.cost.total_cmp(&b.cost));
    found.truncate(CHAINS);
    found
}

/// The two readings that go together best.
fn best(seen: &Seen, on: usize, children: [usize; 2], left: &[Limb], right: &[Limb]) -> Option<Pair> {
    let depth = |joint| seen.above(joint).take_while(|&j| j != on).count() as f64;
    // Two chains in one place are one limb and its helper.
    let apart = |a: &Limb, b: &Limb| {
        let way = seen.mean(|p| Some((p[a.joints[0]] - p[b.joints[0]]).norm()));
        way.is_some_and(|way| way > 0.1 * a.bones[0])
    };
    let both = left.iter().flat_map(|a| right.iter().map(move |b| (*a, *b))).filter(|(a, b)| apart(a, b));
    let pairs = both.map(|(a, b)| {
        let lengths: f64 = a.bones.iter().zip(b.bones).map(|(x, y)| off_ratio(x / y, 1.0, 0.1)).sum();
        let depths: f64 = a.joints.iter().zip(b.joints).map(|(x, y)| off(depth(*x) - depth(y), 0.0, 0.5)).sum();
        Pair { on, children, limbs: [a, b], cost: a.cost + b.cost + lengths + depths }
    });
    pairs.min_by(|a, b| a.cost.total_cmp(&b.cost)).filter(|pair| pair.cost < 2.0 * WORST)
}

/// How the chains that a joint begins can be read, best first.
fn readings(seen: &Seen, kind: Kind, child: usize) -> Vec<Limb> {
    let mut found: Vec<Limb> = Vec::new();
    let mut below = vec![(child, 1)];
    while let Some((end, depth)) = below.pop() {
        if depth < DEPTH {
            below.extend(seen.children[end].iter().map(|&c| (c, depth + 1)));
        }
        let chain: Vec<usize> = seen.above(end).take(depth).collect();
        for (middle, &bend) in chain.iter().enumerate().skip(1) {
            for (start, &first) in chain.iter().enumerate().skip(middle + 1) {
                let steps = [start - middle, middle, depth - start];
                found.extend(limb(seen, kind, [first, bend, end], steps));
            }
        }
        // Deep trees have many readings; only the best are of use.
        if found.len() > 64 * READINGS {
            keep(&mut found);
        }
    }
    keep(&mut found);
    found
}

fn keep(found: &mut Vec<Limb>) {
    found.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    found.truncate(READINGS);
}

/// A chain of three joints as a limb, with the steps from knee to hip, from ankle to knee, from hip to the trunk.
fn limb(seen: &Seen, kind: Kind, joints: [usize; 3], steps: [usize; 3]) -> Option<Limb> {
    let [first, bend, end] = joints;
    let (upper, lower) = (seen.chord(bend, steps[0])?, seen.chord(end, steps[1])?);
    let across = seen.chord(end, steps[0] + steps[1])?;
    let from = seen.chord(first, steps[2]).map_or(0.0, |c| c.path);
    let (length, beyond) = (upper.mean + lower.mean, seen.reach[end] / lower.mean.max(1e-9));
    if upper.mean < 0.02 * seen.whole || lower.mean < 0.02 * seen.whole {
        return None;
    }
    // Expected ratios are those of people, with the spread that skeletons in files have.
    let shape = match kind {
        Kind::Leg => {
            off_ratio(lower.mean / upper.mean, 1.0, 0.15)
                + off_ratio(length / seen.whole, 0.385, 0.25)
                + off(from / upper.mean, 0.25, 0.3)
                + if beyond > 0.02 { off_ratio(beyond, 0.4, 0.5) } else { 6.0 }
        }
        Kind::Arm => {
            off_ratio(lower.mean / upper.mean, 0.85, 0.3)
                + off_ratio(length / seen.whole, 0.225, 0.3)
                + off(from / upper.mean, 0.8, 0.6)
                + if beyond > 0.02 { off_ratio(beyond, 0.5, 0.8) } else { 0.5 }
        }
    };
    // Knees and elbows bend; no fingers branch off before a wrist; of joints in one place the hip is the lowest, the others the highest.
    let bends = 1.5 * (1.0 - (across.spread / length / 0.02).min(1.0));
    let branches = seen.above(end).skip(1).take_while(|&j| j != bend).filter(|&j| seen.children[j].len() > 1).count();
    let fingers = if kind == Kind::Arm { 3.0 * branches as f64 } else { 0.0 };
    let doubled = [bend, end].into_iter().filter(|&j| seen.is_doubled(j)).count() as f64
        + f64::from(u8::from(seen.children[first].iter().any(|&c| seen.hangs_on(bend, c) && seen.is_doubled(c))));
    let cost = shape + bent(upper) + bent(lower) + bends + fingers + doubled;
    (cost < WORST).then_some(Limb { joints, bones: [upper.mean, lower.mean], cost })
}
