//! Tables of what the eye sees first: feet, rhythm, jitter, posture.

use kinesic_host::quality::{Compared, Quality};
use kinesic_host::report::Table;

use super::figure::figure;

/// Heads of the columns.
const HEADS: [&str; 6] =
    ["foot slide, cm/s", "standing, %", "steps a minute", "jerk, m/s^3", "lean, degrees", "posture, degrees"];
/// What the last column is.
const POSTURE: &str = "mean pose to that of the target";

fn cells(quality: &Quality) -> [String; 5] {
    [
        figure(quality.foot_slide_cm_s, 1),
        figure(quality.standing_percent, 0),
        figure(quality.steps_a_minute, 0),
        figure(quality.jerk_m_s3, 1),
        quality.lean_degrees.map_or_else(|| "-".to_owned(), |lean| figure(lean, 1)),
    ]
}

/// Names of source, target and result.
pub type Names<'a> = [&'a str; 3];

/// Those of a translation.
pub const PAIR: Names = ["source", "target", "result"];

fn rows<'a>(compared: &Compared, [source, target, result]: Names<'a>) -> [(&'a str, [String; 6]); 3] {
    let row = |name, quality: &Quality, posture: Option<f64>| {
        let [slide, standing, steps, jerk, lean] = cells(quality);
        let posture = posture.map_or_else(|| "-".to_owned(), |posture| figure(posture, 1));
        (name, [slide, standing, steps, jerk, lean, posture])
    };
    [
        row(source, &compared.source, Some(compared.source_posture_degrees)),
        row(target, &compared.target, None),
        row(result, &compared.result, Some(compared.result_posture_degrees)),
    ]
}

fn line(name: &str, cells: &[String]) {
    let cell = |(cell, head): (&String, &str)| {
        let width = head.len() + 2;
        format!("{cell:>width$}")
    };
    let cells: String = cells.iter().zip(HEADS).map(cell).collect();
    println!("{name:<10}{cells}");
}

/// Prints the quality of motions, one a line.
pub fn print(rows: &[(&str, &Quality)]) {
    let heads = HEADS.map(str::to_owned);
    line("", &heads[..5]);
    rows.iter().for_each(|(name, quality)| line(name, &cells(quality)));
}

/// Prints what is compared; the caption says over what.
pub fn compared(compared: &Compared, names: Names, caption: &str) {
    println!("{caption}: feet as the engine makes them; posture: {POSTURE}");
    line("", &HEADS.map(str::to_owned));
    rows(compared, names).iter().for_each(|(name, cells)| line(name, cells));
}

/// The table of a report.
pub fn table(compared: &Compared, names: Names, caption: &str) -> Table {
    Table {
        caption: format!(
            "{caption}: a foot slides while it stands; jerk is of all joints; the trunk leans forward; posture is the angle from the {POSTURE}. \
             Feet are as the engine makes them; kinesic apply holds them where they stand"
        ),
        head: std::iter::once("motion").chain(HEADS).map(str::to_owned).collect(),
        rows: rows(compared, names)
            .into_iter()
            .map(|(name, cells)| std::iter::once(name.to_owned()).chain(cells).collect())
            .collect(),
    }
}
