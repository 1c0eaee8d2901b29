//! Which joint is which: 21 canonical joints, the layouts of the usual sources, map files for all others.
//!
//! [`SkeletonMap`] holds *names* (built in, or from a TOML file); resolved against a [`Skeleton`] it becomes a [`JointMap`]
//! of *indices*.

mod error;
mod file;
mod layouts;
mod partners;
mod parts;
mod shape;
mod suggest;

use std::path::Path;

pub use error::MapError;
pub use file::SkeletonMap;
pub use partners::mirror_partners;
pub use shape::{Sides, Suggestion, Sure, Witness, suggest};
pub use suggest::nearest;

use super::Skeleton;

/// A map of fewer names than a body has limbs is not taken for the map of another clip.
const LIMBS: usize = 5;

/// Number of canonical joints.
pub const CANONICAL: usize = 21;

/// The joints that every humanoid skeleton is compared by.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(u8)]
#[allow(missing_docs)] // Anatomy; L and R are the person's own sides. Shoulder, hip, ... name the joint, not the bone.
pub enum Canonical {
    Pelvis,
    Spine,
    Chest,
    Neck,
    Head,
    LCollar,
    LShoulder,
    LElbow,
    LWrist,
    RCollar,
    RShoulder,
    RElbow,
    RWrist,
    LHip,
    LKnee,
    LAnkle,
    LToe,
    RHip,
    RKnee,
    RAnkle,
    RToe,
}

use Canonical::*;

impl Canonical {
    /// All of them, in the order of their numbers.
    pub const ALL: [Canonical; CANONICAL] = [
        Pelvis, Spine, Chest, Neck, Head, LCollar, LShoulder, LElbow, LWrist, RCollar, RShoulder, RElbow, RWrist, LHip,
        LKnee, LAnkle, LToe, RHip, RKnee, RAnkle, RToe,
    ];

    /// Those without which a skeleton is not taken for a known layout; spine, neck, collars and toes may be missing.
    const CORE: [Canonical; 14] =
        [Pelvis, Head, LShoulder, LElbow, LWrist, RShoulder, RElbow, RWrist, LHip, LKnee, LAnkle, RHip, RKnee, RAnkle];

    /// Name in map files: `pelvis`, `l_knee`, ...
    pub fn name(self) -> &'static str {
        const NAMES: [&str; CANONICAL] = [
            "pelvis",
            "spine",
            "chest",
            "neck",
            "head",
            "l_collar",
            "l_shoulder",
            "l_elbow",
            "l_wrist",
            "r_collar",
            "r_shoulder",
            "r_elbow",
            "r_wrist",
            "l_hip",
            "l_knee",
            "l_ankle",
            "l_toe",
            "r_hip",
            "r_knee",
            "r_ankle",
            "r_toe",
        ];
        NAMES[self as usize]
    }

    /// The joint with this name.
    pub fn from_name(name: &str) -> Option<Canonical> {
        Self::ALL.into_iter().find(|c| c.name() == name)
    }

    /// The same joint on the other side; joints of the middle are their own.
    pub fn mirrored(self) -> Canonical {
        let name = self.name();
        let other = match name.split_once('_') {
            Some(("l", rest)) => Self::ALL.into_iter().find(|c| c.name().strip_prefix("r_") == Some(rest)),
            Some(("r", rest)) => Self::ALL.into_iter().find(|c| c.name().strip_prefix("l_") == Some(rest)),
            _ => None,
        };
        other.unwrap_or(self)
    }
}

/// Where the canonical joints are in one skeleton, and which joints mirror each other.
#[derive(Clone, Debug, PartialEq)]
pub struct JointMap {
    layout: String,
    joints: [Option<usize>; CANONICAL],
    partners: Vec<Option<usize>>,
    fitted: bool,
}

impl JointMap {
    /// Recognises one of the known layouts by its joint names: cmu31 (also Xia), bandai22, m21, daz43, aalto19, kinect20,
    /// cc24 (`CC_Base_*`), mixamo. Name spaces (`mixamorig:`) are ignored.
    ///
    /// Where no layout fits to the letter, names are read by their parts (side and bone): Biovision, Xsens, MotionBuilder, Unity, VRM,
    /// `mixamorig_`, `Bip01`, `.L` and `.R`, lower case; see [`JointMap::is_fitted`].
    ///
    /// `None` where pelvis, head and the limbs' joints are not all found; then a map file is needed.
    pub fn detect(skeleton: &Skeleton) -> Option<JointMap> {
        let fitted = || parts::fit(skeleton).map(|map| JointMap { fitted: true, ..map });
        layouts::detect(skeleton).or_else(fitted)
    }

    /// The given map where it fits, else what the names say where hardly any of the map's names are in the skeleton: it is of another
    /// clip of the set.
    pub fn choose(skeleton: &Skeleton, given: Option<&SkeletonMap>) -> Result<Option<JointMap>, MapError> {
        let Some(given) = given else { return Ok(Self::detect(skeleton)) };
        given.resolve(skeleton).map(Some).or_else(|error| {
            let names = || given.joints.iter().flatten();
            let found = names().filter(|name| skeleton.find(name).is_some()).count();
            let other =
                (names().count() >= LIMBS && 2 * found < names().count()).then(|| Self::detect(skeleton)).flatten();
            other.map(Some).ok_or(error)
        })
    }

    /// Whether the joints were found by parts of their names, not by a layout's names to the letter.
    pub fn is_fitted(&self) -> bool {
        self.fitted
    }

    /// Reads a map file and resolves it against a skeleton. See [`SkeletonMap::parse`] for the format.
    pub fn read(path: impl AsRef<Path>, skeleton: &Skeleton) -> Result<JointMap, MapError> {
        SkeletonMap::read(path)?.resolve(skeleton)
    }

    /// A map from indices that are known, in the order of [`Canonical::ALL`]; those beyond the skeleton are dropped.
    pub fn from_indices(layout: &str, joints: [Option<usize>; CANONICAL], skeleton: &Skeleton) -> JointMap {
        let joints = joints.map(|joint| joint.filter(|j| *j < skeleton.len()));
        Self::new(layout.to_owned(), joints, skeleton)
    }

    fn new(layout: String, joints: [Option<usize>; CANONICAL], skeleton: &Skeleton) -> JointMap {
        let mut map = JointMap { layout, joints, partners: Vec::new(), fitted: false };
        map.partners = mirror_partners(skeleton, Some(&map));
        map
    }

    /// Name of the layout, or of the map file.
    pub fn layout(&self) -> &str {
        &self.layout
    }

    /// Index of a canonical joint in the skeleton. Two canonical joints may share one (Kinect: chest and neck).
    pub fn joint(&self, canonical: Canonical) -> Option<usize> {
        self.joints[canonical as usize]
    }

    /// The canonical joint that sits at an index, the first where two share it.
    pub fn canonical(&self, joint: usize) -> Option<Canonical> {
        Canonical::ALL.into_iter().find(|&c| self.joint(c) == Some(joint))
    }

    /// The joint's counterpart on the other side; a joint of the middle is its own. `None` where a side joint has no
    /// counterpart, and for an index beyond the skeleton.
    pub fn mirror_partner(&self, joint: usize) -> Option<usize> {
        self.partners.get(joint).copied().flatten()
    }
}
