//! Dynamic features of a stream of poses (Boehs 2017, section 3), with ring buffers only.

use nalgebra::{UnitQuaternion, Vector3};

use super::contact::{Contacts, Foot, Thresholds, advance, start};
use crate::model::{LoadError, MechanicsMeta, Pack};
use crate::pose::{Heading, Pose, Skeleton, World, forward};

/// Number of features.
pub const FEATURES: usize = 23;

/// Where each feature begins.
pub mod feature {
    /// Hip velocity now, heading-local, body heights per second: x, y, z.
    pub const VELOCITY: usize = 0;
    /// Mean hip velocity over the last third of a second, in today's heading, body heights per second: x, y, z.
    pub const MEAN_VELOCITY: usize = 3;
    /// 1 while the foot stands: left, right.
    pub const CONTACT: usize = 6;
    /// Time in the air, s, at most 1: left, right.
    pub const AIR: usize = 8;
    /// Height of the hips over the ground, by that of standing straight.
    pub const HIP_HEIGHT: usize = 10;
    /// Heading-local orientation of the thighs: first and second column of the rotation matrix, left, then right. Unlike a
    /// quaternion it has no sign to choose, and no jump.
    pub const THIGHS: usize = 11;
}

/// How features are computed: joints, sizes and thresholds of one body at one frame rate.
#[derive(Clone, Copy, Debug)]
pub struct DynamicFeatures<'a> {
    skeleton: Skeleton<'a>,
    /// Ankle and toes, left and right.
    feet: [[u16; 2]; 2],
    /// Height of these joints over the sole of a flat foot, m.
    clearance: [[f32; 2]; 2],
    thighs: [u16; 2],
    per_height: f32,
    per_hip_height: f32,
    frame_time: f32,
    window: usize,
    /// When a foot stands.
    pub thresholds: Thresholds,
}

/// What the features remember: the last sound pose, the feet, and a third of a second of hip positions.
///
/// `WINDOW` is the capacity in frames, at least a third of the frame rate: 20 at 60 fps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FeatureState<const JOINTS: usize, const WINDOW: usize> {
    last: Pose<JOINTS>,
    heading: Heading,
    feet: [Foot; 2],
    roots: [Vector3<f32>; WINDOW],
    filled: usize,
    at: usize,
    gap: u16,
    started: bool,
    features: [f32; FEATURES],
}

impl<const JOINTS: usize, const WINDOW: usize> FeatureState<JOINTS, WINDOW> {
    /// Nothing seen yet.
    pub fn new() -> Self {
        Self {
            last: Pose::identity(),
            heading: Heading::default(),
            feet: [Foot::default(); 2],
            roots: [Vector3::zeros(); WINDOW],
            filled: 0,
            at: 0,
            gap: 0,
            started: false,
            features: [0.0; FEATURES],
        }
    }

    /// Forgets everything.
    pub fn reset(&mut self) {
        *self = Self::new();
    }

    /// The last sound pose: the current one, unless it was dropped or not finite.
    pub fn pose(&self) -> &Pose<JOINTS> {
        &self.last
    }

    /// The features of the last sound frame.
    pub fn features(&self) -> &[f32; FEATURES] {
        &self.features
    }

    /// Both feet.
    pub fn contacts(&self) -> Contacts {
        Contacts::of(&self.feet)
    }

    /// Frames since the last sound one.
    pub fn gap(&self) -> u16 {
        self.gap
    }

    /// Position `window` frames ago, or the oldest there is, and how many frames ago.
    fn oldest(&self, window: usize) -> Option<(Vector3<f32>, usize)> {
        let slot = if self.filled < window { 0 } else { self.at };
        Some((*self.roots.get(slot)?, self.filled)).filter(|(_, frames)| *frames > 0)
    }

    fn push(&mut self, root: Vector3<f32>, window: usize) {
        if let Some(slot) = self.roots.get_mut(self.at) {
            *slot = root;
        }
        self.at = if self.at + 1 < window { self.at + 1 } else { 0 };
        self.filled = (self.filled + 1).min(window);
    }
}

impl<const JOINTS: usize, const WINDOW: usize> Default for FeatureState<JOINTS, WINDOW> {
    fn default() -> Self {
        Self::new()
    }
}

impl<'a> DynamicFeatures<'a> {
    /// The features of a pack's body. `joints` and `window` are the capacities of the state.
    pub fn load(pack: &Pack<'a>, meta: &MechanicsMeta, joints: usize, window: usize) -> Result<Self, LoadError> {
        let skeleton = Skeleton::load(pack)?;
        let feet = match pack.slice::<[[u16; 2]; 2]>("mechanics/feet", 1)? {
            [feet] => *feet,
            _ => [[0; 2]; 2],
        };
        let clearance = match pack.slice::<[[f32; 2]; 2]>("mechanics/clearance", 1)? {
            [clearance] => *clearance,
            _ => [[0.0; 2]; 2],
        };
        let thighs = match pack.slice::<[u16; 2]>("mechanics/thighs", 1)? {
            [thighs] => *thighs,
            _ => [0; 2],
        };
        let body = Body { feet, clearance, thighs, height: meta.body_height, hip_height: meta.hip_height };
        let features = Self::new(skeleton, &body, pack.metadata().frame_rate)?;
        fits("JOINTS", features.skeleton.joints(), joints)?;
        fits("WINDOW", features.window, window)?;
        Ok(features)
    }

