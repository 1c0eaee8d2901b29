//! Between the limbs: spine, chest, neck, head, and the ends of the limbs.

use nalgebra::Vector3;

use super::body::Body;
use super::limbs::Limb;
use super::seen::Seen;
use crate::clip::map::CANONICAL;
use crate::clip::map::Canonical::{self, *};

/// A branch of less than this share of the longest one is a helper.
const HELPER: f64 = 0.3;

/// The head points up at least so much (cosine with the trunk), and so much what would lie beyond it: people stoop, and hair falls.
const RISES: [f64; 2] = [0.2, 0.6];

/// All canonical joints of a body, with the limbs that `left` says first on the left side.
pub(super) fn joints(seen: &Seen, body: &Body, left: usize) -> [Option<usize>; CANONICAL] {
    let mut found = [None; CANONICAL];
    let mut set = |canonical: Canonical, joint: Option<usize>| found[canonical as usize] = joint;
    set(Pelvis, Some(body.pelvis));
    // Joints that lie on the pelvis are no spine.
    let mut spine: Vec<usize> = seen.above(body.arms.on).take_while(|&j| j != body.pelvis).collect();
    spine.reverse();
    let chest = (body.arms.on != body.pelvis).then_some(body.arms.on);
    set(Chest, chest);
    set(Spine, spine.iter().copied().find(|&j| !seen.is_doubled(j) && Some(j) != chest));
    let (neck, head) = head(seen, body);
    // A head that turns on the chest's joint has its neck there.
    set(Neck, neck.or(chest.filter(|_| head.is_some())));
    set(Head, head);
    let sides = [
        (left, [LHip, LKnee, LAnkle, LToe], [LCollar, LShoulder, LElbow, LWrist]),
        (1 - left, [RHip, RKnee, RAnkle, RToe], [RCollar, RShoulder, RElbow, RWrist]),
    ];
    for (side, [hip, knee, ankle, toe], [collar, shoulder, elbow, wrist]) in sides {
        let (leg, arm) = (&body.legs.limbs[side], &body.arms.limbs[side]);
        for (canonical, joint) in [hip, knee, ankle].into_iter().zip(leg.joints) {
            set(canonical, Some(joint));
        }
        set(toe, self::toe(seen, leg));
        set(collar, self::collar(seen, arm, body.arms.on));
        for (canonical, joint) in [shoulder, elbow, wrist].into_iter().zip(arm.joints) {
            set(canonical, Some(joint));
        }
    }
    found
}

/// The next joint outwards, of the branch that reaches furthest.
fn outwards(seen: &Seen, joint: usize) -> Option<usize> {
    let far = |&c: &usize| seen.bone(c) + seen.reach[c];
    seen.children[joint].iter().copied().max_by(|a, b| far(a).total_cmp(&far(b)))
}

/// The first joint of a foot that lies beyond the ankle.
pub(super) fn toe(seen: &Seen, leg: &Limb) -> Option<usize> {
    std::iter::successors(outwards(seen, leg.joints[2]), |&j| outwards(seen, j)).find(|&j| !seen.is_doubled(j))
}

/// The joint before the shoulder, unless the arms hang on it.
fn collar(seen: &Seen, arm: &Limb, on: usize) -> Option<usize> {
    let shoulder = arm.joints[0];
    let mut below = shoulder;
    let mut inwards = seen.above(shoulder).skip(1).take_while(|&j| j != on);
    inwards.find(|&j| {
        let apart = !seen.is_doubled(below);
        below = j;
        apart
    })
}

/// Joints of a chain that are not in one place.
fn bones(seen: &Seen, chain: &[usize]) -> usize {
    chain.iter().filter(|&&j| !seen.is_doubled(j)).count()
}

/// Whether the bone to a joint goes on where the trunk points, beyond a chain.
fn rises(seen: &Seen, body: &Body, joint: usize, chain: &[usize]) -> bool {
    let Some(parent) = seen.above(joint).nth(1) else { return false };
    let along = |p: &[Vector3<f64>]| {
        let bone = (p[joint] - p[parent]).try_normalize(1e-9)?;
        Some(bone.dot(&(p[body.arms.on] - p[body.pelvis]).try_normalize(1e-9)?))
    };
    seen.is_doubled(joint) || seen.mean(along).is_none_or(|cosine| cosine > RISES[usize::from(bones(seen, chain) > 1)])
}

/// Neck and head: the chain up to where a face begins or hair falls, without its tip.
fn head(seen: &Seen, body: &Body) -> (Option<usize>, Option<usize>) {
    let mut chain: Vec<usize> = Vec::new();
    let mut at = body.neck;
    while let Some(joint) = at {
        chain.push(joint);
        let far = |c: usize| seen.bone(c) + seen.reach[c];
        let longest = outwards(seen, joint);
        let enough = longest.map_or(0.0, |c| HELPER * far(c));
        let branches = seen.children[joint].iter().filter(|&&c| far(c) > enough).count();
        at = longest.filter(|&next| branches == 1 && rises(seen, body, next, &chain));
    }
    // A leaf that never turns and ends a long bone is the top of the head.
    let tip = |chain: &[usize]| match *chain {
        [.., before, last] => {
            seen.children[last].is_empty() && !seen.turns(last) && seen.bone(last) > 1.3 * seen.bone(before)
        }
        _ => false,
    };
    if bones(seen, &chain) > 1 && tip(&chain) {
        chain.pop();
    }
    let head = chain.last().copied();
    let neck = chain.iter().copied().find(|&j| !seen.is_doubled(j) && Some(j) != head);
    (neck, head)
}
