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
use crate::commands::angles;

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
    page.table(&angles::table(&angles::columns(&report.errors), "Angle to the target, mean of the training pairs"));
    let curve = Curve::most_changed(&pack, rig, [source, target])?;
    page.chart(&Chart {
        caption: curve.caption,
        x: "frame",
        y: curve.unit,
        lines: clips.iter().map(|(name, clip)| Line::of(name, &(curve.value)(clip))).collect(),
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

/// What is plotted of every clip.
struct Curve {
    caption: String,
    unit: &'static str,
    value: Box<dyn Fn(&Clip) -> Vec<f64>>,
}

impl Curve {
    /// Of a body the height of the joint whose mean height differs most between two clips; of a robot the coordinate that goes farther.
    fn most_changed(pack: &Pack, rig: &Rig, [source, target]: [&Clip; 2]) -> miette::Result<Self> {
        let most = |count: usize, change: &dyn Fn(usize) -> f64| {
            (0..count).max_by(|a, b| change(*a).total_cmp(&change(*b))).unwrap_or(0)
        };
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len().max(1) as f64;
        if let Some(machine) = Machine::from_pack(pack).into_diagnostic()? {
            let of = |clip: &Clip, at: usize, scale: f64| -> Vec<f64> {
                (0..clip.frames()).filter_map(|frame| Some(scale * clip.coordinates(frame)?.get(at)?)).collect()
            };
            let swing = |clip: &Clip, at: usize| {
                let values = of(clip, at, 1.0);
                let middle = mean(&values);
                values.iter().map(|x| (x - middle).abs()).sum::<f64>() / values.len().max(1) as f64
            };
            let coordinate = most(machine.servos.len(), &|at| (swing(source, at) - swing(target, at)).abs());
            let slides = machine.rig.frames().places().any(|(kind, at)| kind == JointKind::Slider && at == coordinate);
            let (unit, scale) = if slides { ("mm", 1000.0) } else { ("degrees", 180.0 / std::f64::consts::PI) };
            let name = plain::line(&machine.servos[coordinate].name);
            return Ok(Self {
                caption: format!("Joint {name}, {unit}: its swing changes most, in the first pair."),
                unit,
                value: Box::new(move |clip| of(clip, coordinate, scale)),
            });
        }
        let height = |clip: &Clip, joint: usize| -> Vec<f64> {
            (0..clip.frames()).map(|frame| clip.positions(frame)[joint].y).collect()
        };
        let joint = most(rig.joints(), &|joint| (mean(&height(source, joint)) - mean(&height(target, joint))).abs());
        let name = &rig.skeleton.joints[joint].name;
        Ok(Self {
            caption: format!(
                "Height of {name} over the ground, m: the joint whose mean height the style changes most, in the first pair."
            ),
            unit: "height, m",
            value: Box::new(move |clip| height(clip, joint)),
        })
    }
}
