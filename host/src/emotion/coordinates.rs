//! What a motion is made of: coordinates and velocities at its keyframes.
//!
//! A keyframe has one number per *channel*: the coordinates of a frame in order, then, of a body that travels, its heading. The root's
//! row is then no travel but a place. Place and heading are in the frame of the motion's first pose: the ground below its root is the
//! origin, its heading +Z.

use nalgebra::Vector3;

use crate::rig::{HostFrame, Rig};

/// Numbers of a keyframe.
pub fn channels(rig: &Rig) -> usize {
    3 * rig.rows() + usize::from(rig.frames().travels())
}

/// How far a unit of each channel moves the body, m per rad or m: times these, distances and speeds of keyframes are those of all
/// joints together, as if every channel moved alone.
pub fn levers(rig: &Rig) -> Vec<f64> {
    let mut levers = rig.levers();
    if rig.frames().travels() {
        // A turn about the vertical through the root.
        let body = rig.positions(&vec![0.0; levers.len()]);
        levers.push(body.chunks_exact(3).map(|p| p[0] * p[0] + p[2] * p[2]).sum::<f64>().sqrt());
    }
    levers
}

/// The channels of every frame of a motion, `[frames x channels]`.
pub fn of_frames(rig: &Rig, frames: &[HostFrame]) -> Vec<f64> {
    let travels = rig.frames().travels();
    let Some(first) = frames.first() else { return Vec::new() };
    let (mut before, mut heading) = (first.heading, 0.0);
    let mut rows = Vec::with_capacity(frames.len() * channels(rig));
    for frame in frames {
        let start = rows.len();
        rows.extend(frame.coordinates()[..3 * rig.rows()].iter().map(|x| f64::from(*x)));
        if travels {
            let [x, z] = [0, 1].map(|axis| frame.ground[axis] - first.ground[axis]);
            let place = first.heading.to_local(Vector3::new(x, 0.0, z));
            (rows[start], rows[start + 2]) = (f64::from(place.x), f64::from(place.z));
            // Turns add up, so that a motion may turn round.
            let [sin, cos] = frame.heading.turn_from(before);
            heading += f64::from(sin).atan2(f64::from(cos));
            before = frame.heading;
            rows.push(heading);
        }
    }
    rows
}

/// Channels times levers, m, then velocities since the keyframe before, m/s, keyframe by keyframe: `[frames x 2 channels]`. The first
/// keyframe has the second's velocity. `rows` are the channels of the whole motion, `seconds` lie between two of them.
pub fn at_frames(rows: &[f64], levers: &[f64], frames: &[usize], seconds: f64) -> Vec<f64> {
    let at = |frame: usize| rows[frame * levers.len()..].iter().zip(levers).map(|(x, lever)| x * lever);
    let mut keyframes = Vec::with_capacity(2 * frames.len() * levers.len());
    for k in 0..frames.len() {
        keyframes.extend(at(frames[k]));
        let (from, to) = (frames[k.max(1) - 1], frames[k.max(1)]);
        let time = (to - from) as f64 * seconds;
        keyframes.extend(at(to).zip(at(from)).map(|(to, from)| (to - from) / time));
    }
    keyframes
}

/// Position of every joint in the motion's frame, m, `[keyframes x 3 joints]`, of channels `[keyframes x channels]`.
pub fn positions(rig: &Rig, keyframes: &[f64]) -> Vec<f64> {
    let (channels, coordinates, joints) = (channels(rig), 3 * rig.rows(), rig.joints());
    let rows: Vec<f64> = keyframes.chunks_exact(channels).flat_map(|row| row[..coordinates].to_vec()).collect();
    let mut positions = rig.positions(&rows);
    if rig.frames().travels() {
        for (key, body) in keyframes.chunks_exact(channels).zip(positions.chunks_exact_mut(3 * joints)) {
            let (sin, cos) = key[coordinates].sin_cos();
            for p in body.chunks_exact_mut(3) {
                (p[0], p[2]) = (key[0] + cos * p[0] + sin * p[2], key[2] + cos * p[2] - sin * p[0]);
            }
        }
    }
    positions
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clip::JointMap;
    use crate::emotion::segment::{Cut, FRAME_RATE, cut};
    use crate::gait::{Manner, skeleton, walk};

    #[test]
    fn channels_of_a_walk_give_its_positions_back() {
        let skeleton = skeleton();
        let rig = Rig::new(&skeleton, &JointMap::detect(&skeleton).unwrap()).unwrap();
        let clip = walk(&Manner::WEARY, 6.0, FRAME_RATE, 0.3, 2);
        let poses = rig.poses(&clip);
        let rig = rig.centred(&[&poses]);
        for motion in cut(&rig, &clip, Cut::Cycles) {
            let rows = of_frames(&rig, &rig.read(&poses[motion.start..motion.start + motion.frames()]));
            assert_eq!(rows.len(), motion.frames() * channels(&rig));
            let made = positions(&rig, &rows);
            let worst = made.iter().zip(&motion.positions).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(worst < 1e-4, "{worst} m");
            // Times levers, the way from frame to frame is of the order of that of the joints; a thigh and its knee make up for each other.
            let levers = levers(&rig);
            let keys = at_frames(&rows, &levers, &[0, 4], motion.frame_time);
            let speed = |v: &mut dyn Iterator<Item = f64>| v.map(|v| v * v).sum::<f64>().sqrt();
            let found = speed(&mut keys[3 * levers.len()..].iter().copied());
            let seconds = 4.0 * motion.frame_time;
            let real = speed(&mut motion.frame(4).iter().zip(motion.frame(0)).map(|(b, a)| (b - a) / seconds));
            assert!((0.7..3.0).contains(&(found / real)), "{found} {real}");
        }
    }
}
