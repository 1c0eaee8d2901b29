//! Stick figures: one row a clip, the same moments side by side, seen obliquely from the front.

use std::fmt::Write as _;

use nalgebra::{UnitQuaternion, Vector3};

use crate::clip::{Canonical, Clip, JointMap};

/// Width of a figure's cell, pixels.
const CELL: f64 = 92.0;
/// Pixels per metre.
const SCALE: f64 = 62.0;
/// Figures in a row.
const COLUMNS: usize = 8;

/// An SVG drawing of clips, with their names. Left limbs are blue, right ones orange; every figure stands in the middle of its
/// cell on the line of the ground.
pub fn stick_figures(rows: &[(&str, &Clip)]) -> String {
    let heights: Vec<f64> = rows.iter().map(|(_, clip)| 40.0 + SCALE * tallest(clip)).collect();
    let (width, height) = (CELL * COLUMNS as f64, heights.iter().sum::<f64>());
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height:.0}\" viewBox=\"0 0 {width} {height:.0}\" role=\"img\">\n"
    );
    let mut bottom = 0.0;
    for ((name, clip), height) in rows.iter().zip(heights) {
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
        for column in 0..COLUMNS {
            let frame = column * clip.frames().saturating_sub(1) / (COLUMNS - 1);
            figure(&mut svg, clip, frame, CELL * (column as f64 + 0.5), ground);
        }
    }
    svg.push_str("</svg>\n");
    svg
}

/// Highest joint over the ground in any frame that is drawn, m.
fn tallest(clip: &Clip) -> f64 {
    let frames = (0..COLUMNS).map(|column| column * clip.frames().saturating_sub(1) / (COLUMNS - 1));
    frames.flat_map(|frame| clip.positions(frame)).map(|p| p.y).fold(1.0, f64::max).min(3.0)
}

fn figure(svg: &mut String, clip: &Clip, frame: usize, x: f64, ground: f64) {
    let view = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), 0.6);
    let positions = clip.positions(frame);
    let Some(root) = clip.root.get(frame) else { return };
    let map = JointMap::detect(&clip.skeleton);
    let at = |p: &Vector3<f64>| {
        let local = view * (p - Vector3::new(root.x, 0.0, root.z));
        (x + SCALE * local.x, ground - SCALE * (local.y + 0.15 * local.z))
    };
    for (joint, meta) in clip.skeleton.joints.iter().enumerate() {
        let side = map.as_ref().and_then(|m| m.canonical(joint)).map(Canonical::name).unwrap_or_default();
        let colour = match side.get(..2) {
            Some("l_") => "#0072b2",
            Some("r_") => "#d55e00",
            _ => "#444",
        };
        if let Some(((x1, y1), (x2, y2))) = meta.parent.map(|parent| (at(&positions[parent]), at(&positions[joint]))) {
            let _ = writeln!(
                svg,
                "<path d=\"M{x1:.1} {y1:.1}L{x2:.1} {y2:.1}\" stroke=\"{colour}\" stroke-width=\"2\" stroke-linecap=\"round\"/>"
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::gait::{Manner, walk};

    #[test]
    fn every_bone_is_drawn() {
        let clip = walk(&Manner::NEUTRAL, 1.0, 30.0, 0.0, 1);
        let svg = super::stick_figures(&[("a < b", &clip), ("again", &clip)]);
        assert_eq!(svg.matches("stroke-linecap").count(), 2 * super::COLUMNS * (clip.skeleton.len() - 1));
        assert!(svg.contains("a &lt; b") && svg.contains("#0072b2") && svg.contains("#d55e00"));
    }
}
