//! A table of joint positions (CSV): where every joint is in the world.
//!
//! One header line, then one line a frame: `frame`, `time_s`, and for every joint `JOINT.x`, `JOINT.y`, `JOINT.z` in metres. Right-handed, Y up;
//! six decimals.

use std::fmt::Write;

use nalgebra::Vector3;

use super::bvh::write::{WriteError, check};
use super::{Clip, Skeleton};
use crate::plain::quoted;

impl Clip {
    /// The table, see the module. Refuses what the BVH writer refuses.
    pub fn to_positions(&self) -> Result<String, WriteError> {
        check(self)?;
        Ok(table(&self.skeleton, self.frame_time, (0..self.frames()).map(|frame| self.positions(frame))))
    }
}

/// The table of joints that are at these places in every frame, m.
pub(crate) fn table(skeleton: &Skeleton, frame_time: f64, frames: impl Iterator<Item = Vec<Vector3<f64>>>) -> String {
    let mut out = String::from("frame,time_s");
    for joint in &skeleton.joints {
        for axis in ["x", "y", "z"] {
            out.push(',');
            out.push_str(&quoted(&format!("{}.{axis}", joint.name.trim())));
        }
    }
    for (frame, positions) in frames.enumerate() {
        // Writing to a String cannot fail.
        let _ = write!(out, "\n{frame},{:.6}", frame as f64 * frame_time);
        for value in positions.iter().flat_map(|place| place.iter()) {
            // No negative zero.
            let _ = write!(out, ",{:.6}", (value * 1e6).round() / 1e6 + 0.0);
        }
    }
    out.push('\n');
    out
}

#[cfg(test)]
mod tests {
    use crate::gait::{Manner, walk};

    #[test]
    fn every_joint_is_where_kinematics_puts_it() {
        let clip = walk(&Manner::NEUTRAL, 1.0, 30.0, 0.0, 1);
        let text = clip.to_positions().unwrap();
        let mut reader = csv::Reader::from_reader(text.as_bytes());
        let head = reader.headers().unwrap().clone();
        assert_eq!(head.iter().take(5).collect::<Vec<_>>(), ["frame", "time_s", "Hips.x", "Hips.y", "Hips.z"]);
        assert_eq!(head.len(), 2 + 3 * clip.skeleton.len());
        for (frame, record) in reader.records().enumerate() {
            let numbers: Vec<f64> = record.unwrap().iter().map(|cell| cell.parse().unwrap()).collect();
            assert!((numbers[1] - frame as f64 / 30.0).abs() < 1e-6 && numbers[0] == frame as f64);
            for (found, place) in numbers[2..].chunks(3).zip(clip.positions(frame)) {
                assert!(found.iter().zip(place.iter()).all(|(a, b)| (a - b).abs() < 1e-6));
            }
        }
    }
}
