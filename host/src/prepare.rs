//! From files to motions on one rig at one frame rate: what every command does before its own work.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use sha2::{Digest, Sha256};

use crate::clip::{self, Canonical, Clip, JointMap, NoteLog, ReadError, ReadOptions, ResampleError};
use crate::files;
use crate::moves::{self, Moves, MovesError};
use crate::pack::InputFile;
use crate::retarget::{RetargetError, retarget};
use crate::rig::{MAX_JOINTS, Rig, RigError};
use crate::robot::{Machine, MotionError};

/// Why a clip cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PrepareError {
    /// The file cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// Names that no known layout has.
    #[error(
        "{}: the joint names are of no known skeleton: {joints}. Give a skeleton map (--map FILE) that names pelvis, head \
         and limbs; `kinesic inspect --suggest-map '{}' > map.toml` makes one to look at",
        path.display(),
        path.display()
    )]
    UnknownSkeleton {
        /// The file.
        path: PathBuf,
        /// Its joints.
        joints: String,
    },
    /// The skeleton cannot be a rig.
    #[error("{}: {error}", path.display())]
    Rig {
        /// The file.
        path: PathBuf,
        /// The cause.
        error: RigError,
    },
    /// The motion does not fit the rig.
    #[error("{}: {error}", path.display())]
    Retarget {
        /// The file.
        path: PathBuf,
        /// The cause.
        error: RetargetError,
    },
    /// The frame rate is out of range, or there would be too many frames.
    #[error("{}: {error}", path.display())]
    Resample {
        /// The file.
        path: PathBuf,
        /// The cause.
        error: ResampleError,
    },
    /// The file of a machine's motion cannot be used.
    #[error("{error}; {}", error.help)]
    Moves {
        /// The cause, with the file.
        error: MovesError,
    },
    /// The motion is not one of the machine's.
    #[error("{}: {error}", path.display())]
    Motion {
        /// The file.
        path: PathBuf,
        /// The cause.
        error: Box<MotionError>,
    },
    /// The motion is another machine's than the pack's.
    #[error("{}: its robot is not the pack's: leave --robot out, the pack knows its own", path.display())]
    OtherMachine {
        /// The file.
        path: PathBuf,
    },
    /// Too short to learn from or to play.
    #[error("{}: {found} frames at {fps} fps are too few, expected at least {MIN_FRAMES}", path.display())]
    TooShort {
        /// The file.
        path: PathBuf,
        /// Its frames at that rate.
        found: usize,
        /// Frames per second.
        fps: f64,
    },
}

/// Frames below which a clip is no motion.
const MIN_FRAMES: usize = 4;

/// A clip with the map of its joints: of a body, or of a machine.
#[derive(Clone, Debug)]
pub struct Source {
    /// Where it came from.
    pub path: PathBuf,
    /// The motion, as recorded.
    pub clip: Clip,
    /// Which joint is which.
    pub map: JointMap,
    /// Where notes are gathered.
    pub log: Option<&'static NoteLog>,
    /// Whose motion it is, if it is a machine's.
    pub machine: Option<Arc<Machine>>,
    /// The file of a machine's motion, with what in it is no joint.
    pub moves: Option<Moves>,
}

impl Source {
    /// A body's clip that is no file.
    pub fn new(name: impl Into<PathBuf>, clip: Clip, map: JointMap) -> Self {
        Self { path: name.into(), clip, map, log: None, machine: None, moves: None }
    }

    /// Reads a clip; its joints must be known, by name or through the options' map. With a machine in the options it is a motion in the
    /// machine's joints.
    pub fn read(path: &Path, options: &ReadOptions) -> Result<Self, PrepareError> {
        if let Some(machine) = &options.machine {
            return Self::read_moves(path, machine, options);
        }
        let clip = clip::read_with(path, options)?;
        let (clip, note) = fewer_joints(clip, options);
        if let (Some(note), Some(log)) = (note, options.log) {
            log.add(path, &[note]);
        }
        let map = JointMap::choose(&clip.skeleton, options.map.as_ref()).ok().flatten();
        let map = map.ok_or_else(|| PrepareError::UnknownSkeleton {
            path: path.to_owned(),
            joints: clip.skeleton.joints.iter().map(|j| j.name.as_str()).collect::<Vec<_>>().join(", "),
        })?;
        Ok(Self { log: options.log, ..Self::new(path, clip, map) })
    }

