//! `--mask`: weights of joints.
//!
//! The pelvis stands for the root: its travel, its height and its tilt, with all joints above it. A root of weight 0 is the clip's, and feet that
//! are held stand on the clip's spots.

use kinesic_host::clip::Canonical;
use kinesic_host::rig::{MAX_JOINTS, Rig};
use miette::miette;

/// Sets weights from entries `JOINT=WEIGHT,...` (also several): a joint by the pack's name or its canonical one; `JOINT+=WEIGHT`
/// means all joints below it too; `*=WEIGHT` is the rest, whatever its place. Weights lie from 0 to `most`.
pub fn apply(entries: &[String], rig: &Rig, most: f32, mask: &mut [f32; MAX_JOINTS]) -> miette::Result<()> {
    let joints = &rig.skeleton.joints;
    let parse = |entry: &str| -> miette::Result<(String, bool, f32)> {
        let (name, weight) = entry
            .split_once('=')
            .ok_or_else(|| miette!("--mask {entry}: expected JOINT=WEIGHT, for example Head=0 or LeftArm+=0.5"))?;
        let weight = weight.trim().parse().ok().filter(|weight| (0.0..=most).contains(weight)).ok_or_else(|| {
            let range = if most.is_finite() { format!("from 0 to {most}") } else { "of 0 or more".to_owned() };
            miette!("--mask {entry}: expected a weight {range}")
        })?;
        let (name, below) = name.trim().strip_suffix('+').map_or((name.trim(), false), |name| (name.trim(), true));
        Ok((name.to_owned(), below, weight))
    };
    let entries: Vec<_> = entries.iter().flat_map(|text| text.split(',')).map(parse).collect::<Result<_, _>>()?;
    let is_rest = |(name, ..): &&(String, bool, f32)| name == "*";
    for (name, below, weight) in entries.iter().filter(is_rest).chain(entries.iter().filter(|e| !is_rest(e))) {
        if name == "*" {
            *mask = [*weight; MAX_JOINTS];
            continue;
        }
        let joint = rig.skeleton.find(name).or_else(|| Canonical::from_name(name).and_then(|c| rig.map.joint(c)));
        let joint = joint.ok_or_else(|| {
            let names: Vec<_> = joints.iter().map(|j| j.name.as_str()).collect();
            miette!(help = format!("the joints are: {}", names.join(", ")), "--mask {name}: there is no such joint")
        })?;
        let mut chosen = vec![false; joints.len()];
        for at in joint..joints.len() {
            chosen[at] = at == joint || *below && joints[at].parent.is_some_and(|parent| chosen[parent]);
        }
        if rig.map.joint(Canonical::Pelvis) == Some(joint) {
            let mut above = joints[joint].parent;
            while let Some(at) = above {
                (chosen[at], above) = (true, joints[at].parent);
            }
        }
        for (to, _) in mask.iter_mut().zip(chosen).filter(|(_, chosen)| *chosen) {
            *to = *weight;
        }
    }
    Ok(())
}

/// The weight of the root: that of joint 0, at most 1.
pub fn travels(weights: &[f32; MAX_JOINTS]) -> f64 {
    f64::from(weights[0]).clamp(0.0, 1.0)
}
