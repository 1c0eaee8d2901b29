//! A pack's robot as a description, and a description within a pack's limits.

use kinesic::rig::JointKind;
use nalgebra::{Isometry3, Quaternion, UnitQuaternion, Vector3};

use super::{Machine, Motion, Robot, RobotJoint};

impl Robot {
    /// The robot of a pack: joints with bounds and speeds, poses among them. A pack has no links that stand
    /// still, and followers stand still in it.
    pub fn of_machine(machine: &Machine) -> Self {
        let joints = &machine.rig.skeleton.joints;
        let limits = machine.limits.joints.iter();
        // Joint 0 is the base.
        let moved = joints.iter().zip(limits).skip(1).map(|(joint, limit)| {
            let own = &limit.coordinates;
            let (motion, kind) = match own.kind {
                JointKind::Hinge => (Motion::Revolute, "revolute"),
                JointKind::Slider => (Motion::Prismatic, "prismatic"),
                _ => (Motion::Fixed, "fixed"),
            };
            let moves = motion != Motion::Fixed;
            let turn = UnitQuaternion::new_normalize(Quaternion::from(own.reference.map(f64::from)));
            let axis = Vector3::from(own.axes[0].map(f64::from));
            RobotJoint {
                name: joint.name.clone(),
                line: 0,
                motion,
                kind: kind.to_owned(),
                base: joint.parent.map_or_else(String::new, |parent| joints[parent].name.clone()),
                child: joint.name.clone(),
                centre: None,
                parent: joint.parent.and_then(|parent| parent.checked_sub(1)),
                origin: Isometry3::from_parts(joint.offset.into(), turn),
                axis: axis.try_normalize(1e-6).unwrap_or_else(Vector3::x),
                lower: moves.then_some(f64::from(limit.lower[0])),
                upper: moves.then_some(f64::from(limit.upper[0])),
                velocity: moves.then_some(f64::from(limit.velocity[0])),
                mimic: None,
                notes: Vec::new(),
            }
        });
        Self { name: machine.name.clone(), joints: moved.collect(), shapes: Vec::new(), notes: Vec::new() }
    }

    /// Keeps a pack's bounds and speeds beside the description's own, the tighter of the two. A note says which joints the pack alone has.
    pub fn keep(&mut self, machine: &Machine) {
        let limits = machine.limits.joints.iter().filter(|limit| limit.count() > 0);
        let mut missing = Vec::new();
        for (servo, limit) in machine.servos.iter().zip(limits) {
            let Some(at) = self.find(&servo.name) else {
                missing.push(servo.name.as_str());
                continue;
            };
            let joint = &mut self.joints[at];
            if joint.motion == Motion::Continuous {
                (joint.motion, joint.lower, joint.upper) = (Motion::Revolute, None, None);
            }
            let tighter = |own: Option<f64>, other: f32, pick: fn(f64, f64) -> f64| {
                Some(own.map_or(f64::from(other), |own| pick(own, f64::from(other))))
            };
            joint.lower = tighter(joint.lower, limit.lower[0], f64::max);
            joint.upper = tighter(joint.upper, limit.upper[0], f64::min);
            joint.velocity = tighter(joint.velocity.filter(|speed| *speed > 0.0), limit.velocity[0], f64::min);
        }
        if !missing.is_empty() {
            self.notes.push(format!(
                "the robot's pack has joints that its description does not have, they get no values: {}",
                missing.join(", ")
            ));
        }
    }
}
