//! Choosing the clip's root: below resting scene roots, the joint that travels.

use super::assemble::{Draft, STILL, Track};
use crate::clip::map::{Canonical, JointMap};

/// A rotation that turns by less is at rest, rad.
const STILL_ANGLE: f64 = 1e-3;

impl Draft {
    /// How deep the joint is that carries the body of unknown names: what few joints there are beside it are left out. The root where
    /// something above it moves too.
    fn carried(&mut self) -> usize {
        let moves = |t: &Option<Track>| t.as_ref().is_some_and(|t| t.spread > STILL);
        let n = self.joints.len();
        let most = |j: &usize| {
            let (below, chain) = self.around(*j);
            let whole = 4 * below.iter().filter(|b| **b).count() >= 3 * (n - (chain.len() - 1));
            // What is longer than a target with its pole is a limb.
            let near = |j: usize| self.joints[j].parent.is_none_or(|p| chain.contains(&p));
            whole && (0..n).filter(|&j| !below[j]).all(|j| near(j) || self.joints[j].parent.is_some_and(near))
        };
        let Some(carrier) = (0..n).filter(|&j| moves(&self.tracks[j])).find(most) else { return 0 };
        let (below, chain) = self.around(carrier);
        if !chain[1..].iter().all(|&j| self.is_still(j)) {
            return 0;
        }
        let keep: Vec<bool> = (0..n).map(|j| below[j] || chain.contains(&j)).collect();
        let what = format!("'{}', which carries the body,", self.joints[carrier].name);
        self.leave_out(&keep, &what);
        chain.len() - 1
    }

    /// Which joints hang on `joint`, itself included; and the way from it to the root, both included.
    fn around(&self, joint: usize) -> (Vec<bool>, Vec<usize>) {
        let chain = std::iter::successors(Some(joint), |&j| self.joints[j].parent).collect();
        let mut below = vec![false; self.joints.len()];
        for j in 0..self.joints.len() {
            below[j] = j == joint || self.joints[j].parent.is_some_and(|p| below[p]);
        }
        (below, chain)
    }

    /// Makes the joint that travels, or the pelvis, the root; see the [module's text](super).
    pub fn fold_root(&mut self, map: Option<&JointMap>) {
        let target = match map.and_then(|m| Some((m, m.joint(Canonical::Pelvis)?))) {
            Some((map, pelvis)) => {
                let Some(depth) = self.lone(pelvis, map) else {
                    let (root, pelvis) = (&self.joints[0].name, &self.joints[pelvis].name);
                    self.notes.push(format!(
                        "The pelvis '{pelvis}' is not the root: '{root}' carries other joints of the body too."
                    ));
                    return;
                };
                depth
            }
            None => self.carried(),
        };
        for _ in 0..target {
            let (above, still) = (self.joints[0].name.clone(), self.is_still(0));
            self.fold_once();
            let what = if still { "stays still" } else { "moves too; both motions were composed" };
            self.notes.push(format!("'{}' became the root; '{above}' above it {what}.", self.joints[0].name));
        }
    }

    /// How deep the pelvis is, once the joints beside it that are no part of the body are left out (targets of inverse kinematics,
    /// cameras, props); none where the body hangs on several of them.
    fn lone(&mut self, pelvis: usize, map: &JointMap) -> Option<usize> {
        let (below, chain) = self.around(pelvis);
        let keep: Vec<bool> = (0..self.joints.len()).map(|j| below[j] || chain.contains(&j)).collect();
        if Canonical::ALL.iter().filter_map(|&c| map.joint(c)).any(|j| !keep[j]) {
            return None;
        }
        self.leave_out(&keep, "the pelvis");
        Some(chain.len() - 1)
    }

    fn leave_out(&mut self, keep: &[bool], beside: &str) {
        if keep.iter().all(|&k| k) {
            return;
        }
        let left: Vec<&str> =
            self.joints.iter().zip(keep).filter(|(_, k)| !**k).map(|(j, _)| j.name.as_str()).collect();
        let shown = left.iter().take(5).copied().collect::<Vec<_>>().join("', '");
        let more = if left.len() > 5 { ", ..." } else { "" };
        self.notes.push(format!("{} joint(s) beside {beside} are left out: '{shown}'{more}.", left.len()));
        let mut columns = keep.iter().cycle();
        self.rotations.retain(|_| columns.next() == Some(&true));
        let index: Vec<usize> = (0..keep.len()).map(|j| keep[..j].iter().filter(|k| **k).count()).collect();
        let mut flags = keep.iter();
        self.joints.retain(|_| flags.next() == Some(&true));
        let mut flags = keep.iter();
        self.tracks.retain(|_| flags.next() == Some(&true));
        for joint in &mut self.joints {
            joint.parent = joint.parent.map(|p| index[p]);
        }
    }

    fn is_still(&self, joint: usize) -> bool {
        let n = self.joints.len();
        let still = self.tracks[joint].as_ref().is_none_or(|t| t.spread <= STILL);
        let first = self.rotations[joint];
        still && self.rotations.iter().skip(joint).step_by(n).all(|r| r.angle_to(&first) <= STILL_ANGLE)
    }

    /// Composes joint 0 into joint 1, its only child.
    fn fold_once(&mut self) {
        let n = self.joints.len();
        let positions = (0..self.frames)
            .map(|f| self.position(0, f) + self.rotations[f * n] * self.position(1, f))
            .collect::<Vec<_>>();
        for pose in self.rotations.chunks_exact_mut(n) {
            pose[1] = pose[0] * pose[1];
        }
        let mut at = 0..;
        self.rotations.retain(|_| at.next().is_some_and(|at: usize| !at.is_multiple_of(n)));
        self.joints.remove(0);
        for joint in &mut self.joints {
            joint.parent = joint.parent.and_then(|p| p.checked_sub(1));
        }
        self.tracks.remove(0);
        self.tracks[0] = Track::new(positions, self.joints[0].offset);
    }
}
