//! A clip closed to a cycle: what comes before its first frame is blended into what comes before its last.

use nalgebra::{UnitQuaternion, Vector3};

use super::EditError;
use super::seam::{Looks, find, yaw};
use crate::clip::Clip;

/// How a cycle is chosen and closed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cycle {
    /// About how long it is, s; without, at least half of the clip.
    pub length: Option<f64>,
    /// How long its end passes over into its beginning, s.
    pub blend: f64,
}

/// The cycle that was found.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Seam {
    /// Where it begins in the clip, s.
    pub start_s: f64,
    /// How long it is, s.
    pub length_s: f64,
    /// How far its ends were apart before they were blended: joints as they look from where the person stands, cm; of a robot the coordinates,
    /// rad or m.
    pub apart: f64,
    /// Way along the ground of one cycle, m.
    pub travel_m: f64,
    /// Turn about the vertical of one cycle, degrees.
    pub turn_deg: f64,
}

/// Shares of the asked length at which a cycle is looked for.
const NEAR: [f64; 2] = [0.75, 1.25];

/// A part of the clip that can be played over and over. Its last frame is its first one again, one cycle's way and turn farther.
pub fn close(clip: &Clip, cycle: &Cycle) -> Result<(Clip, Seam), EditError> {
    let range = |option, found, expected: &str| EditError::Range { option, found, expected: expected.to_owned() };
    if !(cycle.blend >= 0.0 && cycle.blend <= 10.0) {
        return Err(range("--blend", cycle.blend, "seconds from 0 to 10"));
    }
    if let Some(length) = cycle.length.filter(|length| !(*length > 0.0 && length.is_finite())) {
        return Err(range("--length", length, "seconds above 0"));
    }
    let frames = |seconds: f64| (seconds / clip.frame_time).round() as usize;
    let (before, last) = (frames(cycle.blend), clip.frames().saturating_sub(1));
    let (least, most) = match cycle.length {
        Some(length) => (frames(NEAR[0] * length), frames(NEAR[1] * length)),
        None => (last / 2, last),
    };
    // A cycle is longer than what is blended.
    let least = least.max(before).max(2);
    let most = most.min(last.saturating_sub(before));
    if least > most {
        let [length, needed] = [least, least.saturating_add(before)].map(|frames| frames as f64 * clip.frame_time);
        return Err(EditError::Short { lasts: clip.duration(), needed, length, blend: cycle.blend });
    }
    let looks = Looks::of(clip);
    let asked = cycle.length.map(|length| length / clip.frame_time);
    let (start, length) = find(&looks, before, least..=most, asked).unwrap_or((before, least));
    let end = start + length;
    let mut out = clip.slice(start..end + 1);
    let step = Step::between(clip, start, end);
    let joints = clip.skeleton.len();
    for at in (length + 1).saturating_sub(before.max(1))..=length {
        // How far the frame has passed over: smoothly, whole at the end.
        let part = 1.0 - (length - at) as f64 / before.max(1) as f64;
        let part = part * part * (3.0 - 2.0 * part);
        let from = start + at - length;
        out.root[at] = out.root[at].lerp(&step.place(&clip.root[from]), part);
        for joint in 0..joints {
            let own = clip.rotations[from * joints + joint];
            let own = if joint == 0 { step.turn * own } else { own };
            let to = &mut out.rotations[at * joints + joint];
            *to = to.try_slerp(&own, part, 1e-12).unwrap_or(own);
        }
        if let (Some(to), Some(own)) = (&mut out.coordinates, clip.coordinates(from)) {
            let width = own.len();
            to[at * width..(at + 1) * width].iter_mut().zip(own).for_each(|(to, own)| *to += part * (own - *to));
        }
    }
    let centimetres = if clip.coordinates.is_some() { 1.0 } else { 100.0 };
    let seam = Seam {
        start_s: start as f64 * clip.frame_time,
        length_s: length as f64 * clip.frame_time,
        apart: centimetres * looks.ways_apart(start, end, before).sqrt(),
        travel_m: (clip.root[end] - clip.root[start]).xz().norm(),
        turn_deg: step.turn.scaled_axis().y.to_degrees(),
    };
    Ok((out, seam))
}

