//! Faces from the landmarks that move: one a cell.

use std::fmt::Write as _;

use kinesic::face::{INNER, Shape};

/// Side of a face's cell, pixels.
const CELL: f64 = 230.0;
/// Pixels of a face's unit.
const SCALE: f64 = 62.0;
/// First landmark, number, and whether the stroke closes: brows, nose, eyes, outer and inner lips (no shape holds the inner corners).
const STROKES: [(u8, u8, bool); 9] = [
    (17, 5, false),
    (22, 5, false),
    (27, 4, false),
    (31, 5, false),
    (36, 6, true),
    (42, 6, true),
    (48, 12, true),
    (61, 3, false),
    (65, 3, false),
];

/// An SVG drawing of faces, with their names.
pub fn faces(shapes: &[(String, Shape)]) -> String {
    let width = CELL * shapes.len() as f64;
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{CELL}\" viewBox=\"0 0 {width} {CELL}\" role=\"img\">\n"
    );
    for (column, (name, shape)) in shapes.iter().enumerate() {
        let left = CELL * column as f64;
        // Writing to a string has no way to fail.
        let _ = writeln!(
            svg,
            "<text x=\"{:.0}\" y=\"16\" font-size=\"12\" font-family=\"sans-serif\" fill=\"#555\" text-anchor=\"middle\">{}</text>",
            left + CELL / 2.0,
            name.replace('&', "&amp;").replace('<', "&lt;")
        );
        for (first, count, closed) in STROKES {
            let at = |landmark: u8| INNER.iter().zip(shape).find(|(l, _)| **l == landmark).map(|(_, at)| at);
            let points = (first..first + count).filter_map(at).map(|[x, y]| {
                format!("{:.1},{:.1}", left + CELL / 2.0 + SCALE * f64::from(*x), CELL / 2.0 + SCALE * f64::from(*y))
            });
            let kind = if closed { "polygon" } else { "polyline" };
            let points = points.collect::<Vec<_>>().join(" ");
            let _ = writeln!(
                svg,
                "<{kind} points=\"{points}\" fill=\"none\" stroke=\"#0072b2\" stroke-width=\"2.5\" stroke-linejoin=\"round\"/>"
            );
        }
    }
    svg.push_str("</svg>\n");
    svg
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_moving_landmark_is_in_a_stroke() {
        let drawn: Vec<u8> = STROKES.iter().flat_map(|(first, count, _)| *first..first + count).collect();
        assert!(INNER.iter().all(|landmark| drawn.contains(landmark)));
        let svg = faces(&[("a < b".to_owned(), [[0.0; 2]; INNER.len()])]);
        assert_eq!(svg.matches("points=").count(), STROKES.len());
        assert!(svg.contains("a &lt; b"));
    }
}
