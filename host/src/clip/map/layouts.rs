//! Joint names of the skeletons that clips usually come with.

use std::collections::HashMap;

use super::{CANONICAL, Canonical, JointMap};
use crate::clip::Skeleton;

/// One known layout. Names in the order of [`Canonical::ALL`]; empty where the skeleton has no such joint.
pub(super) struct Layout {
    pub name: &'static str,
    /// Joints that tell this layout from another with the same canonical names.
    tell: &'static [&'static str],
    pub joints: [&'static str; CANONICAL],
}

#[rustfmt::skip]
pub(super) const LAYOUTS: [Layout; 8] = [
    Layout { name: "cmu31", tell: &["LHipJoint", "LowerBack"], joints: [
        "Hips", "Spine", "Spine1", "Neck1", "Head",
        "LeftShoulder", "LeftArm", "LeftForeArm", "LeftHand", "RightShoulder", "RightArm", "RightForeArm", "RightHand",
        "LeftUpLeg", "LeftLeg", "LeftFoot", "LeftToeBase", "RightUpLeg", "RightLeg", "RightFoot", "RightToeBase"] },
    Layout { name: "bandai22", tell: &["UpperArm_L"], joints: [
        "Hips", "Spine", "Chest", "Neck", "Head",
        "Shoulder_L", "UpperArm_L", "LowerArm_L", "Hand_L", "Shoulder_R", "UpperArm_R", "LowerArm_R", "Hand_R",
        "UpperLeg_L", "LowerLeg_L", "Foot_L", "Toes_L", "UpperLeg_R", "LowerLeg_R", "Foot_R", "Toes_R"] },
    Layout { name: "m21", tell: &["Neck1"], joints: [
        "Hips", "Spine", "Spine1", "Neck1", "Head",
        "LeftShoulder", "LeftArm", "LeftForeArm", "LeftHand", "RightShoulder", "RightArm", "RightForeArm", "RightHand",
        "LeftUpLeg", "LeftLeg", "LeftFoot", "LeftToeBase", "RightUpLeg", "RightLeg", "RightFoot", "RightToeBase"] },
    Layout { name: "daz43", tell: &["abdomen"], joints: [
        "hip", "abdomen", "chest", "neck", "head",
        "lCollar", "lShldr", "lForeArm", "lHand", "rCollar", "rShldr", "rForeArm", "rHand",
        "lThigh", "lShin", "lFoot", "", "rThigh", "rShin", "rFoot", ""] },
    Layout { name: "aalto19", tell: &["Ab"], joints: [
        "Hips", "Ab", "Chest", "Neck", "Head",
        "LeftCollar", "LeftShoulder", "LeftElbow", "LeftWrist", "RightCollar", "RightShoulder", "RightElbow", "RightWrist",
        "LeftHip", "LeftKnee", "LeftAnkle", "", "RightHip", "RightKnee", "RightAnkle", ""] },
    Layout { name: "kinect20", tell: &["HipCenter"], joints: [
        "HipCenter", "Spine", "ShoulderCenter", "ShoulderCenter", "Head",
        "", "ShoulderLeft", "ElbowLeft", "WristLeft", "", "ShoulderRight", "ElbowRight", "WristRight",
        "HipLeft", "KneeLeft", "AnkleLeft", "FootLeft", "HipRight", "KneeRight", "AnkleRight", "FootRight"] },
    Layout { name: "cc24", tell: &["CC_Base_Hip"], joints: [
        "CC_Base_Hip", "CC_Base_Waist", "CC_Base_Spine02", "CC_Base_NeckTwist01", "CC_Base_Head",
        "CC_Base_L_Clavicle", "CC_Base_L_Upperarm", "CC_Base_L_Forearm", "CC_Base_L_Hand",
        "CC_Base_R_Clavicle", "CC_Base_R_Upperarm", "CC_Base_R_Forearm", "CC_Base_R_Hand",
        "CC_Base_L_Thigh", "CC_Base_L_Calf", "CC_Base_L_Foot", "CC_Base_L_ToeBase",
        "CC_Base_R_Thigh", "CC_Base_R_Calf", "CC_Base_R_Foot", "CC_Base_R_ToeBase"] },
    Layout { name: "mixamo", tell: &["Spine2"], joints: [
        "Hips", "Spine", "Spine2", "Neck", "Head",
        "LeftShoulder", "LeftArm", "LeftForeArm", "LeftHand", "RightShoulder", "RightArm", "RightForeArm", "RightHand",
        "LeftUpLeg", "LeftLeg", "LeftFoot", "LeftToeBase", "RightUpLeg", "RightLeg", "RightFoot", "RightToeBase"] },
];

/// The layout with the most joints found; the first of the table where two are equal.
pub(super) fn detect(skeleton: &Skeleton) -> Option<JointMap> {
    let bare = |name: &str| name.rsplit(':').next().unwrap_or_default().trim().to_owned();
    let index: HashMap<String, usize> =
        skeleton.joints.iter().enumerate().rev().map(|(i, j)| (bare(&j.name), i)).collect();
    let mut best: Option<(usize, &Layout, [Option<usize>; CANONICAL])> = None;
    for layout in &LAYOUTS {
        let joints = layout.joints.map(|name| index.get(name).copied());
        let found = joints.iter().flatten().count();
        let complete = Canonical::CORE.iter().all(|&c| joints[c as usize].is_some());
        let told = layout.tell.iter().all(|&t| index.contains_key(t));
        if complete && told && best.as_ref().is_none_or(|b| found > b.0) {
            best = Some((found, layout, joints));
        }
    }
    best.map(|(_, layout, joints)| JointMap::new(layout.name.into(), joints, skeleton))
}
