//! A machine on a page: its links, and the solids that are drawn of them.

use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use nalgebra::Isometry3;
use serde::Serialize;

use crate::robot::Machine;
use crate::robot::look::{Look, Solid, Way};

/// What the scripts read of a machine. Lengths are in m, angles in rad, quaternions `x y z w`.
#[derive(Serialize)]
pub(super) struct MachineData {
    /// Numbers of a frame.
    coordinates: usize,
    /// Of each joint of the pack: its link, and its coordinate if it moves.
    joints: Vec<JointData>,
    links: Vec<LinkData>,
}

#[derive(Serialize)]
struct JointData {
    link: usize,
    coordinate: Option<usize>,
    slides: bool,
}

#[derive(Serialize)]
struct LinkData {
    parent: Option<usize>,
    at: [f64; 7],
    way: &'static str,
    axis: [f64; 3],
    /// Coordinate, multiplier, offset.
    drive: Option<(usize, f64, f64)>,
    solids: Vec<SolidData>,
}

#[derive(Serialize)]
struct SolidData {
    /// f32, three a vertex.
    vertices: String,
    /// u16, three a triangle.
    triangles: String,
    colour: Option<[f64; 3]>,
    /// Its triangles are turned outside, and those seen from behind are hidden.
    closed: bool,
}

impl MachineData {
    pub fn new(machine: &Machine, look: &Look) -> Self {
        let places = machine.rig.frames().places();
        let joint = |((kind, first), link): ((kinesic::rig::JointKind, usize), &usize)| JointData {
            link: *link,
            coordinate: (kind.coordinates() > 0).then_some(first),
            slides: kind == kinesic::rig::JointKind::Slider,
        };
        Self {
            coordinates: machine.rig.frames().coordinates(),
            joints: places.zip(&look.joints).map(joint).collect(),
            links: look.links.iter().map(link).collect(),
        }
    }
}

impl MachineData {
    /// The first joint that moves.
    pub fn first_moving(&self) -> Option<usize> {
        self.joints.iter().position(|joint| joint.coordinate.is_some())
    }
}

fn link(link: &crate::robot::look::Link) -> LinkData {
    LinkData {
        parent: link.parent,
        at: seven(&link.at),
        way: match link.way {
            Way::Fixed => "fixed",
            Way::Turns => "turns",
            Way::Slides => "slides",
        },
        axis: link.axis.into(),
        drive: link.drive.map(|drive| (drive.coordinate, drive.multiplier, drive.offset)),
        solids: link.solids.iter().filter(|solid| !solid.triangles.is_empty()).map(solid).collect(),
    }
}

fn seven(at: &Isometry3<f64>) -> [f64; 7] {
    let ([x, y, z], [i, j, k, w]) = (at.translation.vector.into(), at.rotation.coords.into());
    [x, y, z, i, j, k, w]
}

fn solid(solid: &Solid) -> SolidData {
    let vertices: Vec<f32> = solid.vertices.iter().flat_map(|vertex| vertex.iter().map(|x| *x as f32)).collect();
    // A look has few triangles.
    let triangles: Vec<u16> = solid.triangles.as_flattened().iter().map(|at| *at as u16).collect();
    SolidData {
        vertices: BASE64_STANDARD.encode(bytemuck::cast_slice(&vertices)),
        triangles: BASE64_STANDARD.encode(bytemuck::cast_slice(&triangles)),
        colour: solid.colour,
        closed: solid.is_closed(),
    }
}
