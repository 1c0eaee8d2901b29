//! One figure of a file, and which of its numbers a pose needs.

use super::fault::BvhFault;
use super::fields::Channel;
use super::hierarchy::RawJoint;

/// The joints below one ROOT, the first unless `root` names another, without channels that no pose needs; and which of a frame's numbers
/// are theirs.
pub(super) fn used(
    mut joints: Vec<RawJoint>,
    root: Option<&str>,
    notes: &mut Vec<String>,
) -> Result<(Vec<RawJoint>, Vec<bool>), BvhFault> {
    let roots: Vec<usize> = (0..joints.len()).filter(|&j| joints[j].parent.is_none()).collect();
    let names = || roots.iter().map(|&r| format!("'{}'", joints[r].name)).collect::<Vec<_>>().join(", ");
    let chosen = match root {
        None => 0,
        Some(name) => roots
            .iter()
            .position(|&r| joints[r].name == name)
            .ok_or_else(|| BvhFault::NoSuchRoot { name: name.into(), roots: names() })?,
    };
    let first = roots.get(chosen).copied().unwrap_or(0);
    let end = roots.get(chosen + 1).copied().unwrap_or(joints.len());
    if roots.len() > 1 {
        notes.push(match root {
            Some(name) => format!("Of {} figures, '{name}' is read, as given.", roots.len()),
            None => {
                format!("The file has {} figures ({}): the first is read; --root names another.", roots.len(), names())
            }
        });
    }
    let scaled = joints.iter().filter(|j| j.channels.iter().any(|c| matches!(c, Channel::Unused(0..3)))).count();
    if scaled > 0 {
        notes.push(format!("Scale channels of {scaled} joint(s) are left out: bones are rigid here."));
    }
    let keep: Vec<bool> = joints
        .iter()
        .enumerate()
        .flat_map(|(j, joint)| {
            let inside = (first..end).contains(&j);
            joint.channels.iter().map(move |c| inside && !matches!(c, Channel::Unused(_)))
        })
        .collect();
    if keep.iter().all(|&k| k) {
        return Ok((joints, keep));
    }
    if !keep.contains(&true) {
        return Err(BvhFault::NoChannels);
    }
    joints.truncate(end);
    joints.drain(..first);
    for joint in &mut joints {
        joint.parent = joint.parent.map(|p| p - first);
        joint.channels.retain(|c| !matches!(c, Channel::Unused(_)));
    }
    Ok((joints, keep))
}
