//! The report of `kinesic train face`.

use kinesic_host::face::{Face, HostFace, Report, Trained, read_all};
use kinesic_host::pack::PackFile;
use kinesic_host::report::{Chart, Line, Report as Page, Table, faces};
use miette::IntoDiagnostic;

use crate::commands::figure::{figure, percent};

/// Bars of a histogram over the plausible strengths.
const BARS: usize = 30;

/// The page about a training.
pub fn page(
    trained: &Trained,
    training: &Report,
    held_out: Option<&Report>,
    file: &PackFile,
    training_faces: &[Face],
) -> miette::Result<Page> {
    let model = &trained.model;
    let mut page = Page::new(
        &format!("Strength of an expression: {}", model.attribute),
        "A ranking function for each cluster of head pose, and a network from strength to landmarks (Chan, Shum, Wang, Yi, Wei, \
         Ho 2019).",
    );
    let pack = file.pack().into_diagnostic()?;
    page.heading("What it does");
    let device = HostFace::load(&pack).into_diagnostic()?;
    let largest = trained.faces.iter().enumerate().max_by_key(|(_, count)| **count).map_or(0, |(index, _)| index);
    let [low, high] = model.strength;
    let shown = [("weakest", low), ("middle", low.midpoint(high)), ("strongest", high)];
    let shape = |(name, strength)| {
        Some((format!("{name}, {}", figure(f64::from(strength), 2)), device.shape(largest, strength)?))
    };
    page.figure(
        &faces(&shown.into_iter().filter_map(shape).collect::<Vec<_>>()),
        &format!(
            "The device's mean face of the largest cluster of head pose, from the weakest to the strongest plausible strength \
             (between which 98 % of the training faces lie). Strength is in units of the labels: 0 as faces labelled 0, 1 as faces labelled 1; \
             the training labels are {}.",
            labels(training_faces)
        ),
    );
    page.heading("How well it ranks");
    let row = |name: &str, report: &Report| {
        vec![
            name.to_owned(),
            report.faces.to_string(),
            report.pairs.to_string(),
            percent(report.pair_accuracy, 2),
            percent(report.pair_accuracy_within_clusters, 2),
            figure(report.spearman, 3),
        ]
    };
    page.table(&Table {
        caption: "Pairs of faces with different labels: how many of them the strength orders as the labels do (chance: 50 %), and the \
                  rank correlation of strength and label (1 is perfect; with two labels it cannot come near 1)"
            .into(),
        head: ["", "faces", "pairs", "right", "right, within clusters", "Spearman"].map(Into::into).to_vec(),
        rows: std::iter::once(row("trained on", training)).chain(held_out.map(|r| row("people held out", r))).collect(),
    });
    page.table(&Table {
        caption: "Clusters of head pose. Validation: pair accuracy on people that its ranking function had not seen; error: of a \
                  landmark of the network against the faces', in thousandths of the face's unit"
            .into(),
        head: ["cluster", "faces", "validation", "error"].map(Into::into).to_vec(),
        rows: (0..model.clusters.len())
            .map(|c| {
                let validation = percent(trained.validation[c], 2);
                vec![c.to_string(), trained.faces[c].to_string(), validation, format!("{:.0}", 1e3 * trained.error[c])]
            })
            .collect(),
    });
    let read = read_all(&pack, training_faces).into_diagnostic()?;
    let middle = 0.5 * f64::from(model.strength[0] + model.strength[1]);
    let of = |upper: bool| {
        let chosen = read.iter().filter(move |read| read.face.label.is_some_and(|label| (label > middle) == upper));
        chosen.map(|read| read.reading.strength).collect::<Vec<f32>>()
    };
    page.chart(&Chart {
        caption: format!(
            "Strengths of the training faces, {} of them, by label: weakly is at most {middle:.2}, the middle of the plausible strengths.",
            training_faces.len()
        ),
        x: "strength",
        y: "faces",
        lines: vec![
            histogram("weakly labelled", &of(false), model.strength),
            histogram("strongly labelled", &of(true), model.strength),
        ],
    });
    for note in &trained.notes {
        page.text(&format!("Note: {note}."));
    }
    Ok(page)
}

/// The labels that there are, or their range.
fn labels(faces: &[Face]) -> String {
    let mut labels: Vec<f64> = faces.iter().filter_map(|face| face.label).collect();
    labels.sort_by(f64::total_cmp);
    let (first, last) = (labels.first().copied().unwrap_or_default(), labels.last().copied().unwrap_or_default());
    labels.dedup();
    match labels.len() {
        2 => format!("{first} and {last}"),
        _ => format!("{first} to {last}"),
    }
}

fn histogram(name: &str, values: &[f32], [low, high]: [f32; 2]) -> Line {
    let width = (high - low) / BARS as f32;
    let bar = |bar: usize| {
        let (from, to) = (low + width * bar as f32, low + width * (bar + 1) as f32);
        let count = values.iter().filter(|x| (from..to).contains(*x)).count();
        (f64::from(0.5 * (from + to)), count as f64)
    };
    Line { name: name.to_owned(), points: (0..BARS).map(bar).collect() }
}
