//! Left and right exchanged: twice the training data for free.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use super::{Clip, Joint, JointMap, Skeleton, map};

/// Why a clip cannot be mirrored.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MirrorError {
    /// A joint of one side has no counterpart.
    #[error(
        "joint '{joint}' is on one side and its counterpart on the other side was not found. Name both like \
             LeftX/RightX, or give both in a skeleton map"
    )]
    NoPartner {
        /// The joint.
        joint: String,
    },
    /// The two sides hang on different parents.
    #[error(
        "joints '{joint}' and '{partner}' are partners, but their parents '{parent}' and '{partner_parent}' are not. \
             Mirroring needs a skeleton with two like sides"
    )]
    Tree {
        /// A joint.
        joint: String,
        /// Its partner.
        partner: String,
        /// The joint's parent.
        parent: String,
        /// The partner's parent.
        partner_parent: String,
    },
}

impl Clip {
    /// The mirror image: every position (x, y, z) of a joint becomes (-x, y, z) of its partner.
    ///
    /// The skeleton is mirrored with it (a longer right arm becomes a longer left arm), so positions are exact and mirroring
    /// twice gives the clip back. Where bones lie along other axes on the left and on the right, rest offsets and with them
    /// local rotations differ from those of the source skeleton: compare mirrored clips by position.
    ///
    /// Partners come from the detected layout and from the names; [`Clip::mirrored_with`] takes a map.
    pub fn mirrored(&self) -> Result<Clip, MirrorError> {
        self.mirrored_with(JointMap::detect(&self.skeleton).as_ref())
    }

    /// As [`Clip::mirrored`], with the partners of a given map.
    pub fn mirrored_with(&self, map: Option<&JointMap>) -> Result<Clip, MirrorError> {
        let partners = checked_partners(&self.skeleton, map)?;
        let source = &self.skeleton.joints;
        let joints = source.iter().zip(&partners).map(|(joint, &partner)| {
            let from = source.get(partner).unwrap_or(joint);
            Joint { offset: reflect(from.offset), end: from.end.map(reflect), ..joint.clone() }
        });
        let skeleton = Skeleton { joints: joints.collect() };
        let mut rotations = Vec::with_capacity(self.rotations.len());
        for frame in 0..self.frames() {
            let pose = self.pose(frame);
            rotations.extend(partners.iter().filter_map(|&p| pose.get(p)).map(reflect_rotation));
        }
        let root = self.root.iter().copied().map(reflect).collect();
        Ok(Clip {
            skeleton,
            frame_time: self.frame_time,
            root,
            rotations,
            coordinates: None,
            notes: self.notes.clone(),
        })
    }
}

fn checked_partners(skeleton: &Skeleton, map: Option<&JointMap>) -> Result<Vec<usize>, MirrorError> {
    let name =
        |index: Option<usize>| index.and_then(|i| skeleton.joints.get(i)).map_or("none".into(), |j| j.name.clone());
    let mut partners = Vec::with_capacity(skeleton.len());
    for (index, partner) in map::mirror_partners(skeleton, map).into_iter().enumerate() {
        partners.push(partner.ok_or_else(|| MirrorError::NoPartner { joint: name(Some(index)) })?);
    }
    for (index, &partner) in partners.iter().enumerate() {
        let parent = skeleton.joints[index].parent;
        let partner_parent = skeleton.joints.get(partner).and_then(|j| j.parent);
        if parent.and_then(|p| partners.get(p).copied()) != partner_parent {
            return Err(MirrorError::Tree {
                joint: name(Some(index)),
                partner: name(Some(partner)),
                parent: name(parent),
                partner_parent: name(partner_parent),
            });
        }
    }
    Ok(partners)
}

pub(crate) fn reflect(v: Vector3<f64>) -> Vector3<f64> {
    Vector3::new(-v.x, v.y, v.z)
}

/// `S R S` with `S = diag(-1, 1, 1)`: the axis is a pseudo-vector, so Y and Z turn round and X stays.
pub(crate) fn reflect_rotation(r: &UnitQuaternion<f64>) -> UnitQuaternion<f64> {
    UnitQuaternion::new_unchecked(Quaternion::new(r.w, r.i, -r.j, -r.k))
}
