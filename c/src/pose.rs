//! Poses as C sees them.

use kinesic::Pose;
use kinesic::nalgebra::{Quaternion, UnitQuaternion, Vector3};

use crate::KINESIC_JOINTS;

/// A pose: local rotations and the root's position. Joints are in the pack's order (`kinesic inspect` prints it); those past the
/// pack's own are ignored. Metres, right-handed, Y up.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct KinesicPose {
    /// World position of the root, m.
    pub root: [f32; 3],
    /// Rotation of each joint relative to its parent: unit quaternions x, y, z, w.
    pub rotations: [[f32; 4]; KINESIC_JOINTS],
}

impl KinesicPose {
    /// As core sees it.
    pub(crate) fn to_core(self) -> Pose<KINESIC_JOINTS> {
        let mut pose = Pose::identity();
        pose.root = Vector3::from(self.root);
        for (to, [x, y, z, w]) in pose.rotations.iter_mut().zip(self.rotations) {
            *to = UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z));
        }
        pose
    }

    /// Takes a pose of core's.
    pub(crate) fn set(&mut self, pose: &Pose<KINESIC_JOINTS>) {
        self.root = pose.root.into();
        for (to, from) in self.rotations.iter_mut().zip(&pose.rotations) {
            *to = from.coords.into();
        }
    }
}

/// Makes the rest pose: all rotations the identity, the root at the origin.
///
/// # Safety
/// `pose` is null or valid.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinesic_pose_rest(pose: *mut KinesicPose) {
    // SAFETY: by the caller's promise.
    if let Some(pose) = unsafe { pose.as_mut() } {
        pose.set(&Pose::identity());
    }
}
