//! Lines, discs and texts on white paper, in pixels from the top left corner.

use std::fmt::Write as _;

/// Red, green, blue.
pub(super) type Colour = [u8; 3];

/// The colours of all drawings. Blue and orange differ for every kind of sight.
pub(super) const LEFT: Colour = [0x00, 0x72, 0xb2];
pub(super) const RIGHT: Colour = [0xd5, 0x5e, 0x00];
pub(super) const MIDDLE: Colour = [0x44, 0x44, 0x44];
pub(super) const GROUND: Colour = [0xcc, 0xcc, 0xcc];
pub(super) const TEXT: Colour = [0x55, 0x55, 0x55];

/// One thing that is drawn.
#[derive(Clone, Debug)]
pub(super) enum Mark {
    /// A line with round ends.
    Line {
        from: [f64; 2],
        to: [f64; 2],
        width: f64,
        colour: Colour,
    },
    Disc {
        middle: [f64; 2],
        radius: f64,
        colour: Colour,
    },
    /// A text that begins at a point of its base line.
    Text {
        at: [f64; 2],
        /// Height of a capital.
        height: f64,
        colour: Colour,
        text: String,
    },
}

/// A picture before it is one.
#[derive(Clone, Debug)]
pub struct Drawing {
    /// Pixels.
    pub width: u32,
    /// Pixels.
    pub height: u32,
    pub(super) marks: Vec<Mark>,
}

impl Drawing {
    /// The drawing as SVG.
    pub fn svg(&self) -> String {
        let (width, height) = (self.width, self.height);
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" role=\"img\">\n\
             <rect width=\"{width}\" height=\"{height}\" fill=\"#fff\"/>\n"
        );
        for mark in &self.marks {
            // Writing to a string has no way to fail.
            let _ = match mark {
                Mark::Line { from, to, width, colour } => writeln!(
                    svg,
                    "<path d=\"M{:.1} {:.1}L{:.1} {:.1}\" stroke=\"{}\" stroke-width=\"{width:.1}\" stroke-linecap=\"round\"/>",
                    from[0],
                    from[1],
                    to[0],
                    to[1],
                    hex(*colour)
                ),
                Mark::Disc { middle, radius, colour } => writeln!(
                    svg,
                    "<circle cx=\"{:.1}\" cy=\"{:.1}\" r=\"{radius:.1}\" fill=\"{}\"/>",
                    middle[0],
                    middle[1],
                    hex(*colour)
                ),
                Mark::Text { at, height, colour, text } => writeln!(
                    svg,
                    "<text x=\"{:.1}\" y=\"{:.1}\" font-size=\"{:.0}\" font-family=\"sans-serif\" fill=\"{}\">{}</text>",
                    at[0],
                    at[1],
                    height / 0.7,
                    hex(*colour),
                    escaped(text)
                ),
            };
        }
        svg.push_str("</svg>\n");
        svg
    }
}

fn hex([r, g, b]: Colour) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// Text of others in XML: characters that XML has no place for are left out.
fn escaped(text: &str) -> String {
    let plain = text.chars().filter(|c| !c.is_control()).collect::<String>();
    plain.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_files_cannot_break_the_picture() {
        let text = "a < b & \u{1b}[2J".to_owned();
        let mark = Mark::Text { at: [1.0, 2.0], height: 8.0, colour: TEXT, text };
        let svg = Drawing { width: 10, height: 10, marks: vec![mark] }.svg();
        assert!(svg.contains("a &lt; b &amp; [2J</text>") && svg.contains("#555555"), "{svg}");
        assert!(roxmltree::Document::parse(&svg).is_ok());
    }
}
