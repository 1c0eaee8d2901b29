//! The report of `kinesic train face`.

use kinesic::face::INNER;
use kinesic_host::face::{Face, HostFace, REGIONS, Report, Trained, read_all};
use kinesic_host::pack::PackFile;
use kinesic_host::report::{Chart, Line, Report as Page, Table};
use miette::IntoDiagnostic;

/// Bars of a histogram over the plausible strengths.
const BARS: usize = 30;

/// The page about a training.
pub fn page(
    trained: &Trained,
    training: &Report,
    held_out: Option<&Report>,
    file: &PackFile,
    faces: &[Face],
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
    page.chart(&Chart {
        caption: format!(
            "The mean face of the largest cluster from the weakest to the strongest plausible strength ({:.2} to {:.2}), y up, in \
             the face's own unit.",
            model.strength[0], model.strength[1]
        ),
        x: "to the left of the person",
        y: "up",
        lines: drawn(&device, largest, model.strength),
    });
    page.heading("How well it ranks");
    let row = |name: &str, report: &Report| {
        let percent = |x: f64| format!("{:.2} %", 100.0 * x);
        vec![
            name.to_owned(),
            report.faces.to_string(),
            report.pairs.to_string(),
            percent(report.pair_accuracy),
            percent(report.pair_accuracy_within_clusters),
            format!("{:.3}", report.spearman),
        ]
    };
    page.table(&Table {
        caption: "Pairs of faces with different labels, and how many of them are in that order by strength".into(),
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
                let validation = format!("{:.2} %", 100.0 * trained.validation[c]);
                vec![c.to_string(), trained.faces[c].to_string(), validation, format!("{:.0}", 1e3 * trained.error[c])]
            })
            .collect(),
    });
    let read = read_all(&pack, faces).into_diagnostic()?;
    let middle = 0.5 * f64::from(model.strength[0] + model.strength[1]);
    let of = |upper: bool| {
        let chosen = read.iter().filter(move |read| read.face.label.is_some_and(|label| (label > middle) == upper));
        chosen.map(|read| read.reading.strength).collect::<Vec<f32>>()
    };
    page.chart(&Chart {
        caption: "Strengths of the training faces, by label.".into(),
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

/// Brows, eyes, nose and mouth at both ends.
fn drawn(device: &HostFace, cluster: usize, strength: [f32; 2]) -> Vec<Line> {
    // Index of the first landmark, number, and whether the line closes.
    const STROKES: [(u8, usize, bool); 8] = [
        (17, 5, false),
        (22, 5, false),
        (27, 4, false),
        (31, 5, false),
        (36, 6, true),
        (42, 6, true),
        (48, 12, true),
        (61, 3, false),
    ];
    debug_assert_eq!(REGIONS.len(), 4);
    let mut lines = Vec::new();
    for (name, strength) in [("weakest", strength[0]), ("strongest", strength[1])] {
        let Some(shape) = device.shape(cluster, strength) else { continue };
        for (first, count, closed) in STROKES {
            let at = |landmark: u8| INNER.iter().position(|l| *l == landmark).map(|i| shape[i]);
            let points = (0..count + usize::from(closed)).filter_map(|i| at(first + (i % count) as u8));
            let points = points.map(|[x, y]| (f64::from(x), -f64::from(y))).collect();
            lines.push(Line { name: name.to_owned(), points });
        }
    }
    lines
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