    /// The features of a body at a frame rate.
    pub fn new(skeleton: Skeleton<'a>, body: &Body, frame_rate: f32) -> Result<Self, LoadError> {
        let joints = skeleton.joints();
        let outside = |joint: &u16| *joint as usize >= joints;
        let refuse = |tensor, index| Err(LoadError::Value { tensor, index });
        if let Some(index) = body.feet.as_flattened().iter().position(outside) {
            return refuse("mechanics/feet", index);
        }
        if let Some(index) = body.thighs.iter().position(outside) {
            return refuse("mechanics/thighs", index);
        }
        let sound = |size: f32| (1e-2..1e3).contains(&size);
        if !(sound(body.height) && sound(body.hip_height) && (1.0..1e4).contains(&frame_rate)) {
            return Err(LoadError::Metadata);
        }
        Ok(Self {
            skeleton,
            feet: body.feet,
            clearance: body.clearance,
            thighs: body.thighs,
            per_height: 1.0 / body.height,
            per_hip_height: 1.0 / body.hip_height,
            frame_time: 1.0 / frame_rate,
            window: ((frame_rate / 3.0 + 0.5) as usize).max(1),
            thresholds: Thresholds::default(),
        })
    }

    /// The skeleton that poses must have.
    pub fn skeleton(&self) -> &Skeleton<'a> {
        &self.skeleton
    }

    /// Frames over which the mean velocity is taken.
    pub fn window(&self) -> usize {
        self.window
    }

    /// The features of one more frame. A pose that is not [sound](Pose::is_sound) is held: nothing changes but the clock,
    /// and the next sound pose is measured over the time that has passed. Cost: kinematics, about 50 multiply-adds a joint.
    pub fn step<const JOINTS: usize, const WINDOW: usize>(
        &self,
        state: &mut FeatureState<JOINTS, WINDOW>,
        pose: &Pose<JOINTS>,
    ) {
        if !pose.is_sound(self.skeleton.joints()) {
            if state.started {
                state.gap = state.gap.saturating_add(1);
                state.push(state.last.root, self.window);
            }
            return;
        }
        let mut world = World::identity();
        forward(&self.skeleton, pose, &mut world);
        state.heading = state.heading.follow(&self.skeleton, &world);
        let points = self.feet.map(|foot| foot.map(|joint| position(&world, joint)));
        let elapsed = self.frame_time * (1.0 + f32::from(state.gap));
        let mut velocity = Vector3::zeros();
        if state.started {
            advance(&mut state.feet, &points, &self.clearance, &self.thresholds, elapsed);
            velocity = (pose.root - state.last.root) * (self.per_height / elapsed);
        } else {
            start(&mut state.feet, &points, &self.clearance, &self.thresholds);
        }
        let mean = state.oldest(self.window).map_or_else(Vector3::zeros, |(root, frames)| {
            (pose.root - root) * (self.per_height / (self.frame_time * frames as f32))
        });
        state.push(pose.root, self.window);
        (state.started, state.gap, state.last) = (true, 0, *pose);

        let contacts = Contacts::of(&state.feet);
        let [left, right] = contacts.ground;
        let height = (pose.root.y - left.min(right)) * self.per_hip_height;
        let thighs = self.thighs.map(|joint| orientation(&world, joint, state.heading));
        let velocity: [f32; 3] = state.heading.to_local(velocity).into();
        let mean: [f32; 3] = state.heading.to_local(mean).into();
        let stands = contacts.stands.map(|stands| if stands { 1.0 } else { 0.0 });
        let all = velocity
            .into_iter()
            .chain(mean)
            .chain(stands)
            .chain(contacts.air)
            .chain([height])
            .chain(thighs.into_iter().flatten());
        for (to, from) in state.features.iter_mut().zip(all) {
            *to = from;
        }
    }
}

/// What features need to know about a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    /// Joints of ankle and toes, left and right; the ankle twice where there are no toes.
    pub feet: [[u16; 2]; 2],
    /// Height of these joints over the sole of a flat foot, m.
    pub clearance: [[f32; 2]; 2],
    /// Joints of the thighs (the hips' ball joints), left and right.
    pub thighs: [u16; 2],
    /// Height standing straight, m.
    pub height: f32,
    /// Height of the root standing straight, m.
    pub hip_height: f32,
}

fn position<const JOINTS: usize>(world: &World<JOINTS>, joint: u16) -> Vector3<f32> {
    world.positions.get(joint as usize).copied().unwrap_or_default()
}

/// First and second column of a joint's rotation in the heading's axes.
fn orientation<const JOINTS: usize>(world: &World<JOINTS>, joint: u16, heading: Heading) -> [f32; 6] {
    let rotation = world.rotations.get(joint as usize).copied().unwrap_or_else(UnitQuaternion::identity);
    let x = heading.to_local(rotation * Vector3::x());
    let y = heading.to_local(rotation * Vector3::y());
    [x.x, x.y, x.z, y.x, y.y, y.z]
}

pub(super) fn fits(parameter: &'static str, found: usize, capacity: usize) -> Result<(), LoadError> {
    if found > capacity { Err(LoadError::Capacity { parameter, found, capacity }) } else { Ok(()) }
}
