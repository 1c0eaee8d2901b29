//! Kinect recordings (Kinder-Gator): a CSV with `Timestamp` in ms and X, Y, Z in m of 20 joints a row. Other clocks, units and axes are
//! found where that is certain, with a note (`sense`).
//!
//! The way in: missing cells are bridged, the uneven clock becomes an even one, camera coordinates become the world's, a
//! skeleton with rigid bones is fitted, and its rotations are solved for. Each step that changes something leaves a note.
//!
//! **Coordinates.** The sensor looks along +Z with Y up and X to *its* left: right-handed, in metres. A person who faces it
//! looks along -Z and has the left hand at -X. A half turn about Y makes this the convention of our clips (facing +Z, left
//! at +X); nothing is mirrored. Then the hips of the first frame go to x = z = 0 and the feet on the ground: y = 0 is the
//! height that the lower foot keeps for nine tenths of the time.

mod fault;
mod fit;
mod sense;
mod table;

pub use fault::KinectFault;
pub(super) use table::is_header;

use nalgebra::Vector3;
use std::path::Path;

use super::read::slurp;
use super::{Clip, ReadError, ReadOptions, Unit, UpAxis, solve};

/// The 20 joints, parents before children, depth first, with the index of the parent.
const JOINTS: [(&str, Option<usize>); 20] = [
    ("HipCenter", None),
    ("Spine", Some(0)),
    ("ShoulderCenter", Some(1)),
    ("Head", Some(2)),
    ("ShoulderLeft", Some(2)),
    ("ElbowLeft", Some(4)),
    ("WristLeft", Some(5)),
    ("HandLeft", Some(6)),
    ("ShoulderRight", Some(2)),
    ("ElbowRight", Some(8)),
    ("WristRight", Some(9)),
    ("HandRight", Some(10)),
    ("HipLeft", Some(0)),
    ("KneeLeft", Some(12)),
    ("AnkleLeft", Some(13)),
    ("FootLeft", Some(14)),
    ("HipRight", Some(0)),
    ("KneeRight", Some(16)),
    ("AnkleRight", Some(17)),
    ("FootRight", Some(18)),
];

/// Positions of one frame.
type Skeleton20 = [Vector3<f64>; 20];

/// A pause between rows that is worth a note, s (three frames of the sensor).
const PAUSE: f64 = 0.1;

/// A pause between rows that is filled, s. The longest of the Kinder-Gator recordings is 78 ms; hours of straight lines would be no
/// motion, and a few bytes would ask for gigabytes.
const LONGEST_PAUSE: f64 = 10.0;

/// How to read a recording.
#[derive(Clone, Debug, PartialEq)]
pub struct KinectOptions {
    /// Frames per second of the clip.
    pub fps: f64,
    /// Longest time, s, over which missing numbers are bridged by straight lines.
    pub max_gap: f64,
    /// Unit of length; else metres, unless the size of the body says millimetres or centimetres.
    pub units: Option<Unit>,
    /// Up axis; else Y, unless the body stands on its head.
    pub up: Option<UpAxis>,
    /// The axes are left-handed: X is turned round.
    pub left_handed: bool,
    /// Bridge joints that leap and come back.
    pub repair: bool,
}

impl Default for KinectOptions {
    fn default() -> Self {
        KinectOptions { fps: 30.0, max_gap: 0.25, units: None, up: None, left_handed: false, repair: false }
    }
}

/// A Kinect recording: the clip, and what was measured.
#[derive(Clone, Debug)]
pub struct Recording {
    /// The fitted clip: rigid bones, rotations.
    pub clip: Clip,
    /// The measured positions on the clip's clock and in its coordinates, row-major `[frames x 20]`, m. Bones stretch here.
    pub positions: Vec<Vector3<f64>>,
    /// Root mean square distance between fitted and measured joints, cm.
    pub residual_cm: f64,
}

/// Reads a recording with its measured positions; [`read_with`](crate::clip::read_with) gives the clip alone.
pub fn read_recording(path: impl AsRef<Path>, options: &KinectOptions) -> Result<Recording, ReadError> {
    let path = path.as_ref();
    parse(&slurp(path)?, options).map_err(|fault| ReadError::Kinect { path: path.into(), fault })
}

/// The reader of [`formats`](super::formats): the clip alone, with what the caller knows of the file.
pub(super) fn read(bytes: &[u8], path: &Path, options: &ReadOptions) -> Result<Clip, ReadError> {
    let own = KinectOptions {
        units: options.units.or(options.kinect.units),
        up: options.up.or(options.kinect.up),
        left_handed: options.left_handed || options.kinect.left_handed,
        repair: options.repair || options.kinect.repair,
        ..options.kinect.clone()
    };
    let recording = parse(bytes, &own).map_err(|fault| ReadError::Kinect { path: path.into(), fault })?;
    let mut clip = recording.clip;
    let map = super::JointMap::detect(&clip.skeleton);
    super::measure::note_size(&mut clip, map.as_ref());
    Ok(clip)
}

