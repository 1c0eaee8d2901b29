//! How far a retargeted motion is from the one that it was made of: directions of limbs, feet and floor, shoulders, speed.

use kinesic_host::clip::{Canonical, Clip, JointMap, Skeleton};
use kinesic_host::retarget::retarget;
use kinesic_host::rig::Rig;
use nalgebra::Vector3;

use Canonical::*;

/// Limbs from joint to joint, by class. A limb that a skeleton does not have is left out.
pub const LIMBS: [(&str, &[(Canonical, Canonical)]); 10] = [
    ("upper arm", &[(LShoulder, LElbow), (RShoulder, RElbow)]),
    ("forearm", &[(LElbow, LWrist), (RElbow, RWrist)]),
    ("thigh", &[(LHip, LKnee), (RHip, RKnee)]),
    ("shin", &[(LKnee, LAnkle), (RKnee, RAnkle)]),
    ("lower spine", &[(Pelvis, Spine)]),
    ("upper spine", &[(Spine, Chest)]),
    ("chest-neck", &[(Chest, Neck)]),
    ("neck", &[(Neck, Head)]),
    ("hips' line", &[(RHip, LHip)]),
    ("shoulders' line", &[(RShoulder, LShoulder)]),
];
/// Limbs that end in a tip.
pub const TIPS: [(&str, &[Canonical]); 3] =
    [("hand", &[LWrist, RWrist]), ("foot", &[LAnkle, RAnkle]), ("head", &[Head])];
/// Shorter bones have no direction, m.
const NO_BONE: f64 = 5e-3;

/// The tip of a joint in a frame: the mean of what hangs on it, else its end site.
fn tip(clip: &Clip, positions: &[Vector3<f64>], frame: usize, joint: usize) -> Option<Vector3<f64>> {
    let skeleton = &clip.skeleton;
    let mut at = vec![joint];
    let mut found = Vec::new();
    while let Some(up) = at.pop() {
        for child in skeleton.children(up) {
            if skeleton.joints[child].offset.norm() > NO_BONE { found.push(positions[child]) } else { at.push(child) }
        }
    }
    if found.is_empty() {
        let end = skeleton.joints[joint].end.filter(|end| end.norm() > NO_BONE)?;
        return Some(positions[joint] + skeleton.world_rotations(clip.pose(frame))[joint] * end);
    }
    Some(found.iter().sum::<Vector3<f64>>() / found.len() as f64)
}

/// The direction of a limb in every frame; none where the skeleton does not have it.
fn directions(clip: &Clip, map: &JointMap, from: Canonical, to: Option<Canonical>) -> Option<Vec<Vector3<f64>>> {
    let top = map.joint(from)?;
    (0..clip.frames())
        .map(|frame| {
            let positions = clip.positions(frame);
            let end = match to {
                Some(to) => positions[map.joint(to)?],
                // Eyes are no tip of a head.
                None if from == Head && clip.skeleton.children(top).next().is_some() => return None,
                None => tip(clip, &positions, frame, top)?,
            };
            let bone = end - positions[top];
            (bone.norm() > NO_BONE).then(|| bone.normalize())
        })
        .collect()
}

/// The height of the lowest point of the feet, in every frame, m.
pub fn soles(clip: &Clip, map: &JointMap) -> Vec<f64> {
    let ankles = [LAnkle, RAnkle].map(|ankle| map.joint(ankle).unwrap());
    let skeleton = &clip.skeleton;
    let mut feet = vec![false; skeleton.len()];
    for joint in 0..skeleton.len() {
        feet[joint] = ankles.contains(&joint) || skeleton.joints[joint].parent.is_some_and(|p| feet[p]);
    }
    let sole = |frame: usize| {
        let (positions, rotations) = (clip.positions(frame), skeleton.world_rotations(clip.pose(frame)));
        let joints = (0..skeleton.len()).filter(|j| feet[*j]);
        let points = joints.flat_map(|j| [positions[j].y, (positions[j] + rotations[j] * end(skeleton, j)).y]);
        points.fold(f64::MAX, f64::min)
    };
    (0..clip.frames()).map(sole).collect()
}

fn end(skeleton: &Skeleton, joint: usize) -> Vector3<f64> {
    skeleton.joints[joint].end.unwrap_or_else(Vector3::zeros)
}

