//! Why a clip could not be read.

use std::path::PathBuf;

use super::bvh::BvhFault;
use super::kinect::KinectFault;
use super::map::MapError;

/// Why a clip could not be read. The message names the file, the line or joint, what was found, what was expected and what
/// to do next.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    /// There is no such file.
    #[error("{}: no such file. Check the path", path.display())]
    NotFound {
        /// The file.
        path: PathBuf,
    },
    /// A motion in the joints of a machine.
    #[error(
        "{}: this is a motion in the joints of a robot, and no robot is given. Say which: --robot ROBOT.kin; \
             `kinesic robot import --help` makes one from a URDF or a table of servos",
        path.display()
    )]
    Machine {
        /// The file.
        path: PathBuf,
    },
    /// A folder was given.
    #[error("{}: this is a folder, a clip is one file. Name a .bvh or .csv file inside it", path.display())]
    Directory {
        /// The folder.
        path: PathBuf,
    },
    /// The system refused.
    #[error("{}: cannot be read: {error}. Check the permissions", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said.
        error: String,
    },
    /// Neither content nor extension is known.
    #[error("{}: found {found}, expected a motion clip. Accepted: BVH (.bvh, starts with HIERARCHY), Kinect recordings \
             (.csv, header 'Timestamp,HipCenterX,...') and glTF (.glb, .gltf); export the clip as BVH", path.display())]
    UnknownFormat {
        /// The file.
        path: PathBuf,
        /// How the file starts.
        found: String,
    },
    /// A BVH file is broken.
    #[error("{}: {fault}", path.display())]
    Bvh {
        /// The file.
        path: PathBuf,
        /// Where and how.
        fault: BvhFault,
    },
    /// A Kinect CSV is broken.
    #[error("{}: {fault}", path.display())]
    Kinect {
        /// The file.
        path: PathBuf,
        /// Where and how.
        fault: KinectFault,
    },
    /// An FBX file is broken, or holds no skeleton in motion.
    #[error("{}: {fault}", path.display())]
    Fbx {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        fault: String,
    },
    /// A glTF file is broken, or holds no skeleton in motion.
    #[error("{}: {fault}", path.display())]
    Gltf {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        fault: String,
    },
    /// A compressed file is broken.
    #[error("{}: the gzip file cannot be unpacked: {error}. Unpack it yourself, or load it again", path.display())]
    Compressed {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        error: String,
    },
    /// Something was assumed, and strictness was asked for.
    #[error("{}: --strict takes no assumption: {note} Say it with an option (--units, --up, --handed, --map, --root, --repair), or \
             correct the file", path.display())]
    Assumed {
        /// The file.
        path: PathBuf,
        /// What would have been assumed.
        note: String,
    },
    /// The skeleton map that was given does not fit the clip.
    #[error("{}: the skeleton map does not fit: {error}", path.display())]
    Map {
        /// The clip's file.
        path: PathBuf,
        /// What does not fit.
        error: MapError,
    },
    /// The size of the skeleton fits no unit.
    #[error("{}: the unit of length cannot be told: {measured} fits a human size in none of m, cm, mm, inch, cmu \
             (1 unit = 5.644 cm), dm, foot. Say which it is (`--units cm`, `--units 0.08` for 8 cm a unit, or `units = \"cm\"` in the map file)", path.display())]
    UnknownUnits {
        /// The file.
        path: PathBuf,
        /// What was measured, with the number.
        measured: String,
    },
}
