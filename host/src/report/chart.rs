//! Curves, drawn by `plotters` as SVG.

use plotters::prelude::*;

/// Width and height, pixels.
const SIZE: (u32, u32) = (760, 300);
/// Dark enough on white, apart for colour-blind eyes (Okabe and Ito).
const COLOURS: [RGBColor; 5] =
    [RGBColor(0, 114, 178), RGBColor(213, 94, 0), RGBColor(0, 158, 115), RGBColor(204, 121, 167), RGBColor(86, 86, 86)];

/// One curve.
#[derive(Clone, Debug)]
pub struct Line {
    /// Name in the legend.
    pub name: String,
    /// Points, left to right.
    pub points: Vec<(f64, f64)>,
}

impl Line {
    /// Values over 0, 1, 2, ...
    pub fn of(name: &str, values: &[f64]) -> Self {
        Self { name: name.to_owned(), points: values.iter().enumerate().map(|(x, y)| (x as f64, *y)).collect() }
    }
}

/// Curves over one axis.
#[derive(Clone, Debug)]
pub struct Chart {
    /// What is seen, and in which unit.
    pub caption: String,
    /// Name of the horizontal axis.
    pub x: &'static str,
    /// Name of the vertical axis.
    pub y: &'static str,
    /// The curves, at most five.
    pub lines: Vec<Line>,
}

impl Chart {
    /// The drawing; a note in its place where there is nothing to draw. The vertical axis is logarithmic where all values are
    /// positive and span more than a factor of 20.
    pub fn svg(&self) -> String {
        let points = self.lines.iter().flat_map(|line| &line.points).filter(|(x, y)| x.is_finite() && y.is_finite());
        let bounds = points.fold([f64::INFINITY, f64::NEG_INFINITY, f64::INFINITY, f64::NEG_INFINITY], |b, (x, y)| {
            [b[0].min(*x), b[1].max(*x), b[2].min(*y), b[3].max(*y)]
        });
        let mut svg = String::new();
        let drawn = bounds[0] < bounds[1] && self.draw(&mut svg, bounds).is_ok();
        if drawn { svg } else { "<em>nothing to draw</em>".to_owned() }
    }

    fn draw(&self, svg: &mut String, [left, right, low, high]: [f64; 4]) -> Result<(), Box<dyn std::error::Error>> {
        let root = SVGBackend::with_string(svg, SIZE).into_drawing_area();
        root.fill(&WHITE)?;
        let mut builder = ChartBuilder::on(&root);
        builder.margin(12).x_label_area_size(38).y_label_area_size(64);
        // The two axes have different types, so that the drawing stands here twice.
        macro_rules! curves {
            ($chart:expr) => {{
                let mut chart = $chart;
                chart
                    .configure_mesh()
                    .x_desc(self.x)
                    .y_desc(self.y)
                    .x_label_formatter(&|x| short(*x))
                    .y_label_formatter(&|y| short(*y))
                    .max_light_lines(2)
                    .draw()?;
                for (line, colour) in self.lines.iter().zip(COLOURS) {
                    let points = line.points.iter().copied().filter(|(x, y)| x.is_finite() && y.is_finite());
                    chart
                        .draw_series(LineSeries::new(points, colour.stroke_width(2)))?
                        .label(line.name.as_str())
                        .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], colour.stroke_width(2)));
                }
                if self.lines.len() > 1 {
                    chart
                        .configure_series_labels()
                        .background_style(WHITE.mix(0.8))
                        .border_style(BLACK.mix(0.2))
                        .draw()?;
                }
            }};
        }
        if low > 0.0 && high > 20.0 * low {
            curves!(builder.build_cartesian_2d(left..right, (low..high).log_scale())?);
        } else {
            let margin = (0.05 * (high - low)).max(1e-9 * high.abs()).max(1e-12);
            curves!(builder.build_cartesian_2d(left..right, low - margin..high + margin)?);
        }
        root.present()?;
        Ok(())
    }
}

/// At most four significant digits, without trailing zeros.
fn short(value: f64) -> String {
    let digits = if value == 0.0 { 0 } else { (3 - value.abs().log10().floor() as i32).clamp(0, 12) as usize };
    let text = format!("{value:.digits$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chart(points: Vec<(f64, f64)>) -> Chart {
        let line = |name: &str, points: &[(f64, f64)]| Line { name: name.to_owned(), points: points.to_vec() };
        Chart { caption: "c".into(), x: "epoch", y: "error", lines: vec![line("one", &points), line("two", &points)] }
    }

    #[test]
    fn curves_are_drawn_with_their_names() {
        for points in [
            vec![(0.0, 1.0), (1.0, 0.5), (2.0, f64::NAN)],
            vec![(1.0, 100.0), (2.0, 0.01)],
            vec![(0.0, 3.0), (1.0, 3.0)],
        ] {
            let svg = chart(points).svg();
            assert!(svg.contains("<svg") && svg.contains("polyline") && svg.contains("epoch") && svg.contains("two"));
            assert!(!svg.contains("NaN"));
        }
    }

    #[test]
    fn labels_are_short() {
        let labels = [0.0, 0.400_000_000_01, 1e-5, 1234.5, -20.0, 0.29].map(short);
        assert_eq!(labels, ["0", "0.4", "0.00001", "1234", "-20", "0.29"]);
    }

    #[test]
    fn nothing_to_draw_is_said() {
        assert_eq!(chart(vec![]).svg(), "<em>nothing to draw</em>");
        assert_eq!(chart(vec![(1.0, 1.0)]).svg(), "<em>nothing to draw</em>");
    }
}
