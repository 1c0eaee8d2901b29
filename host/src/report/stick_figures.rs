//! Figures of lines: one row a clip, the same moments side by side, seen obliquely from the front.

use std::fmt::Write as _;

use nalgebra::{UnitQuaternion, Vector3};

use crate::clip::{Canonical, Clip, JointMap};
use crate::robot::look::Look;

/// Width of a figure's cell, pixels.
const CELL: f64 = 92.0;
/// Pixels per metre of a person.
const SCALE: f64 = 62.0;
/// Width of a robot, pixels; its height may be twice that.
const ROBOT: f64 = 64.0;
/// Figures in a row.
const COLUMNS: usize = 8;

const LEFT: &str = "#0072b2";
const RIGHT: &str = "#d55e00";
const MIDDLE: &str = "#444";

/// A line of a figure that stands at the origin: ends, m, and colour.
type Stroke = (Vector3<f64>, Vector3<f64>, &'static str);

/// An SVG drawing of people's clips, with their names. Left limbs are blue, right ones orange; every figure stands in the middle of its
/// cell on the line of the ground.
pub fn stick_figures(rows: &[(&str, &Clip)]) -> String {
    let row = |(name, clip): &(&str, &Clip)| {
        let strokes: Vec<_> = moments(clip).map(|frame| body(clip, frame)).collect();
        let tallest = strokes.iter().flatten().map(|(_, to, _)| to.y).fold(1.0, f64::max).min(3.0);
        (name.to_string(), strokes, tallest)
    };
    drawing(&rows.iter().map(row).collect::<Vec<_>>(), SCALE)
}

/// The same of a robot's clips, large enough to see.
pub fn robot_figures(look: &Look, rows: &[(&str, &Clip)]) -> String {
    let row = |(name, clip): &(&str, &Clip)| {
        let strokes: Vec<_> =
            moments(clip).map(|frame| machine(look, clip.coordinates(frame).unwrap_or(&[]))).collect();
        (name.to_string(), strokes)
    };
    let rows: Vec<_> = rows.iter().map(row).collect();
    let ends = || rows.iter().flat_map(|(_, strokes)| strokes.iter().flatten()).flat_map(|(from, to, _)| [from, to]);
    let height = ends().map(|end| end.y).fold(0.01, f64::max);
    let reach = ends().map(|end| end.x.hypot(end.z)).fold(0.01, f64::max);
    let scale = (ROBOT / 2.0 / reach).min(2.0 * ROBOT / height);
    drawing(&rows.into_iter().map(|(name, strokes)| (name, strokes, height)).collect::<Vec<_>>(), scale)
}

/// Rows: name, figures, height of the tallest, m.
fn drawing(rows: &[(String, Vec<Vec<Stroke>>, f64)], scale: f64) -> String {
    let heights: Vec<f64> = rows.iter().map(|(_, _, tallest)| 40.0 + scale * tallest).collect();
    let (width, height) = (CELL * COLUMNS as f64, heights.iter().sum::<f64>());
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height:.0}\" viewBox=\"0 0 {width} {height:.0}\" role=\"img\">\n"
    );
    let mut bottom = 0.0;
    for ((name, figures, _), height) in rows.iter().zip(heights) {
        let top = bottom;
        bottom += height;
        let ground = bottom - 12.0;
        // Writing to a string has no way to fail.
        let _ = writeln!(
            svg,
            "<text x=\"6\" y=\"{:.0}\" font-size=\"12\" font-family=\"sans-serif\" fill=\"#555\">{}</text>\n<path d=\"M6 {ground:.1}H{}\" stroke=\"#ddd\"/>",
            top + 14.0,
            name.replace('&', "&amp;").replace('<', "&lt;"),
            width - 6.0
        );
        for (column, strokes) in figures.iter().enumerate() {
            figure(&mut svg, strokes, CELL * (column as f64 + 0.5), ground, scale);
        }
    }
    svg.push_str("</svg>\n");
    svg
}

