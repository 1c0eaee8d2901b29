//! `<visual>` of links: how they look. What cannot be read is left out with a note: a robot moves without it.

use std::collections::HashMap;

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use roxmltree::Node;

use super::super::shape::{Form, Shape};
use super::{child, three};

type Colours<'a> = HashMap<&'a str, [f64; 3]>;

/// Shapes of all links, and what was left out.
pub(super) fn read(root: Node, line: &dyn Fn(Node) -> u32) -> (Vec<Shape>, Vec<String>) {
    let colours: Colours = root.descendants().filter(|node| node.has_tag_name("material")).filter_map(named).collect();
    let (mut shapes, mut notes) = (Vec::new(), Vec::new());
    for link in root.children().filter(|node| node.has_tag_name("link")) {
        let name = link.attribute("name").unwrap_or_default();
        for visual in link.children().filter(|node| node.has_tag_name("visual")) {
            match shape(visual, &colours) {
                Ok(shape) => shapes.push(Shape { link: name.to_owned(), ..shape }),
                Err(what) => notes.push(format!("line {}: {what}: this part of '{name}' is not drawn", line(visual))),
            }
        }
    }
    (shapes, notes)
}

/// The shape of a link yet without name.
fn shape(visual: Node, colours: &Colours) -> Result<Shape, String> {
    let at = match child(visual, "origin") {
        None => Isometry3::identity(),
        Some(origin) => {
            let [place, turn] = ["xyz", "rpy"].map(|name| three(origin, name));
            let (place, turn) = (place?.unwrap_or_default(), turn?.unwrap_or_default());
            let turn = UnitQuaternion::from_euler_angles(turn.x, turn.y, turn.z);
            Isometry3::from_parts(Translation3::from(place), turn)
        }
    };
    let geometry = child(visual, "geometry").and_then(|node| node.children().find(Node::is_element));
    let geometry = geometry.ok_or("<visual>: found no geometry, expected box, cylinder, sphere or mesh")?;
    let colour = child(visual, "material").and_then(|material| {
        let name = material.attribute("name").unwrap_or_default();
        own(material).or_else(|| colours.get(name).copied())
    });
    Ok(Shape { link: String::new(), at, form: form(geometry)?, colour })
}

fn form(geometry: Node) -> Result<Form, String> {
    let tag = geometry.tag_name().name();
    let length = |name| length(geometry, name);
    match tag {
        "box" => {
            let size = three(geometry, "size")?.filter(|size| size.iter().all(|x| *x > 0.0));
            size.map(Form::Cuboid).ok_or_else(|| "<box>: expected size=\"X Y Z\", three lengths over 0".to_owned())
        }
        "sphere" => Ok(Form::Ellipsoid(Vector3::repeat(length("radius")?))),
        "cylinder" => Ok(Form::Cylinder(length("radius")?, length("length")?)),
        // Not in the specification, and read by several programs.
        "capsule" => Ok(Form::Capsule(length("radius")?, length("length")?)),
        "mesh" => {
            let file = geometry.attribute("filename").filter(|name| !name.is_empty());
            let file = file.ok_or("<mesh>: found no filename, expected that of an STL, OBJ or COLLADA file")?;
            Ok(Form::Mesh(file.to_owned(), three(geometry, "scale")?.unwrap_or_else(|| Vector3::repeat(1.0))))
        }
        other => Err(format!("<{other}>: expected box, cylinder, sphere or mesh")),
    }
}

fn length(node: Node, name: &str) -> Result<f64, String> {
    let text = node.attribute(name).unwrap_or_default();
    let length = text.trim().parse().ok().filter(|x| (0.0..1e6).contains(x) && *x > 0.0);
    length.ok_or_else(|| format!("<{} {name}=\"{text}\">: expected a length over 0, as 0.05", node.tag_name().name()))
}

/// A material's name and colour.
fn named<'a>(material: Node<'a, '_>) -> Option<(&'a str, [f64; 3])> {
    Some((material.attribute("name").filter(|name| !name.is_empty())?, own(material)?))
}

fn own(material: Node) -> Option<[f64; 3]> {
    let rgba = child(material, "color")?.attribute("rgba")?;
    let all: Vec<f64> = rgba.split_whitespace().map(|x| x.parse().ok()).collect::<Option<_>>()?;
    let rgb = *all.first_chunk::<3>()?;
    rgb.iter().all(|x| (0.0..=1.0).contains(x)).then_some(rgb)
}
