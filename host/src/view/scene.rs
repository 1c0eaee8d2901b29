//! A pack on a clip.

use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use kinesic::engine::Controls;
use kinesic::{LoadError, Pack, Pose};
use serde::Serialize;

use super::machine::MachineData;
use super::{ViewClip, ViewError, ViewPack};
use crate::clip::{Canonical, Clip, JointMap, Skeleton};
use crate::prepare::Source;
use crate::rig::{HostFrame, MAX_JOINTS, Rig};
use crate::robot::Machine;
use crate::robot::look::Look;
use crate::{engines, limit};

/// Frames of each clip whose output the page compares with the host's.
pub const CHECKED: usize = 300;

/// Strength of that comparison: 1 would give body mechanics nothing to do.
pub const STRENGTH: f32 = 1.5;

type HostPose = Pose<MAX_JOINTS>;

/// A pack that plays clips as the scripts read it.
#[derive(Serialize)]
pub(super) struct PackData {
    #[serde(flatten)]
    pub body: BodyData,
    engine: &'static str,
    plausible: [f32; 2],
}

/// What the scripts read of any pack that moves a skeleton or a machine.
#[derive(Serialize)]
pub(super) struct BodyData {
    /// A machine's links; none for a body.
    machine: Option<MachineData>,
    name: String,
    rate: f32,
    size: usize,
    joints: Vec<JointData>,
    /// Joints that stand for the feet, left and right.
    feet: Vec<usize>,
    head: Option<usize>,
    legs: Vec<usize>,
    bytes: String,
}

impl BodyData {
    pub fn new(of: &ViewPack, pack: &Pack, rig: &Rig) -> Result<Self, ViewError> {
        let (skeleton, map) = (&rig.skeleton, &rig.map);
        let foot = |toe, ankle| map.joint(toe).or(map.joint(ankle));
        let machine = Machine::from_pack(pack).map_err(|error| ViewError::Rig { name: of.name.clone(), error })?;
        let machine = machine.map(|machine| {
            let plain = || Look::of_machine(&machine);
            MachineData::new(&machine, &of.look.clone().unwrap_or_else(plain))
        });
        let bytes = of.file.bytes();
        Ok(Self {
            machine,
            name: of.name.clone(),
            rate: pack.metadata().frame_rate,
            size: bytes.len(),
            joints: joints(skeleton, map),
            feet: [foot(Canonical::LToe, Canonical::LAnkle), foot(Canonical::RToe, Canonical::RAnkle)]
                .into_iter()
                .flatten()
                .collect(),
            head: map.joint(Canonical::Head),
            legs: legs(skeleton, map),
            bytes: BASE64_STANDARD.encode(bytes),
        })
    }
}

#[derive(Serialize)]
struct JointData {
    name: String,
    parent: Option<usize>,
    tip: Option<[f64; 3]>,
    /// Canonical name: finds the same joint on another skeleton.
    part: Option<&'static str>,
}

/// A clip on a pack's skeleton.
#[derive(Serialize)]
pub(super) struct SceneData {
    source: String,
    target: Option<String>,
    /// Of what the host makes of the source, see [`digest`].
    digest: String,
}

/// What plays one pack.
pub(super) struct Player<'p> {
    of: &'p ViewPack,
    pack: Pack<'p>,
    rig: Rig,
    engine: &'static str,
    player: engines::Player,
}

impl<'p> Player<'p> {
    pub fn new(of: &'p ViewPack) -> Result<Self, ViewError> {
        let refuse = |error| ViewError::Pack { name: of.name.clone(), error };
        let pack = of.file.pack().map_err(refuse)?;
        let rig = Rig::from_pack(&pack).map_err(|error| ViewError::Rig { name: of.name.clone(), error })?;
        let expected = "a translator, style components or body mechanics";
        let (engine, player) = engines::player(&pack, false).ok_or(LoadError::NoModel { expected }).map_err(refuse)?;
        Ok(Self { of, pack, rig, engine, player })
    }

    pub fn data(&self) -> Result<PackData, ViewError> {
        let (engine, plausible) = (self.engine, self.player.plausible);
        Ok(PackData { body: BodyData::new(self.of, &self.pack, &self.rig)?, engine, plausible })
    }