    fn read_moves(path: &Path, machine: &Arc<Machine>, options: &ReadOptions) -> Result<Self, PrepareError> {
        let refuse = |error: MovesError| PrepareError::Moves { error };
        let bytes = clip::contents(path)?;
        let mut moves = moves::parse(&bytes, path, &options.moves).map_err(refuse)?;
        if !moves.is_even() {
            let fps = moves.fps();
            moves = moves.resample(fps).map_err(|error| refuse(error.in_file(path)))?;
            moves.notes.push(format!("Uneven times: brought to {fps:.2} frames a second."));
        }
        let clip = machine
            .clip(&moves, options.angles)
            .map_err(|error| PrepareError::Motion { path: path.to_owned(), error: Box::new(error) })?;
        clip::gathered(path, &clip.notes, options)?;
        let (map, log) = (machine.rig.map.clone(), options.log);
        Ok(Self { path: path.to_owned(), clip, map, log, machine: Some(machine.clone()), moves: Some(moves) })
    }

    /// The same, to be put on a rig once more: what is assumed on the way was said the first time.
    pub fn quiet(&self) -> Self {
        Self::new(&self.path, self.clip.clone(), self.map.clone())
    }

    /// A rig of this clip's skeleton; of a machine its own.
    pub fn rig(&self) -> Result<Rig, PrepareError> {
        if let Some(machine) = &self.machine {
            return Ok(machine.rig.clone());
        }
        Rig::new(&self.clip.skeleton, &self.map).map_err(|error| PrepareError::Rig { path: self.path.clone(), error })
    }

    /// The motion on a rig, at a frame rate.
    pub fn on_rig(&self, rig: &Rig, fps: f64) -> Result<Clip, PrepareError> {
        let refuse = |error| PrepareError::Resample { path: self.path.clone(), error };
        let clip = self.clip.resample(fps).map_err(refuse)?;
        if clip.frames() < MIN_FRAMES {
            return Err(PrepareError::TooShort { path: self.path.clone(), found: clip.frames(), fps });
        }
        if self.machine.is_some() {
            return match clip.skeleton == rig.skeleton {
                true => Ok(clip),
                false => Err(PrepareError::OtherMachine { path: self.path.clone() }),
            };
        }
        let moved = retarget(&clip, &self.map, rig)
            .map_err(|error| PrepareError::Retarget { path: self.path.clone(), error })?;
        if let Some(log) = self.log {
            log.add(&self.path, moved.notes.get(clip.notes.len()..).unwrap_or(&[]));
        }
        Ok(moved)
    }

    /// Name for reports: the path as given.
    pub fn name(&self) -> String {
        self.path.display().to_string()
    }
}

/// A clip with more joints than a rig holds, with those alone on which a canonical joint hangs.
fn fewer_joints(clip: Clip, options: &ReadOptions) -> (Clip, Option<String>) {
    let joints = clip.skeleton.len();
    let Some(map) =
        JointMap::choose(&clip.skeleton, options.map.as_ref()).ok().flatten().filter(|_| joints > MAX_JOINTS)
    else {
        return (clip, None);
    };
    let mut keep = vec![false; joints];
    for joint in Canonical::ALL.iter().filter_map(|c| map.joint(*c)) {
        keep[joint] = true;
    }
    let fewer = clip.with_joints(&mut keep);
    let note = format!(
        "{joints} joints are more than the {MAX_JOINTS} of a rig: {} that no canonical joint hangs on are left out.",
        joints - fewer.skeleton.len()
    );
    (fewer, Some(note))
}

/// Path and hash of a training file, for the provenance.
pub fn fingerprint(path: &Path) -> Result<InputFile, std::io::Error> {
    let bytes = files::read(path)?;
    let sha256 = Sha256::digest(&bytes).iter().map(|byte| format!("{byte:02x}")).collect();
    Ok(InputFile { path: path.display().to_string(), sha256 })
}

/// Frame rate for a pack unless told otherwise: that of the slowest clip, at most 60 per second, or as often as a machine is told where to go.
pub fn common_rate<'a>(sources: impl Iterator<Item = &'a Source>) -> f64 {
    let most = |source: &Source| source.machine.as_ref().map_or(60.0, |machine| machine.limits.frame_rate);
    let slowest = sources.map(|source| source.clip.fps().min(most(source))).fold(f64::INFINITY, f64::min);
    // Frame times are written with few digits: 30.0003 is meant to be 30.
    if (slowest - slowest.round()).abs() < 0.01 * slowest { slowest.round() } else { slowest }
}
