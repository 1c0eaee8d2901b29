//! A robot as its description gives it: joints in a tree.

use std::collections::HashMap;

use nalgebra::{Isometry3, UnitQuaternion, Vector3};

use super::shape::Shape;

/// Followers of followers: at most so many in a row.
pub(super) const LONGEST: usize = 32;

/// How a joint moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Motion {
    /// A hinge with bounds.
    Revolute,
    /// A hinge without.
    Continuous,
    /// A slider along its axis.
    Prismatic,
    /// In a plane or anyhow: no single coordinate.
    Other(&'static str),
    /// Not at all.
    Fixed,
}

/// `multiplier x + offset` of another joint's angle `x`.
#[derive(Clone, Debug, PartialEq)]
pub struct Mimic {
    /// The joint that leads.
    pub joint: String,
    /// Radians a radian.
    pub multiplier: f64,
    /// Radians.
    pub offset: f64,
}

/// One joint of a robot.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotJoint {
    /// Name as the file spells it.
    pub name: String,
    /// Line of the file.
    pub line: u32,
    /// How it moves.
    pub motion: Motion,
    /// Its type as the file spells it.
    pub kind: String,
    /// The link on which it sits.
    pub base: String,
    /// The link that it moves.
    pub child: String,
    /// Centre of mass of that link, in its frame, m, where it is given.
    pub centre: Option<Vector3<f64>>,
    /// The joint that moves the link on which this one sits; none on the root link.
    pub parent: Option<usize>,
    /// Its frame in that joint's.
    pub origin: Isometry3<f64>,
    /// Axis in its frame, length one.
    pub axis: Vector3<f64>,
    /// Bounds, rad or m, where they are given; the tighter of `limit` and `safety_controller`.
    pub lower: Option<f64>,
    /// See `lower`.
    pub upper: Option<f64>,
    /// Largest speed, rad/s or m/s, where it is given.
    pub velocity: Option<f64>,
    /// Whose angle it follows.
    pub mimic: Option<Mimic>,
    /// What was made of odd values, one sentence each.
    pub notes: Vec<String>,
}

/// A robot's tree of joints, in the file's order.
#[derive(Clone, Debug, PartialEq)]
pub struct Robot {
    /// Name of the robot.
    pub name: String,
    /// Its joints.
    pub joints: Vec<RobotJoint>,
    /// How its links look.
    pub shapes: Vec<Shape>,
    /// What was assumed or left out beside the joints, one sentence each.
    pub notes: Vec<String>,
}

impl Robot {
    /// Index of the joint with this name.
    pub fn find(&self, name: &str) -> Option<usize> {
        self.joints.iter().position(|joint| joint.name == name)
    }

    /// Whom a joint follows, unless that leads to no joint, or round in a ring.
    pub fn leader<'j>(&self, joint: &'j RobotJoint) -> Option<&'j Mimic> {
        let mimic = joint.mimic.as_ref()?;
        let next = |at: &usize| self.find(&self.joints[*at].mimic.as_ref()?.joint);
        let steps = std::iter::successors(Some(self.find(&mimic.joint)?), next).take(LONGEST + 1).count();
        (steps <= LONGEST).then_some(mimic)
    }

    /// The joint and those that carry it, outwards in.
    pub fn chain(&self, joint: usize) -> impl Iterator<Item = usize> + '_ {
        std::iter::successors(Some(joint), |at| self.joints[*at].parent)
    }

    /// Name of the root link, if the description says it.
    pub fn root(&self) -> Option<String> {
        self.joints
            .iter()
            .find(|joint| joint.parent.is_none())
            .map(|joint| joint.base.clone())
            .filter(|name| !name.is_empty())
    }

    /// The joints, each after those that carry it, one limb after the other.
    pub fn depth_first(&self) -> Vec<usize> {
        let mut children = vec![Vec::new(); self.joints.len()];
        let mut open: Vec<usize> = Vec::new();
        for (at, joint) in self.joints.iter().enumerate().rev() {
            match joint.parent {
                Some(parent) => children[parent].push(at),
                None => open.push(at),
            }
        }
        let mut order = Vec::with_capacity(self.joints.len());
        while let Some(at) = open.pop() {
            order.push(at);
            open.extend(&children[at]);
        }
        order
    }

    /// The frame of every joint in the root link's, all values zero.
    pub fn frames(&self) -> Vec<Isometry3<f64>> {
        self.placed(&|_| 0.0)
    }

    /// Forward kinematics: the frame of the link that each joint moves, in the root link's. `value` gives a joint's angle, rad, or length,
    /// m. Followers are not followed: see [`followed`](Self::followed).
    pub fn placed(&self, value: &dyn Fn(usize) -> f64) -> Vec<Isometry3<f64>> {
        self.placed_along(&self.depth_first(), value)
    }

    /// The same in an order that is known: [`depth_first`](Self::depth_first).
    pub(super) fn placed_along(&self, order: &[usize], value: &dyn Fn(usize) -> f64) -> Vec<Isometry3<f64>> {
        let mut frames = vec![Isometry3::identity(); self.joints.len()];
        for &at in order {
            let joint = &self.joints[at];
            let own = joint.origin * joint.moved(value(at));
            frames[at] = joint.parent.map_or(own, |parent| frames[parent] * own);
        }
        frames
    }

    /// The value of every joint: `own` of those that lead, `multiplier x + offset` of those that follow one, also by way of others.
    pub fn followed(&self, own: &[f64]) -> Vec<f64> {
        let mut values = own.to_vec();
        let index: HashMap<&str, usize> =
            self.joints.iter().zip(0..).map(|(joint, at)| (joint.name.as_str(), at)).collect();
        let led = |joint: &RobotJoint| {
            joint.mimic.as_ref().and_then(|mimic| Some((mimic.clone(), *index.get(mimic.joint.as_str())?)))
        };
        let leaders: Vec<Option<(Mimic, usize)>> = self.joints.iter().map(led).collect();
        // A ring of followers comes to no end.
        for _ in 0..LONGEST {
            let before = values.clone();
            for (value, leader) in values.iter_mut().zip(&leaders) {
                if let Some((mimic, leader)) = leader {
                    *value = mimic.multiplier * before[*leader] + mimic.offset;
                }
            }
            if values == before {
                break;
            }
        }
        values
    }
}

impl RobotJoint {
    /// What a value moves, in the joint's own frame.
    fn moved(&self, value: f64) -> Isometry3<f64> {
        match self.motion {
            Motion::Revolute | Motion::Continuous => Isometry3::rotation(self.axis * value),
            Motion::Prismatic => Isometry3::from_parts((self.axis * value).into(), UnitQuaternion::identity()),
            Motion::Fixed | Motion::Other(_) => Isometry3::identity(),
        }
    }
}