    pub fn scene(&self, clip: &ViewClip) -> Result<SceneData, ViewError> {
        let on_rig = |source: &Source| source.on_rig(&self.rig, f64::from(self.pack.metadata().frame_rate));
        let source = on_rig(&clip.source)?;
        let target = clip.target.as_ref().map(on_rig).transpose()?;
        let checked = &source.slice(0..CHECKED);
        let controls = Controls { strength: STRENGTH, ..Controls::default() };
        let refuse = |error| ViewError::Pack { name: self.of.name.clone(), error };
        let mut played = (self.player.play)(&self.pack, &self.rig, checked, &controls.into()).map_err(refuse)?;
        // A machine's servos keep their limits, as on the device.
        if !self.rig.frames().travels() {
            let limited = limit::play(&self.pack, &self.rig, &played).map_err(refuse)?;
            played = limited.map_or(played, |(clip, _)| clip);
        }
        let text = |clip: &Clip| BASE64_STANDARD.encode(bytemuck::cast_slice(&frames(&self.rig, clip)));
        Ok(SceneData {
            source: text(&source),
            target: target.as_ref().map(text),
            digest: hash(frames(&self.rig, &played).into_iter()),
        })
    }
}

/// Bits of a clip's frames as the page has them: poses of a body, coordinates of a machine.
fn frames(rig: &Rig, clip: &Clip) -> Vec<u32> {
    if rig.frames().travels() {
        return rig.poses(clip).iter().flat_map(|pose| words(pose, rig.joints())).collect();
    }
    rig.frames_of(clip).iter().flat_map(|frame| coordinates(rig, frame)).collect()
}

/// Bits of a machine's coordinates.
pub(super) fn coordinates(rig: &Rig, frame: &HostFrame) -> impl Iterator<Item = u32> {
    let count = rig.frames().coordinates();
    frame.coordinates().iter().take(count).map(|x| x.to_bits()).collect::<Vec<_>>().into_iter()
}

/// Bits of a pose: the root, then the quaternions `x y z w`.
pub(super) fn words(pose: &HostPose, joints: usize) -> impl Iterator<Item = u32> {
    let rotations = pose.rotations.iter().take(joints).flat_map(|q| q.coords.iter());
    pose.root.iter().chain(rotations).map(|x| x.to_bits())
}

/// Digest of the bits of poses: 16 hexadecimal digits.
pub fn digest(poses: &[HostPose], joints: usize) -> String {
    hash(poses.iter().flat_map(|pose| words(pose, joints)))
}

/// Two hashes over words, as the page computes them: 16 hexadecimal digits.
pub(super) fn hash(words: impl Iterator<Item = u32>) -> String {
    let (mut a, mut b) = (0x811c_9dc5u32, 0x9e37_79b9u32);
    for word in words {
        a = (a ^ word).wrapping_mul(0x0100_0193);
        b = (b ^ word).wrapping_mul(0x85eb_ca6b).wrapping_add(a);
    }
    format!("{a:08x}{b:08x}")
}

fn joints(skeleton: &Skeleton, map: &JointMap) -> Vec<JointData> {
    let part = |joint: usize| Canonical::ALL.into_iter().find(|c| map.joint(*c) == Some(joint)).map(Canonical::name);
    let joint = |(index, joint): (usize, &crate::clip::Joint)| JointData {
        name: joint.name.clone(),
        parent: joint.parent,
        tip: joint.end.map(Into::into),
        part: part(index),
    };
    skeleton.joints.iter().enumerate().map(joint).collect()
}

/// Hips' ball joints and all below.
fn legs(skeleton: &Skeleton, map: &JointMap) -> Vec<usize> {
    let tops = [map.joint(Canonical::LHip), map.joint(Canonical::RHip)];
    let mut legs: Vec<usize> = Vec::new();
    for (index, joint) in skeleton.joints.iter().enumerate() {
        if tops.contains(&Some(index)) || joint.parent.is_some_and(|parent| legs.contains(&parent)) {
            legs.push(index);
        }
    }
    legs
}

/// A joint of a pack in which manners show: an elbow, or what a machine moves first.
pub(super) fn first_joint(body: Option<&BodyData>) -> String {
    let moves = |body: &BodyData| body.machine.as_ref().and_then(MachineData::first_moving);
    if let Some((body, joint)) = body.and_then(|body| Some((body, moves(body)?))) {
        return body.joints[joint].name.clone();
    }
    let elbow = |joint: &&JointData| joint.part == Some(Canonical::LElbow.name());
    let joints = body.map_or(&[][..], |body| &body.joints);
    joints.iter().find(elbow).or(joints.first()).map_or_else(String::new, |joint| joint.name.clone())
}
