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
    #[error("{}: found {found}, expected a motion clip. Accepted: BVH (.bvh, starts with HIERARCHY) and Kinect recordings \
             (.csv, header 'Timestamp,HipCenterX,...'); export the clip as BVH", path.display())]
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
             (1 unit = 5.644 cm). Say which it is (`--units cm`, or `units = \"cm\"` in the map file)", path.display())]
    UnknownUnits {
        /// The file.
        path: PathBuf,
        /// What was measured, with the number.
        measured: String,
    },
}
