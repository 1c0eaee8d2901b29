//! The report of `kinesic train translate`.

use kinesic_host::clip::Clip;
use kinesic_host::pack::PackFile;
use kinesic_host::report::{Chart, Line, Report as Page, Table, stick_figures};
use kinesic_host::rig::Rig;
use kinesic_host::translate::{Errors, NamedPair, Report, Settings, Trained, play};
use miette::IntoDiagnostic;

use super::super::translate::{alignment_name, describe};
use crate::commands::angles;

/// The page about a training.
pub fn page(trained: &Trained, report: &Report, first: &NamedPair, rig: &Rig, file: &PackFile) -> miette::Result<Page> {
    let mut page = Page::new(
        &format!("Style translation: {}", trained.model.style),
        "State-space models that turn one manner of moving into another (Dong 2018 after Hsu 2005).",
    );
    let ((_, source), (_, target)) = (first.source, first.target);
    let styled = play(&file.pack().into_diagnostic()?, rig, source, &Settings::default()).into_diagnostic()?;
    page.heading("What it does").figure(
        &stick_figures(&[("source", source), ("translated", &styled), ("target", target)]),
        "Eight moments from the first to the last frame of each clip of the first training pair; left limbs blue, right ones \
         orange. Clips of different length do not line up.",
    );
    let row = |name: &str, e: &Errors| {
        let cells = [
            e.identity_cm,
            e.offset_cm,
            e.affine_cm,
            e.error_cm,
            e.open_identity_cm,
            e.open_affine_cm,
            e.open_error_cm,
        ];
        std::iter::once(name.to_owned()).chain(cells.map(|x| format!("{x:.2}"))).collect::<Vec<String>>()
    };
    let mut rows = vec![row("mean", &report.errors)];
    rows.extend(report.pairs.iter().map(|pair| row(&format!("{} to {}", pair.source, pair.target), &pair.errors)));
    page.table(&Table {
        caption: "Aligned RMS joint distance to the target, cm, on the training pairs: an unseen take is what counts (kinesic \
                  eval translate). Doing nothing, mean difference and affine map are the baselines. Open: up to a third of a \
                  clip may stay unmatched at either end"
            .into(),
        head: ["pair", "doing nothing", "mean difference", "affine map", "pack", "open: nothing", "open: affine", "open: pack"]
            .map(Into::into)
            .to_vec(),
        rows,
    });
    page.table(&angles::table(&angles::columns(&report.errors), "Angle to the target, mean of the training pairs"));
    let (joint, name) = most_changed(rig, source, target);
    let height = |clip: &Clip| (0..clip.frames()).map(|frame| clip.positions(frame)[joint].y).collect::<Vec<f64>>();
    page.chart(&Chart {
        caption: format!("Height of {name} over the ground, m: the joint whose mean height the style changes most, in the first pair."),
        x: "frame",
        y: "height, m",
        lines: vec![
            Line::of("source", &height(source)),
            Line::of("translated", &height(&styled)),
            Line::of("target", &height(target)),
        ],
    });
    page.heading("How it was chosen").table(&Table {
        caption:
            "Ways to bring the clips together, and the error on the training pairs of each, cm; the smallest was taken"
                .into(),
        head: vec!["alignment".into(), "error".into()],
        rows: trained
            .alignments
            .iter()
            .map(|(way, error)| vec![alignment_name(*way).into(), format!("{error:.2}")])
            .collect(),
    });
    page.table(&Table {
        caption: format!(
            "The best of {} candidates of each form, judged on blocks that were not trained on, cm",
            trained.compared
        ),
        head: vec!["model".into(), "validation error".into()],
        rows: trained.forms.iter().map(|(model, error)| vec![describe(model), format!("{error:.2}")]).collect(),
    });
    Ok(page)
}

/// The joint whose mean height differs most between two clips, and its name.
fn most_changed(rig: &Rig, source: &Clip, target: &Clip) -> (usize, String) {
    let mean = |clip: &Clip, joint: usize| {
        (0..clip.frames()).map(|frame| clip.positions(frame)[joint].y).sum::<f64>() / clip.frames().max(1) as f64
    };
    let change = |joint: &usize| (mean(source, *joint) - mean(target, *joint)).abs();
    let joint = (0..rig.joints()).max_by(|a, b| change(a).total_cmp(&change(b))).unwrap_or(0);
    (joint, rig.skeleton.joints[joint].name.clone())
}
