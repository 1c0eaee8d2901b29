//! Whether a motion is a walk: legs that swing by turns.

use crate::clip::Canonical;
use crate::rig::{Locals, Rig};

/// Legs that swing less are no walk, m of root mean square between the ankles.
const SWING: f64 = 0.05;
/// Part of the root mean square by which a leg must be before the other to have passed it.
const PASSED: f64 = 0.5;
/// How often a leg passes the other in a walk at least: a stride and a half.
const PASSES: usize = 3;

/// Whether one leg passes the other again and again.
pub fn walks(rig: &Rig, motion: &Locals) -> bool {
    let [Some(left), Some(right)] = [Canonical::LAnkle, Canonical::RAnkle].map(|joint| rig.map.joint(joint)) else {
        return false;
    };
    if !rig.frames().travels() || motion.frames() == 0 {
        return false;
    }
    // Positions are heading-local: the third number is forward.
    let ahead =
        motion.positions.chunks_exact(motion.channels()).map(|frame| frame[3 * left + 2] - frame[3 * right + 2]);
    let swing = (ahead.clone().map(|x| x * x).sum::<f64>() / motion.frames() as f64).sqrt();
    let (mut before, mut passes) = (0.0, 0);
    for x in ahead.filter(|x| x.abs() > PASSED * swing) {
        passes += usize::from(x.signum() == -before);
        before = x.signum();
    }
    swing > SWING && passes >= PASSES
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clip::JointMap;
    use crate::gait::{Manner, skeleton, walk};

    #[test]
    fn a_walk_is_one_and_a_step_or_a_stoop_is_none() {
        let skeleton = skeleton();
        let map = JointMap::choose(&skeleton, None).unwrap().unwrap();
        let rig = Rig::new(&skeleton, &map).unwrap();
        let is = |manner: Manner, seconds| walks(&rig, &rig.locals_of(&walk(&manner, seconds, 60.0, 0.3, 1)));
        assert!(is(Manner::NEUTRAL, 2.5) && is(Manner::WEARY, 4.0));
        assert!(!is(Manner::NEUTRAL, 0.8));
        assert!(!is(Manner { stride: 0.0, knee: 0.0, ..Manner::WEARY }, 4.0));
    }
}