/// Parses the bytes of a recording.
pub fn parse(bytes: &[u8], options: &KinectOptions) -> Result<Recording, KinectFault> {
    if !(1.0..=1000.0).contains(&options.fps) {
        return Err(KinectFault::Rate { found: options.fps });
    }
    let mut table = table::read(bytes)?;
    let mut notes = std::mem::take(&mut table.notes);
    if table.repeated > 0 {
        notes.push(format!("{} row(s) that repeat a timestamp were dropped.", table.repeated));
    }
    if table.elsewhere > 0 {
        notes.push(format!(
            "In {} of them the body is elsewhere: several people? The first row of each timestamp is read; a column BodyId tells them \
             apart.",
            table.elsewhere
        ));
    }
    let duration = table.times.last().copied().unwrap_or(0.0);
    if table.rows.len() < 2 {
        return Err(KinectFault::TooShort { found: table.rows.len() });
    }
    if duration > 86_400.0 {
        return Err(KinectFault::TooLong { seconds: duration });
    }
    sense::untracked(&mut table, &mut notes)?;
    let bridged = table::bridge(&mut table, options.max_gap)?;
    if bridged > 0 {
        notes.push(format!("Missing numbers in {bridged} row(s) were bridged by straight lines."));
    }
    let steps = || table.times.windows(2).map(|w| w[1] - w[0]);
    if let Some((row, seconds)) = steps().enumerate().find(|(_, step)| *step > LONGEST_PAUSE) {
        let line = table.lines.get(row + 1).copied().unwrap_or(0);
        return Err(KinectFault::Pause { line, seconds, limit: LONGEST_PAUSE });
    }
    let pause = steps().fold(0.0, f64::max);
    notes.push(format!(
        "Uneven clock ({:.1} rows/s on the average, longest step {:.0} ms): resampled to {} fps by timestamp{}.",
        (table.rows.len() - 1) as f64 / duration,
        1000.0 * pause,
        options.fps,
        if pause > PAUSE { ", longer steps filled by straight lines" } else { "" },
    ));

    let mut frames = even_clock(&table, options.fps);
    if frames.len() < 2 {
        return Err(KinectFault::TooFast { rows: table.rows.len(), seconds: duration, fps: options.fps });
    }
    sense::units(&mut frames, options.units, &mut notes)?;
    sense::leaps(&mut frames, options, &mut notes);
    sense::axes(&mut frames, options, &mut notes);
    notes.push(to_world(&mut frames));
    if let Some(note) = sides(&frames) {
        notes.push(note);
    }
    let skeleton = fit::skeleton(&frames)?;
    let rotations = frames.iter().flat_map(|f| solve::rotations(&skeleton, f, None)).collect();
    let root = frames.iter().map(|f| f[0]).collect();
    let mut clip = Clip { skeleton, frame_time: 1.0 / options.fps, root, rotations, coordinates: None, notes };
    clip.make_signs_continuous();

    let positions: Vec<Vector3<f64>> = frames.into_iter().flatten().collect();
    let squares: f64 = clip.all_positions().iter().zip(&positions).map(|(a, b)| (a - b).norm_squared()).sum();
    let residual_cm = 100.0 * (squares / positions.len() as f64).sqrt();
    clip.notes.push(format!(
        "Positions only: a skeleton with rigid bones was fitted, {residual_cm:.1} cm rms off the joints."
    ));
    Ok(Recording { clip, positions, residual_cm })
}

/// Positions at even steps, by straight lines between the rows.
fn even_clock(table: &table::Table, fps: f64) -> Vec<Skeleton20> {
    let duration = table.times.last().copied().unwrap_or(0.0);
    let count = 1 + (duration * fps + 1e-3).floor() as usize;
    let mut after = 1;
    let frames = (0..count).filter_map(|frame| {
        let time = frame as f64 / fps;
        while after + 1 < table.times.len() && table.times[after] < time {
            after += 1;
        }
        let (t0, t1) = (*table.times.get(after - 1)?, *table.times.get(after)?);
        let (a, b) = (table.rows.get(after - 1)?, table.rows.get(after)?);
        let part = ((time - t0) / (t1 - t0)).clamp(0.0, 1.0);
        Some(std::array::from_fn(|j| a[j].lerp(&b[j], part)))
    });
    frames.collect()
}

/// Camera coordinates to ours, see the [module's text](self); returns the note.
fn to_world(frames: &mut [Skeleton20]) -> String {
    const FEET: [usize; 2] = [15, 19];
    let mut lower: Vec<f64> =
        frames.iter().map(|f| FEET.iter().map(|&j| f[j].y).fold(f64::INFINITY, f64::min)).collect();
    lower.sort_by(f64::total_cmp);
    let ground = lower.get(lower.len() / 10).copied().unwrap_or(0.0);
    let start = frames.first().map_or(Vector3::zeros(), |f| Vector3::new(f[0].x, ground, f[0].z));
    for position in frames.iter_mut().flatten() {
        let p = *position - start;
        *position = Vector3::new(-p.x, p.y, -p.z);
    }
    format!(
        "Camera coordinates turned half round about Y (the person faces +Z), feet put on the ground ({:+.2} m), first hips \
         to x = z = 0.",
        -ground
    )
}

/// Notes when the toes point against the direction in which left and right say the person faces.
fn sides(frames: &[Skeleton20]) -> Option<String> {
    let percent = sense::against(frames);
    (percent > 80).then(|| {
        format!("Left and right may be exchanged: the toes point backwards in {percent} % of the frames (`--handed left` exchanges them).")
    })
}
