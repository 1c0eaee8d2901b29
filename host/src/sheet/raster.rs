//! A drawing as pixels, with smooth edges.

use image::{Rgb, RgbImage};

use super::drawing::{Colour, Drawing, Mark};
use super::glyphs;

/// Width of the lines of letters, pixels.
const PEN: f64 = 1.15;

/// The pixels.
pub(super) fn render(drawing: &Drawing) -> RgbImage {
    let mut image = RgbImage::from_pixel(drawing.width, drawing.height, Rgb([255; 3]));
    for mark in &drawing.marks {
        match mark {
            Mark::Line { from, to, width, colour } => line(&mut image, *from, *to, *width, *colour),
            Mark::Disc { middle, radius, colour } => line(&mut image, *middle, *middle, 2.0 * radius, *colour),
            Mark::Text { at, height, colour, text } => write(&mut image, *at, *height, *colour, text),
        }
    }
    image
}

fn write(image: &mut RgbImage, at: [f64; 2], height: f64, colour: Colour, text: &str) {
    let size = height / glyphs::CAPITAL;
    for (index, letter) in text.chars().filter(|c| !c.is_control()).enumerate() {
        let start = at[0] + size * glyphs::ADVANCE * index as f64;
        for ends in glyphs::lines(letter) {
            let [from, to] = ends.map(|[x, y]| [start + size * x, at[1] - size * y]);
            line(image, from, to, PEN, colour);
        }
    }
}

/// A line with round ends. A pixel is covered by how far its middle is inside the edge.
fn line(image: &mut RgbImage, from: [f64; 2], to: [f64; 2], width: f64, colour: Colour) {
    let reach = 0.5 * width + 0.5;
    let range = |axis: usize, most: u32| {
        let (low, high) = (from[axis].min(to[axis]) - reach, from[axis].max(to[axis]) + reach);
        (low.floor().max(0.0) as u32)..(high.ceil().clamp(0.0, f64::from(most)) as u32)
    };
    let way = [to[0] - from[0], to[1] - from[1]];
    let length = way[0] * way[0] + way[1] * way[1];
    for y in range(1, image.height()) {
        for x in range(0, image.width()) {
            let point = [f64::from(x) + 0.5 - from[0], f64::from(y) + 0.5 - from[1]];
            let along = if length > 0.0 { (point[0] * way[0] + point[1] * way[1]) / length } else { 0.0 };
            let along = along.clamp(0.0, 1.0);
            let distance = (point[0] - along * way[0]).hypot(point[1] - along * way[1]);
            let covered = (reach - distance).clamp(0.0, 1.0);
            if covered > 0.0 {
                let pixel = image.get_pixel_mut(x, y);
                for (under, over) in pixel.0.iter_mut().zip(colour) {
                    *under = (f64::from(*under) + covered * (f64::from(over) - f64::from(*under))).round() as u8;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::drawing::TEXT;
    use super::*;

    #[test]
    fn lines_end_where_they_should_and_nothing_is_drawn_beside_the_paper() {
        let line = |from, to| Mark::Line { from, to, width: 2.0, colour: [0, 0, 0] };
        let far = line([-1e7, 5.0], [1e7, 5.0]);
        let lost = line([f64::NAN, 0.0], [3.0, f64::INFINITY]);
        let short = line([4.0, 14.0], [8.0, 14.0]);
        let text = Mark::Text { at: [2.0, 30.0], height: 8.0, colour: TEXT, text: "Walk\u{1b}ö".to_owned() };
        let image = render(&Drawing { width: 20, height: 40, marks: vec![far, lost, short, text] });
        let dark = |x: u32, y: u32| image.get_pixel(x, y).0[0] < 128;
        assert!(dark(0, 5) && dark(19, 5) && !dark(0, 8));
        assert!(dark(5, 14) && !dark(1, 14) && !dark(11, 14) && !dark(5, 17));
        assert!((22..30).any(|y| dark(2, y)));
    }
}