/// What a cycle adds to a place and a direction.
struct Step {
    turn: UnitQuaternion<f64>,
    from: Vector3<f64>,
    to: Vector3<f64>,
}

impl Step {
    fn between(clip: &Clip, start: usize, end: usize) -> Self {
        let angle = if clip.coordinates.is_some() { 0.0 } else { yaw(clip, end) - yaw(clip, start) };
        let turn = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), angle);
        let [from, to] = [start, end].map(|frame| Vector3::new(clip.root[frame].x, 0.0, clip.root[frame].z));
        Self { turn, from, to }
    }

    fn place(&self, point: &Vector3<f64>) -> Vector3<f64> {
        self.turn * (point - self.from) + self.to
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gait::{Manner, walk};

    /// A walk along a curve.
    fn curved() -> Clip {
        let mut clip = walk(&Manner::NEUTRAL, 6.0, 60.0, 0.0, 3);
        let joints = clip.skeleton.len();
        let (mut place, mut before) = (Vector3::zeros(), clip.root[0]);
        for frame in 0..clip.frames() {
            let turn = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), 0.004 * frame as f64);
            place += turn * (clip.root[frame] - before);
            before = clip.root[frame];
            clip.root[frame] = Vector3::new(place.x, before.y, place.z);
            clip.rotations[frame * joints] = turn * clip.rotations[frame * joints];
        }
        clip
    }

    #[test]
    fn the_last_frame_is_the_first_again_a_stride_farther() {
        for clip in [walk(&Manner::WEARY, 6.0, 60.0, 0.0, 3), curved()] {
            let (looped, seam) = close(&clip, &Cycle { length: Some(1.2), blend: 0.2 }).unwrap();
            let last = looped.frames() - 1;
            assert_eq!(looped.skeleton, clip.skeleton);
            assert!((looped.duration() - seam.length_s).abs() < 1e-9);
            assert!((0.9..=1.5).contains(&seam.length_s) && seam.apart < 6.0, "{seam:?}");
            let turn = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), seam.turn_deg.to_radians());
            for (joint, (first, again)) in looped.pose(0).iter().zip(looped.pose(last)).enumerate() {
                let first = if joint == 0 { turn * first } else { *first };
                assert!(first.angle_to(again) < 1e-6, "{joint}");
            }
            assert!((looped.root[last].y - looped.root[0].y).abs() < 1e-9);
            let way = (looped.root[last] - looped.root[0]).xz().norm();
            assert!((way - seam.travel_m).abs() < 1e-9 && way > 0.3, "{way}");
            // The step across the seam is like the steps beside it.
            let step = |frame: usize| {
                let turns = looped.pose(frame).iter().zip(looped.pose(frame + 1)).skip(1);
                turns.map(|(a, b)| a.angle_to(b)).fold(0.0, f64::max)
            };
            let largest = (0..last).map(step).fold(0.0, f64::max);
            assert!(
                step(last - 1) <= 1.5 * step(0) + 0.02 && largest < 0.2,
                "{} {} {largest}",
                step(last - 1),
                step(0)
            );
        }
        let turned = close(&curved(), &Cycle { length: Some(1.2), blend: 0.2 }).unwrap().1.turn_deg;
        assert!((8.0..22.0).contains(&turned), "{turned}");
    }

    #[test]
    fn what_holds_no_cycle_is_refused_with_what_it_takes() {
        let clip = walk(&Manner::NEUTRAL, 2.0, 60.0, 0.0, 1);
        let error = close(&clip, &Cycle { length: Some(3.0), blend: 0.3 }).unwrap_err().to_string();
        assert!(error.contains("1.98 s") && error.contains("2.55 s") && error.contains("--length"), "{error}");
        let blend = close(&clip, &Cycle { length: None, blend: -1.0 }).unwrap_err().to_string();
        assert!(blend.contains("--blend -1"), "{blend}");
        assert!(close(&clip, &Cycle { length: Some(f64::NAN), blend: 0.1 }).is_err());
        let (cut, _) = close(&clip, &Cycle { length: None, blend: 0.0 }).unwrap();
        assert!(cut.frames() >= 60);
    }
}
