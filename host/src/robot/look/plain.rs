//! The links of a pack alone: nobody says how they look.

use kinesic::rig::JointKind;
use nalgebra::{Isometry3, Quaternion, UnitQuaternion, Vector3};

use super::{Drive, Link, Look, Solid, Way};
use crate::robot::Machine;

/// Bones shorter than this are none, m.
const SHORTEST: f64 = 1e-6;

impl Look {
    /// A bone from every joint to each that it carries, a cylinder about every hinge, a block on every slider, and a foot.
    pub fn of_machine(machine: &Machine) -> Self {
        Self::plain(machine).standing()
    }

    /// The same in the machine's own frame.
    pub(super) fn plain(machine: &Machine) -> Self {
        let skeleton = &machine.rig.skeleton.joints;
        let lengths: Vec<f64> =
            skeleton.iter().map(|joint| joint.offset.norm()).filter(|length| *length > SHORTEST).collect();
        // What is thick is so against the robot's own bones.
        let unit = match lengths.len() {
            0 => 0.1,
            count => (lengths.iter().sum::<f64>() / count as f64).clamp(0.01, 1.0),
        };
        let places = machine.rig.frames().places().zip(machine.rig.joint_coordinates());
        let links = skeleton.iter().zip(places).enumerate().map(|(at, (joint, ((kind, first), own)))| {
            let axis = Vector3::from(own.axes[0].map(f64::from));
            let children = skeleton.iter().filter(|other| other.parent == Some(at)).map(|other| other.offset);
            let bones = children.chain(joint.end).filter(|to| to.norm() > SHORTEST);
            let mut solids: Vec<Solid> = bones.map(|to| Solid::bone(&to, (0.12 * to.norm()).min(0.1 * unit))).collect();
            let about = UnitQuaternion::rotation_between(&Vector3::z(), &axis)
                .unwrap_or_else(|| UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI));
            let along = Isometry3::from_parts(Vector3::zeros().into(), about);
            let way = match kind {
                JointKind::Hinge => Way::Turns,
                JointKind::Slider => Way::Slides,
                _ => Way::Fixed,
            };
            solids.extend(match (way, joint.parent) {
                (Way::Turns, _) => Some(Solid::cylinder(0.16 * unit, 0.4 * unit).placed(&along)),
                (Way::Slides, _) => Some(Solid::cuboid(&Vector3::repeat(0.3 * unit)).placed(&along)),
                (Way::Fixed, None) => Some(Solid::cylinder(0.45 * unit, 0.08 * unit)),
                (Way::Fixed, Some(_)) => None,
            });
            let turn = UnitQuaternion::new_normalize(Quaternion::from(own.reference.map(f64::from)));
            Link {
                parent: joint.parent,
                at: Isometry3::from_parts(joint.offset.into(), turn),
                way,
                axis,
                drive: (way != Way::Fixed).then_some(Drive { coordinate: first, multiplier: 1.0, offset: 0.0 }),
                solids,
                tip: joint.end,
            }
        });
        let links = links.collect();
        Self { links, joints: (0..skeleton.len()).collect(), notes: Vec::new() }
    }
}