/// The frames that are drawn.
fn moments(clip: &Clip) -> impl Iterator<Item = usize> + '_ {
    (0..COLUMNS).map(|column| column * clip.frames().saturating_sub(1) / (COLUMNS - 1))
}

fn figure(svg: &mut String, strokes: &[Stroke], x: f64, ground: f64, scale: f64) {
    let view = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), 0.6);
    let at = |point: &Vector3<f64>| {
        let local = view * point;
        (x + scale * local.x, ground - scale * (local.y + 0.15 * local.z))
    };
    for (from, to, colour) in strokes {
        let ((x1, y1), (x2, y2)) = (at(from), at(to));
        let _ = writeln!(
            svg,
            "<path d=\"M{x1:.1} {y1:.1}L{x2:.1} {y2:.1}\" stroke=\"{colour}\" stroke-width=\"2\" stroke-linecap=\"round\"/>"
        );
    }
}

fn body(clip: &Clip, frame: usize) -> Vec<Stroke> {
    let positions = clip.positions(frame);
    let Some(root) = clip.root.get(frame) else { return Vec::new() };
    let map = JointMap::detect(&clip.skeleton);
    let at = |joint: usize| positions[joint] - Vector3::new(root.x, 0.0, root.z);
    let bone = |(joint, meta): (usize, &crate::clip::Joint)| {
        let side = map.as_ref().and_then(|m| m.canonical(joint)).map(Canonical::name).unwrap_or_default();
        let colour = match side.get(..2) {
            Some("l_") => LEFT,
            Some("r_") => RIGHT,
            _ => MIDDLE,
        };
        Some((at(meta.parent?), at(joint), colour))
    };
    clip.skeleton.joints.iter().enumerate().filter_map(bone).collect()
}

/// Joints, and the ends of the last ones.
fn machine(look: &Look, coordinates: &[f64]) -> Vec<Stroke> {
    look.sticks(coordinates).into_iter().map(|(from, to)| (from, to, MIDDLE)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gait::{Manner, walk};
    use crate::rig::frame_of;
    use crate::robot::{Defaults, Machine, ServoTable};

    #[test]
    fn every_bone_is_drawn() {
        let clip = walk(&Manner::NEUTRAL, 1.0, 30.0, 0.0, 1);
        let svg = stick_figures(&[("a < b", &clip), ("again", &clip)]);
        assert_eq!(svg.matches("stroke-linecap").count(), 2 * COLUMNS * (clip.skeleton.len() - 1));
        assert!(svg.contains("a &lt; b") && svg.contains("#0072b2") && svg.contains("#d55e00"));
    }

    #[test]
    fn a_small_robot_fills_its_cell_and_its_slider_slides() {
        let table = "[[servo]]\nname = \"lift\"\nunit = \"mm\"\nmin = 0\nmax = 80\n[[servo]]\nname = \"tilt\"\nparent = \"lift\"\nunit = \"deg\"\nmin = -90\nmax = 90\naxis = [0, 1, 0]\n";
        let machine = Machine::of_table(&ServoTable::parse(table).unwrap(), 50.0, Defaults::default()).unwrap();
        let frames: Vec<_> = (0..8).map(|at| frame_of(&[0.01 * f64::from(at), 0.1 * f64::from(at), 0.0])).collect();
        let clip = machine.rig.clip_of(&frames, 0.02);
        let look = Look::of_machine(&machine);
        let [low, high] = [0, 7].map(|at| look.sticks(clip.coordinates(at).unwrap())[1].0.y);
        assert!((high - low - 0.07).abs() < 1e-6, "{low} {high}");
        let svg = robot_figures(&look, &[("move", &clip)]);
        assert_eq!(svg.matches("stroke-linecap").count(), COLUMNS * look.sticks(&[]).len());
        let height: f64 = svg.split("height=\"").nth(1).unwrap().split('"').next().unwrap().parse().unwrap();
        assert!((80.0..=170.0).contains(&height), "{height}");
    }
}
