//! Limits in the coordinates of a pack that has engines: these work on the coordinates on which they were trained.

use kinesic::rig::JointKind;

use super::{JointLimit, LimitsModel};
use crate::rig::{JointCoordinates, Rig};

/// Coordinates that differ by less are the same.
const SAME: f32 = 1e-5;

/// A joint whose coordinates in a pack are not those of its limits.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("joint '{joint}': the pack has a {pack}, the limits a {limits}")]
pub struct Mismatch {
    /// Name of the joint.
    pub joint: String,
    /// Its coordinates in the pack.
    pub pack: String,
    /// Its coordinates in the limits.
    pub limits: String,
}

impl LimitsModel {
    /// The same limits in the coordinates of `rig`, joints in the same order. They must be the limits' own, but a free joint is a ball
    /// about any reference, or has no coordinates where `rig` has none.
    pub fn onto(&self, rig: &Rig) -> Result<Self, Mismatch> {
        let joints = self.joints.iter().zip(rig.joint_coordinates()).zip(&rig.skeleton.joints);
        let joint = |((limit, own), bone): ((&JointLimit, JointCoordinates), &crate::clip::Joint)| {
            let free = limit.is_free() && matches!(own.kind, JointKind::Ball | JointKind::Fixed);
            match free || same(&limit.coordinates, &own) {
                true => Ok(JointLimit { coordinates: own, ..*limit }),
                false => Err(Mismatch {
                    joint: bone.name.clone(),
                    pack: described(&own),
                    limits: described(&limit.coordinates),
                }),
            }
        };
        Ok(Self { joints: joints.map(joint).collect::<Result<_, _>>()?, ..self.clone() })
    }
}

/// True if both name the same coordinates of the same rotations.
fn same(a: &JointCoordinates, b: &JointCoordinates) -> bool {
    let near = |a: &[f32], b: &[f32]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < SAME);
    let count = axes(a.kind);
    let angles = match a.kind {
        JointKind::Hinge => 1,
        JointKind::Chain => 3,
        _ => 0,
    };
    let opposite = b.reference.map(|x| -x);
    a.kind == b.kind
        // What stands still has no coordinates that could differ.
        && (a.kind == JointKind::Fixed || near(&a.reference, &b.reference) || near(&a.reference, &opposite))
        && near(a.axes[..count].as_flattened(), b.axes[..count].as_flattened())
        && near(&a.middle[..angles], &b.middle[..angles])
}

/// Number of axes that a kind uses.
pub(super) fn axes(kind: JointKind) -> usize {
    match kind {
        JointKind::Hinge | JointKind::Slider => 1,
        JointKind::Chain => 3,
        JointKind::Fixed | JointKind::Ball => 0,
    }
}

fn described(joint: &JointCoordinates) -> String {
    // Four digits tell coordinates apart that people would call different.
    let round = |x: &f32| (f64::from(*x) * 1e4).round() / 1e4 + 0.0;
    let list =
        |values: &[f32]| format!("[{}]", values.iter().map(|x| round(x).to_string()).collect::<Vec<_>>().join(", "));
    let mut text = super::onto_body::kind_name(joint.kind).to_owned();
    if axes(joint.kind) > 0 {
        text += " about ";
        text += &joint.axes[..axes(joint.kind)].iter().map(|axis| list(axis)).collect::<Vec<_>>().join(", ");
    }
    if joint.kind != JointKind::Fixed {
        text += &format!(" from the reference {}", list(&joint.reference));
    }
    if matches!(joint.kind, JointKind::Hinge | JointKind::Chain) {
        text += &format!(", middle {}", list(&joint.middle[..joint.kind.coordinates()]));
    }
    text
}