pub fn share(mut values: Vec<f64>, at: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(((values.len() as f64 - 1.0) * at).round() as usize).copied().unwrap_or(f64::NAN)
}

fn width(clip: &Clip, map: &JointMap) -> Vec<f64> {
    let [l, r] = [LShoulder, RShoulder].map(|s| map.joint(s).unwrap());
    (0..clip.frames()).map(|f| clip.positions(f)).map(|p| (p[l] - p[r]).norm()).collect()
}

/// The fastest turn of each joint that matters, rad a frame.
fn fastest(clip: &Clip, map: &JointMap) -> f64 {
    let joints: Vec<usize> = Canonical::ALL.iter().filter_map(|c| map.joint(*c)).collect();
    let worlds: Vec<_> = (0..clip.frames()).map(|f| clip.skeleton.world_rotations(clip.pose(f))).collect();
    let pairs = worlds.windows(2).flat_map(|w| joints.iter().map(move |j| w[0][*j].angle_to(&w[1][*j])));
    pairs.fold(0.0, f64::max)
}

/// The axis about which a joint turns in its parent over a clip; none where it hardly turns.
pub fn hinge(clip: &Clip, joint: usize) -> Option<Vector3<f64>> {
    let turns = (0..clip.frames()).map(|frame| clip.pose(frame)[joint].scaled_axis());
    turns.filter(|turn| turn.norm() > 0.35).sum::<Vector3<f64>>().try_normalize(1.0)
}

/// What is measured of one clip on one rig.
pub struct Measured {
    /// Class, mean, 95th percentile and maximum of the angle, degrees.
    pub limbs: Vec<(&'static str, f64, f64, f64)>,
    /// How far the feet are under the floor at most, m; the same of the source under its own floor.
    pub under: [f64; 2],
    /// Of the frames in which the source's feet are within 2 cm of its floor: how high the result's stand, the median and nine tenths, m.
    pub standing: [f64; 2],
    /// The width of the shoulders in m: least, median, greatest.
    pub shoulders: [f64; 3],
    /// The shoulders' width of the source, in parts of its median: least and greatest.
    pub breathing: [f64; 2],
    /// The fastest turn in the result and in the source, degrees a frame.
    pub fastest: [f64; 2],
}

pub fn measure(clip: &Clip, map: &JointMap, rig: &Rig) -> (Clip, Measured) {
    let moved = retarget(clip, map, rig).unwrap();
    let links = LIMBS.iter().flat_map(|(class, pairs)| pairs.iter().map(|(a, b)| (*class, *a, Some(*b))));
    let tips = TIPS.iter().flat_map(|(class, joints)| joints.iter().map(|a| (*class, *a, None)));
    let mut limbs: Vec<(&'static str, Vec<f64>)> = Vec::new();
    for (class, from, to) in links.chain(tips) {
        let both = directions(clip, map, from, to).zip(directions(&moved, &rig.map, from, to));
        let Some((a, b)) = both else { continue };
        let angles = a.iter().zip(&b).map(|(a, b)| a.angle(b).to_degrees());
        match limbs.iter_mut().find(|(name, _)| *name == class) {
            Some((_, all)) => all.extend(angles),
            None => limbs.push((class, angles.collect())),
        }
    }
    let limbs = limbs.into_iter().map(|(class, all)| {
        let mean = all.iter().sum::<f64>() / all.len() as f64;
        (class, mean, share(all.clone(), 0.95), share(all, 1.0))
    });
    let (a, b) = (soles(clip, map), soles(&moved, &rig.map));
    let floor = share(a.clone(), 0.05);
    let standing: Vec<f64> = a.iter().zip(&b).filter(|(a, _)| **a < floor + 0.02).map(|(_, b)| b - floor).collect();
    let shoulders = width(&moved, &rig.map);
    let own = width(clip, map);
    let part = |at: f64| share(own.clone(), at) / share(own.clone(), 0.5);
    let measured = Measured {
        limbs: limbs.collect(),
        under: [floor - share(b, 0.0), floor - share(a, 0.0)],
        standing: [share(standing.clone(), 0.5), share(standing, 0.9)],
        shoulders: [0.0, 0.5, 1.0].map(|at| share(shoulders.clone(), at)),
        breathing: [part(0.0), part(1.0)],
        fastest: [fastest(&moved, &rig.map).to_degrees(), fastest(clip, map).to_degrees()],
    };
    (moved, measured)
}
