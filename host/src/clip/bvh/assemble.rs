//! From channels to a [`Clip`]: rotations, bones, units, root.

use nalgebra::{UnitQuaternion, Vector3};

use super::hierarchy::RawJoint;
use super::rows::Rows;
use super::{ParseError, orient, spikes};
use crate::clip::map::JointMap;
use crate::clip::{Clip, Joint, ReadOptions, Skeleton, measure};

/// A position track or bone that moves by less is at rest, m.
pub(super) const STILL: f64 = 1e-3;
/// Position channels of one joint over time, and what they do.
pub(super) struct Track {
    positions: Vec<Vector3<f64>>,
    /// Largest distance from the mean.
    pub spread: f64,
    /// Distance from the file's OFFSET to the mean.
    shift: f64,
}

/// A clip under construction; its root has not been chosen yet.
pub(super) struct Draft {
    pub joints: Vec<Joint>,
    pub tracks: Vec<Option<Track>>,
    pub rotations: Vec<UnitQuaternion<f64>>,
    pub frames: usize,
    pub notes: Vec<String>,
    /// The file's OFFSETs, file units.
    offsets: Vec<Vector3<f64>>,
}

pub(super) fn clip(
    raw: Vec<RawJoint>,
    rows: Rows,
    frame_time: f64,
    options: &ReadOptions,
    notes: Vec<String>,
) -> Result<Clip, ParseError> {
    let mut draft = Draft::new(raw, rows);
    draft.relative_positions();
    let skeleton = Skeleton { joints: std::mem::take(&mut draft.joints) };
    let map = joint_map(&skeleton, options)?;
    let unit = measure::unit(&skeleton, map.as_ref(), options, &mut draft.notes)?;
    draft.joints = skeleton.joints;
    draft.notes.extend(notes);
    draft.scale(unit.metres());
    draft.fold_root(map.as_ref());
    draft.note_tracks();

    let mut clip = draft.finish(frame_time);
    spikes::mend(&mut clip, options.repair);
    let map = joint_map(&clip.skeleton, options)?;
    measure::note_names(&mut clip, map.as_ref(), options);
    orient::turn(&mut clip, map.as_ref(), options);
    orient::note_floor(&mut clip);
    orient::note_rest_frame(&mut clip);
    measure::note_size(&mut clip, map.as_ref());
    Ok(clip)
}

/// The caller's map where it fits, or a known layout, which may not.
fn joint_map(skeleton: &Skeleton, options: &ReadOptions) -> Result<Option<JointMap>, ParseError> {
    Ok(JointMap::choose(skeleton, options.map.as_ref())?)
}

impl Draft {
    fn new(raw: Vec<RawJoint>, rows: Rows) -> Draft {
        let Rows { rotations, positions, frames } = rows;
        let tracks: Vec<Option<Track>> = raw.iter().zip(positions).map(|(j, p)| Track::new(p, j.offset)).collect();
        let offsets = raw.iter().map(|j| j.offset).collect();
        let joints = raw.into_iter().zip(&tracks).map(|(j, track)| Joint {
            name: j.name,
            parent: j.parent,
            offset: track.as_ref().map_or(j.offset, Track::mean),
            end: j.end,
        });
        Draft { joints: joints.collect(), tracks, rotations, frames, notes: Vec::new(), offsets }
    }

    /// Position channels that hold 0 on every joint below the root mean the OFFSETs: a body has bones.
    fn relative_positions(&mut self) {
        let tracked: Vec<usize> = (1..self.joints.len()).filter(|&j| self.tracks[j].is_some()).collect();
        let zero = |t: &Option<Track>| t.as_ref().is_some_and(|t| t.positions.iter().all(|p| *p == Vector3::zeros()));
        let shifted = |t: &Option<Track>| t.as_ref().is_some_and(|t| t.shift > 0.0);
        if !tracked.iter().all(|&j| zero(&self.tracks[j])) || !tracked.iter().any(|&j| shifted(&self.tracks[j])) {
            return;
        }
        for &joint in &tracked {
            self.joints[joint].offset = self.offsets[joint];
            self.tracks[joint] = None;
        }
        self.notes.push(format!(
            "Position channels replace the OFFSET, and those of {} joints are 0 throughout, which would make bones of length 0: \
             the OFFSETs are kept.",
            tracked.len()
        ));
    }

    fn scale(&mut self, factor: f64) {
        for joint in &mut self.joints {
            joint.offset *= factor;
            joint.end = joint.end.map(|e| e * factor);
        }
        for track in self.tracks.iter_mut().flatten() {
            track.positions.iter_mut().for_each(|p| *p *= factor);
            track.spread *= factor;
            track.shift *= factor;
        }
    }

    /// Notes what the position channels below the root did.
    fn note_tracks(&mut self) {
        let tracked = || {
            let all = self.joints.iter().zip(&self.tracks).skip(1);
            all.filter_map(|(j, t)| Some((j, t.as_ref()?)))
        };
        let worst = |of: fn(&Track) -> f64| {
            let over = || tracked().filter(move |(_, t)| of(t) > STILL);
            let top = over().max_by(|a, b| of(a.1).total_cmp(&of(b.1)))?;
            Some((over().count(), top.0.name.clone(), 100.0 * of(top.1)))
        };
        let mut notes = Vec::new();
        if let Some((count, name, cm)) = worst(|t| t.spread) {
            notes.push(format!(
                "Position channels of {count} joint(s) below the root vary, by up to {cm:.2} cm ('{name}'); bones are rigid \
                 here, the mean position became the bone."
            ));
        }
        if let Some((count, name, cm)) = worst(|t| t.shift) {
            notes.push(format!(
                "Position channels of {count} joint(s) replace an OFFSET that differs, by up to {cm:.2} cm ('{name}')."
            ));
        }
        self.notes.extend(notes);
    }

    /// Position of a joint relative to its parent.
    pub fn position(&self, joint: usize, frame: usize) -> Vector3<f64> {
        self.tracks[joint].as_ref().map_or(self.joints[joint].offset, |t| t.positions[frame])
    }

    fn finish(mut self, frame_time: f64) -> Clip {
        let root = (0..self.frames).map(|f| self.position(0, f)).collect();
        self.joints[0].offset = Vector3::zeros();
        let skeleton = Skeleton { joints: self.joints };
        Clip { skeleton, frame_time, root, rotations: self.rotations, coordinates: None, notes: self.notes }
    }
}

impl Track {
    pub fn new(positions: Vec<Vector3<f64>>, offset: Vector3<f64>) -> Option<Track> {
        if positions.is_empty() {
            return None;
        }
        let mut track = Track { positions, spread: 0.0, shift: 0.0 };
        let mean = track.mean();
        track.spread = track.positions.iter().map(|p| (p - mean).norm()).fold(0.0, f64::max);
        track.shift = (mean - offset).norm();
        Some(track)
    }

    fn mean(&self) -> Vector3<f64> {
        // Differences from the first keep a constant track exact to the last bit.
        let first = self.positions[0];
        first + self.positions.iter().map(|p| p - first).sum::<Vector3<f64>>() / self.positions.len() as f64
    }
}
