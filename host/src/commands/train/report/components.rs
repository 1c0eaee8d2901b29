//! The report of `kinesic train components`.

use kinesic_host::clip::Clip;
use kinesic_host::components::{Report, Settings, ToClip, TradeOff, Trained, play_stored};
use kinesic_host::pack::PackFile;
use kinesic_host::report::{Chart, Line, Report as Page, Table};
use kinesic_host::rig::Rig;
use miette::IntoDiagnostic;

use crate::commands::{angles, quality};

/// The page about a training.
pub fn page(
    trained: &Trained,
    measured: &Report,
    to_style: &ToClip,
    curve: &[TradeOff],
    [content, style]: [&Clip; 2],
    rig: &Rig,
    file: &PackFile,
) -> miette::Result<Page> {
    let mut page = Page::new(
        &format!("Style components: {}", trained.model.style),
        "Two clips became sparse basic motions; new ones were learned that stay near the content's and share the style's \
         Gram matrix (Phong, Thanh, Yu 2018).",
    );
    let pack = file.pack().into_diagnostic()?;
    let result = play_stored(&pack, rig, &Settings::default()).into_diagnostic()?;
    page.heading("What it does");
    let rows = [("content", content), ("style", style), ("result", &result)];
    super::figures(&mut page, &pack, &rows, "Eight moments from the first to the last frame of each clip.")?;
    page.text(&format!("{}.", trained.choice.reason));
    let row = |name: &str, value: String| vec![name.to_owned(), value];
    page.table(&Table {
        caption: "Distances are relative: 0 is equal, 1 is as far as the thing itself is from nothing. Jerk: 1 is as smooth as the content".into(),
        head: vec!["figure".into(), "value".into()],
        rows: vec![
            row("components", trained.choice.count.to_string()),
            row("reconstruction error of the content", format!("{:.4}", measured.reconstruction_error)),
            row("share of joint groups that move", format!("{:.2}", measured.density)),
            row("distance to the style's Gram matrix", format!("{:.3}", measured.style_distance)),
            row("distance to the content's components", format!("{:.3}", measured.content_distance)),
            row("degrees to the style before, all joints", format!("{:.1}", measured.degrees_before.all)),
            row("degrees to the style after, all joints", format!("{:.1}", measured.degrees_after.all)),
            row("degrees to the style before, head, hands, feet", format!("{:.1}", measured.degrees_before.leaves)),
            row("degrees to the style after, head, hands, feet", format!("{:.1}", measured.degrees_after.leaves)),
            row("jerk against the content's", format!("{:.2}", measured.jerk_ratio)),
            row("change of the content, RMS joint distance frame for frame, cm", format!("{:.2}", measured.change.cm)),
            row("content to style clip, aligned RMS joint distance, cm", format!("{:.2}", to_style.identity.cm)),
            row("result to style clip, the same, cm", format!("{:.2}", to_style.error.cm)),
        ],
    });
    page.table(&angles::table(
        &[
            ("content to style", Some(&to_style.identity.degrees)),
            ("result to style", Some(&to_style.error.degrees)),
            ("change of the content", Some(&measured.change.degrees)),
        ],
        "Angles. The two clips need not show the same content, so the result need not come near the style clip",
    ));
    if let Some(found) = &to_style.quality {
        page.table(&quality::table(
            found,
            ["content", "style", "result"],
            "What the eye sees first; content and result are the stored stream",
        ));
    }
    page.heading("How the learning went").chart(&Chart {
        caption: "Objective of style learning (content + style + smoothness, in squared deviations) over the steps of \
                  Adam from noise."
            .into(),
        x: "step",
        y: "objective",
        lines: vec![Line::of("objective", &trained.learned.history)],
    });
    page.chart(&Chart {
        caption: "Objective of the sparse factorisation over its sweeps: it never rises.".into(),
        x: "sweep",
        y: "objective",
        lines: vec![Line::of("content", &trained.content.history), Line::of("style", &trained.style.history)],
    });
    if !curve.is_empty() {
        let row = |point: &TradeOff| {
            let distances = [point.style_distance, point.content_distance];
            std::iter::once(point.style_weight.to_string()).chain(distances.map(|x| format!("{x:.3}"))).collect()
        };
        page.table(&Table {
            caption: "What other style weights would lead to".into(),
            head: ["style weight", "style distance", "content distance"].map(Into::into).to_vec(),
            rows: curve.iter().map(row).collect(),
        });
    }
    Ok(page)
}
