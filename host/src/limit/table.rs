//! A table of limits for people and other programs: JSON, TOML, CSV.

use serde::Serialize;

use super::onto_body::kind_name;
use super::{HeightLimit, JointLimit, LimitsModel, onto};
use crate::plain::quoted;

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
    /// Largest speed of the heading, rad/s.
    pub heading_velocity: f64,
    /// Largest acceleration of the heading, rad/s^2.
    pub heading_acceleration: f64,
    /// Height of the root.
    pub height: Height,
    /// Time for which the last sound frame is held, s.
    pub hold: f64,
    /// Time constant of the way to rest, s.
    pub decay: f64,
    /// One entry per joint.
    pub joints: Vec<Entry>,
}

/// The root's height, m, m/s, m/s^2.
#[derive(Clone, Copy, Debug, Serialize)]
#[expect(missing_docs, reason = "the fields of `HeightLimit`, which says what they are")]
pub struct Height {
    pub lower: f64,
    pub upper: f64,
    pub rest: f64,
    pub velocity: f64,
    pub acceleration: f64,
    #[serde(skip_serializing_if = "is_none")]
    pub jerk: f64,
}

/// One joint; lists have one entry per coordinate. A free joint has one speed, one acceleration and one jerk, for all three, and no bounds.
#[derive(Clone, Debug, Serialize)]
pub struct Entry {
    /// Name in the skeleton.
    pub joint: String,
    /// free, hinge, chain, ball, slider or fixed.
    pub kind: &'static str,
    /// Robot joints of the coordinates, where they are known.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub urdf: Vec<String>,
    /// Local rotation `[i, j, k, w]` at which the coordinates are zero.
    pub reference: Vec<f64>,
    /// Axes of hinges, in the frame that `reference` turns.
    pub axes: Vec<[f64; 3]>,
    /// Least coordinates, rad or m.
    pub lower: Vec<f64>,
    /// Greatest coordinates, rad or m.
    pub upper: Vec<f64>,
    /// Coordinates at rest, rad or m.
    pub rest: Vec<f64>,
    /// Largest speeds, rad/s or m/s.
    pub velocity: Vec<f64>,
    /// Largest accelerations, rad/s^2 or m/s^2.
    pub acceleration: Vec<f64>,
    /// Largest jerks, rad/s^3 or m/s^3, 0 for no limit; left out where the joint has none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub jerk: Vec<f64>,
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
            heading_velocity: plain(meta.heading_velocity),
            heading_acceleration: plain(meta.heading_acceleration),
            height: height(&model.height),
            hold: plain(meta.hold),
            decay: plain(meta.decay),
            joints: rows.map(|(at, (limit, name))| entry(limit, name, urdf.get(at).cloned())).collect(),
        }
    }

    /// A line per coordinate, of a free joint one.
    pub fn csv(&self) -> String {
        let mut text =
            "joint,kind,coordinate,urdf,axis_x,axis_y,axis_z,reference_i,reference_j,reference_k,reference_w,lower,upper,rest,\
                        velocity,acceleration,jerk\n"
                .to_owned();
        for joint in &self.joints {
            for (at, velocity) in joint.velocity.iter().enumerate() {
                let cell = |list: &[f64]| list.get(at).map_or(String::new(), f64::to_string);
                let axis = joint.axes.get(at).map_or(",,".to_owned(), |[x, y, z]| format!("{x},{y},{z}"));
                let reference = joint.reference.iter().map(f64::to_string).collect::<Vec<_>>().join(",");
                text += &[
                    quoted(&joint.joint),
                    joint.kind.to_owned(),
                    at.to_string(),
                    quoted(joint.urdf.get(at).map_or("", |name| name)),
                    axis,
                    reference,
                    cell(&joint.lower),
                    cell(&joint.upper),
                    cell(&joint.rest),
                    velocity.to_string(),
                    cell(&joint.acceleration),
                    cell(&joint.jerk),
                ]
                .join(",");
                text.push('\n');
            }
        }
        text
    }
}

fn is_none(jerk: &f64) -> bool {
    *jerk == 0.0
}

/// The double that prints as the single does.
fn plain(x: f32) -> f64 {
    x.to_string().parse().unwrap_or(f64::from(x))
}

fn height(limit: &HeightLimit) -> Height {
    Height {
        lower: plain(limit.lower),
        upper: plain(limit.upper),
        rest: plain(limit.rest),
        velocity: plain(limit.velocity),
        acceleration: plain(limit.acceleration),
        jerk: plain(limit.jerk),
    }
}

fn entry(limit: &JointLimit, name: &str, urdf: Option<Vec<String>>) -> Entry {
    let own = &limit.coordinates;
    let free = limit.is_free();
    let (bounds, rates) = if free { (0, 1) } else { (limit.count(), limit.count()) };
    let list = |values: &[f32; 3], count: usize| values.iter().take(count).map(|x| plain(*x)).collect::<Vec<_>>();
    Entry {
        joint: name.to_owned(),
        kind: if free { "free" } else { kind_name(own.kind) },
        urdf: urdf.unwrap_or_default(),
        reference: own.reference.iter().map(|x| plain(*x)).collect(),
        axes: own.axes.iter().take(onto::axes(own.kind)).map(|axis| axis.map(plain)).collect(),
        lower: list(&limit.lower, bounds),
        upper: list(&limit.upper, bounds),
        rest: list(&limit.rest, bounds),
        velocity: list(&limit.velocity, rates),
        acceleration: list(&limit.acceleration, rates),
        jerk: if limit.jerk == [0.0; 3] { Vec::new() } else { list(&limit.jerk, rates) },
    }
}
