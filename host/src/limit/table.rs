//! A table of limits for people and other programs: JSON, TOML, CSV.

use kinesic::limit::JointKind;
use serde::Serialize;

use super::robot::kind_name;
use super::{JointLimit, LimitsModel};

/// All limits by name.
#[derive(Clone, Debug, Serialize)]
pub struct Table {
    /// Name of the robot or of the table.
    pub name: String,
    /// Frames per second at which the limiter is stepped.
    pub frame_rate: f64,
    /// Largest speed of the root, m/s.
    pub root_velocity: f64,
    /// Largest acceleration of the root, m/s^2.
    pub root_acceleration: f64,
    /// Time for which the last sound frame is held, s.
    pub hold: f64,
    /// Time constant of the way to rest, s.
    pub decay: f64,
    /// Time after which equal frames count as frozen, s; 0 for never.
    pub frozen: f64,
    /// One entry a joint.
    pub joints: Vec<Entry>,
}

/// One joint; lists have one entry a coordinate, of a free joint one.
#[derive(Clone, Debug, Serialize)]
pub struct Entry {
    /// Name in the skeleton.
    pub joint: String,
    /// free, hinge, chain or ball.
    pub kind: &'static str,
    /// Robot joints of the coordinates, where they are known.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub urdf: Vec<String>,
    /// Local rotation `[i, j, k, w]` at which the coordinates are zero.
    pub neutral: Vec<f64>,
    /// Axes, in the frame that `neutral` turns.
    pub axes: Vec<[f64; 3]>,
    /// Least coordinates, rad.
    pub lower: Vec<f64>,
    /// Greatest coordinates, rad.
    pub upper: Vec<f64>,
    /// Coordinates at rest, rad.
    pub rest: Vec<f64>,
    /// Largest speeds, rad/s.
    pub velocity: Vec<f64>,
    /// Largest accelerations, rad/s^2.
    pub acceleration: Vec<f64>,
}

impl Table {
    /// The table of a model whose joints have these names; `urdf` may be empty.
    pub fn new(model: &LimitsModel, joints: &[String], urdf: &[Vec<String>]) -> Self {
        let rows = model.joints.iter().zip(joints).enumerate();
        let meta = &model.meta;
        Self {
            name: model.name.clone(),
            frame_rate: model.frame_rate,
            root_velocity: plain(meta.root_velocity),
            root_acceleration: plain(meta.root_acceleration),
            hold: plain(meta.hold),
            decay: plain(meta.decay),
            frozen: plain(meta.frozen),
            joints: rows.map(|(at, (limit, name))| entry(limit, name, urdf.get(at).cloned())).collect(),
        }
    }

    /// A line a coordinate.
    pub fn csv(&self) -> String {
        let mut text =
            "joint,kind,coordinate,urdf,axis_x,axis_y,axis_z,neutral_i,neutral_j,neutral_k,neutral_w,lower,upper,rest,\
                        velocity,acceleration\n"
                .to_owned();
        for joint in &self.joints {
            for (at, velocity) in joint.velocity.iter().enumerate() {
                let cell = |list: &[f64]| list.get(at).map_or(String::new(), f64::to_string);
                let axis = joint.axes.get(at).map_or(",,".to_owned(), |[x, y, z]| format!("{x},{y},{z}"));
                let neutral = joint.neutral.iter().map(f64::to_string).collect::<Vec<_>>().join(",");
                text += &[
                    quoted(&joint.joint),
                    joint.kind.to_owned(),
                    at.to_string(),
                    quoted(joint.urdf.get(at).map_or("", |name| name)),
                    axis,
                    neutral,
                    cell(&joint.lower),
                    cell(&joint.upper),
                    cell(&joint.rest),
                    velocity.to_string(),
                    cell(&joint.acceleration),
                ]
                .join(",");
                text.push('\n');
            }
        }
        text
    }
}

/// A name as a field of a CSV table.
fn quoted(name: &str) -> String {
    if name.contains([',', '"', '\n', '\r']) { format!("\"{}\"", name.replace('"', "\"\"")) } else { name.to_owned() }
}

/// The double that prints as the single does.
fn plain(x: f32) -> f64 {
    x.to_string().parse().unwrap_or(f64::from(x))
}

fn entry(limit: &JointLimit, name: &str, urdf: Option<Vec<String>>) -> Entry {
    let count =
        if limit.kind == JointKind::Free { 0 } else { limit.axes.iter().take_while(|axis| **axis != [0.0; 3]).count() };
    let list = |values: &[f32; 3], count: usize| values.iter().take(count).map(|x| plain(*x)).collect::<Vec<_>>();
    Entry {
        joint: name.to_owned(),
        kind: kind_name(limit.kind),
        urdf: urdf.unwrap_or_default(),
        neutral: limit.neutral.iter().map(|x| plain(*x)).collect(),
        axes: limit.axes.iter().take(count).map(|axis| axis.map(plain)).collect(),
        lower: list(&limit.lower, count),
        upper: list(&limit.upper, count),
        rest: list(&limit.rest, count),
        velocity: list(&limit.velocity, count.max(1)),
        acceleration: list(&limit.acceleration, count.max(1)),
    }
}
