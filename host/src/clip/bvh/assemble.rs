//! From channels to a [`Clip`]: rotations, bones, units, root.

use std::collections::BTreeSet;

use nalgebra::{UnitQuaternion, Vector3};

use super::hierarchy::RawJoint;
use super::rows::Rows;
use super::spikes::Leap;
use super::{ParseError, orient, spikes};
use crate::clip::map::JointMap;
use crate::clip::{Clip, Joint, ReadOptions, Skeleton, measure};

/// A position track or bone that moves by less is at rest, m.
pub(super) const STILL: f64 = 1e-3;
/// Position channels of one joint over time, and what they do.
pub(super) struct Track {
    positions: Vec<Vector3<f64>>,
    mean: Vector3<f64>,
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
    draft.leave_out_lost(frame_time);
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
            offset: track.as_ref().map_or(j.offset, |t| t.mean),
            end: j.end,
        });
        Draft { joints: joints.collect(), tracks, rotations, frames, notes: Vec::new(), offsets }
    }

    /// Frames in which position channels leap by half of the longest bone and back are lost: no bone is measured by them.
    fn leave_out_lost(&mut self, frame_time: f64) {
        let bone = |t: &Option<Track>| t.as_ref().map(|t| spikes::middle(t.positions.iter()).norm());
        let longest = self.tracks.iter().skip(1).filter_map(bone).fold(0.0, f64::max);
        if !longest.is_normal() {
            return;
        }
        let leap = Leap { step: 0.5 * longest, absurd: 100.0 * longest, ..Leap::of(frame_time, 0) };
        let leaping = |t: &&Track| t.spread > 0.4 * longest;
        let tracks = || self.tracks.iter().skip(1).flatten().filter(leaping);
        let lost: BTreeSet<usize> = tracks().flat_map(|t| spikes::leaps(&t.positions, &leap)).collect();
        if lost.is_empty() || 2 * lost.len() > self.frames {
            return;
        }
        let places = self.joints.iter_mut().zip(&mut self.tracks).zip(&self.offsets);
        for ((joint, track), offset) in places.skip(1) {
            if let Some(track) = track {
                track.measure(*offset, &lost);
                joint.offset = track.mean;
            }
        }
        self.notes.push(format!(
            "{} position channels below the root leap and come back: lost frames? No bone is measured by them.",
            spikes::in_frames(&lost.into_iter().collect::<Vec<_>>())
        ));
    }

    /// Position channels that hold 0 on most joints below the root mean the OFFSETs, or what is added to them: a body has bones.
    fn relative_positions(&mut self) {
        let tracked: Vec<usize> = (1..self.joints.len()).filter(|&j| self.tracks[j].is_some()).collect();
        let empty = |t: &Track| t.mean == Vector3::zeros() && t.spread == 0.0;
        let (mut boneless, mut other) = (0, 0);
        for track in tracked.iter().filter_map(|&j| self.tracks[j].as_ref()) {
            match empty(track) {
                true => boneless += usize::from(track.shift > 0.0),
                false => other += 1,
            }
        }
        if boneless <= other {
            return;
        }
        for &joint in &tracked {
            let offset = self.offsets[joint];
            self.tracks[joint] = self.tracks[joint].take().filter(|t| !empty(t)).map(|t| t.beside(offset));
            self.joints[joint].offset = self.tracks[joint].as_ref().map_or(offset, |t| t.mean);
        }
        let kept = if other == 0 { "the OFFSETs are kept" } else { "all of them are added to the OFFSETs" };
        self.notes.push(format!(
            "Position channels replace the OFFSET, and those of {boneless} joints are 0 throughout, which would make bones of length 0: \
             {kept}."
        ));
    }

    fn scale(&mut self, factor: f64) {
        for joint in &mut self.joints {
            joint.offset *= factor;
            joint.end = joint.end.map(|e| e * factor);
        }
        for track in self.tracks.iter_mut().flatten() {
            track.positions.iter_mut().for_each(|p| *p *= factor);
            track.mean *= factor;
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
        let mut track = Track { positions, mean: Vector3::zeros(), spread: 0.0, shift: 0.0 };
        track.measure(offset, &BTreeSet::new());
        Some(track)
    }

    /// Mean, spread and shift over all frames but these.
    fn measure(&mut self, offset: Vector3<f64>, lost: &BTreeSet<usize>) {
        let kept = || self.positions.iter().enumerate().filter(|(f, _)| !lost.contains(f)).map(|(_, p)| *p);
        // Differences from the first keep a constant track exact to the last bit.
        let first = kept().next().unwrap_or(offset);
        let count = self.positions.len() - lost.len();
        let mean = first + kept().map(|p| p - first).sum::<Vector3<f64>>() / count.max(1) as f64;
        let spread = kept().map(|p| (p - mean).norm()).fold(0.0, f64::max);
        (self.mean, self.spread, self.shift) = (mean, spread, (mean - offset).norm());
    }

    /// The same motion about another place.
    fn beside(self, offset: Vector3<f64>) -> Track {
        let positions = self.positions.into_iter().map(|p| p + offset).collect();
        Track { positions, mean: self.mean + offset, spread: self.spread, shift: self.mean.norm() }
    }
}
