//! What is drawn of a machine: its links, how coordinates move them, and the solids that they consist of.
//!
//! | file | holds |
//! |---|---|
//! | `mod` | [`Look`]: links in a tree, forward kinematics |
//! | `plain` | the links of a pack alone: a bone between joints, a cylinder about every axis |
//! | `described` | the links of a description: its shapes, followers and what stands still among them |
//! | `solid` | triangles |
//! | `mesh` | triangles from files |

mod described;
mod mesh;
mod plain;
mod solid;

use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};

pub use described::{Drives, TRIANGLES};
pub use solid::Solid;

/// Links, each after the one that carries it. Link 0 is the base; the world is Y up, in m.
#[derive(Clone, Debug, PartialEq)]
pub struct Look {
    /// All links.
    pub links: Vec<Link>,
    /// The link that shows each joint of the machine's rig.
    pub joints: Vec<usize>,
    /// What could not be drawn, one sentence each.
    pub notes: Vec<String>,
}

/// One link.
#[derive(Clone, Debug, PartialEq)]
pub struct Link {
    /// The link that carries it; none for the base.
    pub parent: Option<usize>,
    /// Its frame in that link's where its value is 0.
    pub at: Isometry3<f64>,
    /// How its value moves it.
    pub way: Way,
    /// Axis in its frame, length one.
    pub axis: Vector3<f64>,
    /// Where its value comes from; 0 without.
    pub drive: Option<Drive>,
    /// In its frame.
    pub solids: Vec<Solid>,
    /// Its end, in its frame, where nothing hangs on it and it is known.
    pub tip: Option<Vector3<f64>>,
}

/// How a link moves against the one that carries it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    /// Not at all.
    Fixed,
    /// About its axis, rad.
    Turns,
    /// Along its axis, m.
    Slides,
}

/// A link's value: `multiplier x + offset`, with the coordinate `x`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drive {
    /// Index of the machine's coordinate.
    pub coordinate: usize,
    /// 1 for a joint of the machine itself.
    pub multiplier: f64,
    /// rad or m.
    pub offset: f64,
}

impl Look {
    /// The frame of every link, in the world. `coordinates` are the machine's, rad or m; a missing one is 0.
    pub fn placed(&self, coordinates: &[f64]) -> Vec<Isometry3<f64>> {
        let mut frames: Vec<Isometry3<f64>> = Vec::with_capacity(self.links.len());
        for link in &self.links {
            let value = link.drive.map_or(0.0, |drive| {
                drive.multiplier * coordinates.get(drive.coordinate).copied().unwrap_or(0.0) + drive.offset
            });
            let moved = match link.way {
                Way::Fixed => Isometry3::identity(),
                Way::Turns => Isometry3::rotation(link.axis * value),
                Way::Slides => Isometry3::from_parts((link.axis * value).into(), UnitQuaternion::identity()),
            };
            let own = link.at * moved;
            frames.push(link.parent.map_or(own, |parent| frames[parent] * own));
        }
        frames
    }

    /// Lines from every link to each that hangs on it, and to the tips of the last ones, m, in the world.
    pub fn sticks(&self, coordinates: &[f64]) -> Vec<(Vector3<f64>, Vector3<f64>)> {
        let frames = self.placed(coordinates);
        let place = |link: usize| frames[link].translation.vector;
        let links = self.links.iter().enumerate();
        let bones = links.clone().filter_map(|(at, link)| Some((place(link.parent?), place(at))));
        let tips = links.filter_map(|(at, link)| Some((place(at), (frames[at] * Point3::from(link.tip?)).coords)));
        bones.chain(tips).collect()
    }

    /// Least and greatest corner over all solids, or over all links if there is none, m, at these coordinates.
    pub fn extent(&self, coordinates: &[f64]) -> [Vector3<f64>; 2] {
        let frames = self.placed(coordinates);
        let all = self.links.iter().zip(&frames).flat_map(|(link, frame)| {
            let vertices = link.solids.iter().flat_map(|solid| &solid.vertices);
            vertices.map(move |vertex| (frame * Point3::from(*vertex)).coords)
        });
        let bare = self.links.iter().all(|link| link.solids.is_empty());
        let places = frames.iter().filter(|_| bare).map(|frame| frame.translation.vector);
        let [low, high] = [f64::INFINITY, f64::NEG_INFINITY].map(Vector3::repeat);
        all.chain(places).fold([low, high], |[low, high], vertex| [low.inf(&vertex), high.sup(&vertex)])
    }

    /// Turned to +Z, as people face, and put on the ground with the lowest point at coordinates 0. A robot's forward is X (REP 103).
    fn standing(mut self) -> Self {
        let turn = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), -std::f64::consts::FRAC_PI_2);
        if let Some(base) = self.links.first_mut() {
            base.at = turn * base.at;
        }
        let [low, _] = self.extent(&[]);
        // A world link may hold the robot somewhere else: where its first solid is, it stands.
        let first = self.links.iter().position(|link| !link.solids.is_empty());
        let under = first.map_or_else(Vector3::zeros, |link| self.placed(&[])[link].translation.vector);
        if let Some(base) = self.links.first_mut() {
            base.at.translation.vector -= Vector3::new(under.x, low.y, under.z);
        }
        self
    }
}
