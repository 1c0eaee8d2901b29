//! The report of `kinesic train translate`.

use kinesic::Pack;
use kinesic::rig::JointKind;
use kinesic_host::clip::Clip;
use kinesic_host::pack::PackFile;
use kinesic_host::plain;
use kinesic_host::report::{Chart, Line, Report as Page, Table};
use kinesic_host::rig::Rig;
use kinesic_host::robot::Machine;
use kinesic_host::translate::{Errors, NamedPair, Report, Settings, Trained, play};
use miette::IntoDiagnostic;

use super::super::translate::{alignment_name, describe};
use crate::commands::{angles, quality};

/// The page about a training.
pub fn page(trained: &Trained, report: &Report, first: &NamedPair, rig: &Rig, file: &PackFile) -> miette::Result<Page> {
    let mut page = Page::new(
        &format!("Style translation: {}", trained.model.style),
        "State-space models that turn one manner of moving into another (Dong 2018 after Hsu 2005).",
    );
    let ((_, source), (_, target)) = (first.source, first.target);
    let pack = file.pack().into_diagnostic()?;
    let styled = play(&pack, rig, source, &Settings::default()).into_diagnostic()?;
    page.heading("What it does");
    let clips = [("source", source), ("translated", &styled), ("target", target)];
    let what = "Eight moments from the first to the last frame of each clip of the first training pair. Clips of different length do not line up.";
    super::figures(&mut page, &pack, &clips, what)?;
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
    let judged = report.errors.judged(trained.alignment);
    page.table(&angles::table(&angles::columns(&judged), "Angle to the target, mean of the training pairs"));
    if let Some(found) = &report.quality {
        page.table(&quality::table(found, quality::PAIR, "What the eye sees first, mean of the training pairs"));
    }
    page.chart(&most_changed(&pack, rig, &clips)?);
    page.heading("How it was chosen").table(&Table {
        caption:
            "Ways to bring the clips together, and the error on the training pairs of each, cm, closed ends. Walks are brought together in step; \
             else the smallest is taken"
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

/// Of a body the height of the joint whose mean height differs most between the first clip and the last; of a robot the coordinate whose
/// swing does.
fn most_changed(pack: &Pack, rig: &Rig, clips: &[(&str, &Clip); 3]) -> miette::Result<Chart> {
    let [(_, source), _, (_, target)] = *clips;
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len().max(1) as f64;
    let most = |count: usize, change: &dyn Fn(usize) -> f64| {
        (0..count).max_by(|a, b| change(*a).total_cmp(&change(*b))).unwrap_or(0)
    };
    let chart = |caption: String, y: &'static str, value: &dyn Fn(&Clip) -> Vec<f64>| Chart {
        caption,
        x: "frame",
        y,
        lines: clips.iter().map(|(name, clip)| Line::of(name, &value(clip))).collect(),
    };
    let Some(machine) = Machine::from_pack(pack).into_diagnostic()? else {
        let height = |clip: &Clip, joint: usize| -> Vec<f64> {
            (0..clip.frames()).map(|frame| clip.positions(frame)[joint].y).collect()
        };
        let joint = most(rig.joints(), &|joint| (mean(&height(source, joint)) - mean(&height(target, joint))).abs());
        let name = &rig.skeleton.joints[joint].name;
        let caption = format!(
            "Height of {name} over the ground, m: the joint whose mean height the style changes most, in the first pair."
        );
        return Ok(chart(caption, "height, m", &|clip| height(clip, joint)));
    };
    let of = |clip: &Clip, at: usize, scale: f64| -> Vec<f64> {
        (0..clip.frames()).filter_map(|frame| Some(scale * clip.coordinates(frame)?.get(at)?)).collect()
    };
    let swing = |clip: &Clip, at: usize| {
        let values = of(clip, at, 1.0);
        let middle = mean(&values);
        mean(&values.iter().map(|x| (x - middle).abs()).collect::<Vec<_>>())
    };
    let at = most(machine.servos.len(), &|at| (swing(source, at) - swing(target, at)).abs());
    let slides = machine.rig.frames().places().any(|(kind, first)| kind == JointKind::Slider && first == at);
    let (unit, scale) = if slides { ("mm", 1000.0) } else { ("degrees", 180.0 / std::f64::consts::PI) };
    let name = plain::line(&machine.servos[at].name);
    let caption = format!("Joint {name}, {unit}: its swing changes most, in the first pair.");
    Ok(chart(caption, unit, &|clip| of(clip, at, scale)))
}
