//! From channels to a [`Clip`]: rotations, bones, units, root.

use nalgebra::{UnitQuaternion, Vector3};

use super::fields::Channel;
use super::hierarchy::RawJoint;
use super::motion::Motion;
use super::{ParseError, euler, orient};
use crate::clip::map::{Canonical, JointMap};
use crate::clip::units::{Unit, measure_leg};
use crate::clip::{Clip, Joint, ReadOptions, Skeleton, UpAxis};

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
}

pub(super) fn clip(raw: Vec<RawJoint>, motion: Motion, options: &ReadOptions) -> Result<Clip, ParseError> {
    let frame_time = motion.frame_time;
    let mut draft = Draft::new(raw, motion);
    let skeleton = Skeleton { joints: std::mem::take(&mut draft.joints) };
    let map = joint_map(&skeleton, options)?;
    let (unit, note) = unit(&skeleton, map.as_ref(), options)?;
    let pelvis = map.as_ref().and_then(|m| m.joint(Canonical::Pelvis));
    draft.joints = skeleton.joints;
    draft.notes.push(note);
    draft.scale(unit.metres());
    draft.fold_root(pelvis);
    draft.note_tracks();

    let mut clip = draft.finish(frame_time);
    let map = joint_map(&clip.skeleton, options)?;
    let up: Option<UpAxis> = options.up.or(options.map.as_ref().and_then(|m| m.up));
    orient::turn_up(&mut clip, map.as_ref(), up);
    orient::note_floor(&mut clip);
    orient::note_rest_frame(&mut clip);
    Ok(clip)
}

/// The caller's map, which must fit, or a known layout, which may not.
fn joint_map(skeleton: &Skeleton, options: &ReadOptions) -> Result<Option<JointMap>, ParseError> {
    match &options.map {
        Some(map) => Ok(Some(map.resolve(skeleton)?)),
        None => Ok(JointMap::detect(skeleton)),
    }
}

fn unit(skeleton: &Skeleton, map: Option<&JointMap>, options: &ReadOptions) -> Result<(Unit, String), ParseError> {
    if let Some(unit) = options.units {
        return Ok((unit, format!("Units: {unit}, as given.")));
    }
    if let Some(unit) = options.map.as_ref().and_then(|m| m.units) {
        return Ok((unit, format!("Units: {unit}, from the skeleton map.")));
    }
    let (leg, measured) = measure_leg(skeleton, map);
    match Unit::detect(leg) {
        Some(unit) => {
            let metres = leg * unit.metres();
            Ok((
                unit,
                format!(
                    "Units: {unit} assumed (1 unit = {} m): {measured} makes a leg of {metres:.2} m.",
                    unit.metres()
                ),
            ))
        }
        None => Err(ParseError::UnknownUnits(measured)),
    }
}

impl Draft {
    fn new(raw: Vec<RawJoint>, motion: Motion) -> Draft {
        let (frames, joints) = (motion.frames, raw.len());
        let width: usize = raw.iter().map(|j| j.channels.len()).sum();
        let mut rotations = Vec::with_capacity(frames * joints);
        let mut positions: Vec<Vec<Vector3<f64>>> = vec![Vec::new(); joints];
        for frame in motion.values.chunks_exact(width) {
            let mut values = frame.iter().copied();
            for (joint, track) in raw.iter().zip(&mut positions) {
                let (mut position, mut moved) = (joint.offset, false);
                let mut rotation = UnitQuaternion::identity();
                for (channel, value) in joint.channels.iter().zip(&mut values) {
                    match *channel {
                        Channel::Position(axis) => (position[axis], moved) = (value, true),
                        Channel::Rotation(axis) => rotation *= euler::about_axis(axis, value),
                    }
                }
                if moved {
                    track.push(position);
                }
                rotations.push(rotation);
            }
        }
        let tracks: Vec<Option<Track>> = raw.iter().zip(positions).map(|(j, p)| Track::new(p, j.offset)).collect();
        let joints = raw.into_iter().zip(&tracks).map(|(j, track)| Joint {
            name: j.name,
            parent: j.parent,
            offset: track.as_ref().map_or(j.offset, Track::mean),
            end: j.end,
        });
        Draft { joints: joints.collect(), tracks, rotations, frames, notes: Vec::new() }
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
        Clip { skeleton, frame_time, root, rotations: self.rotations, notes: self.notes }
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
