//! A table of joint angles (CSV) for spreadsheets, notebooks and controllers.
//!
//! One header line, then one line a frame: `frame`, `time_s`, the root's position `ROOT_x_m`, `ROOT_y_m`, `ROOT_z_m`, and for every
//! joint `JOINT_z_deg`, `JOINT_x_deg`, `JOINT_y_deg`: its rotation relative to its parent as `Rz Rx Ry`, the angles of the
//! BVH writer, without jumps by whole turns. Right-handed, Y up; six decimals.

use std::fmt::Write;

use super::Clip;
use super::bvh::euler;
use super::bvh::write::{WriteError, check};
use crate::plain::quoted;

impl Clip {
    /// The table, see the module. Refuses what the BVH writer refuses.
    pub fn to_angles(&self) -> Result<String, WriteError> {
        check(self)?;
        let mut out = String::from("frame,time_s");
        let root = self.skeleton.joints.first().map_or("", |joint| &joint.name);
        for axis in ["x", "y", "z"] {
            push(&mut out, &quoted(&format!("{root}_{axis}_m")));
        }
        for joint in &self.skeleton.joints {
            for axis in ["z", "x", "y"] {
                push(&mut out, &quoted(&format!("{}_{axis}_deg", joint.name.trim())));
            }
        }
        let mut angles = vec![[0.0; 3]; self.skeleton.len()];
        for (frame, root) in self.root.iter().enumerate() {
            // Writing to a String cannot fail.
            let _ = write!(out, "\n{frame},{:.6}", frame as f64 * self.frame_time);
            root.iter().for_each(|v| push(&mut out, &decimals(*v)));
            for (near, rotation) in angles.iter_mut().zip(self.pose(frame)) {
                *near = euler::zxy(rotation, *near);
                near.iter().for_each(|angle| push(&mut out, &decimals(angle.to_degrees())));
            }
        }
        out.push('\n');
        Ok(out)
    }
}

fn push(out: &mut String, cell: &str) {
    out.push(',');
    out.push_str(cell);
}

fn decimals(value: f64) -> String {
    // No negative zero.
    format!("{:.6}", (value * 1e6).round() / 1e6 + 0.0)
}
