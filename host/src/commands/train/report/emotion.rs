//! The report of `kinesic train emotion`.

use kinesic::Pack;
use kinesic_host::emotion::evaluate::{Report, Scorer, mean};
use kinesic_host::emotion::motions::Example;
use kinesic_host::emotion::play::{Settings, Strengths, play, seconds};
use kinesic_host::emotion::{Distances, HostEmotion, Trained};
use kinesic_host::report::{Chart, Line, Report as Page, Table};
use miette::IntoDiagnostic;

use crate::commands::figure::{figure, percent};
use crate::commands::{angles, quality};

/// Strengths along a curve.
const STEPS: usize = 41;

/// The page about a training.
pub fn page(
    trained: &Trained,
    training: &Report,
    held_out: Option<&Report>,
    distances: &[Option<Distances>; 2],
    scorer: &Scorer,
    examples: &[Example],
    pack: &Pack,
) -> miette::Result<Page> {
    let model = &trained.model;
    let mut page = Page::new(
        &format!("Strength of emotions in a motion: {}", model.motion),
        "A ranking function for each emotion, and a network from strengths to keyframes (Chan, Shum, Wang, Yi, Wei, Ho 2019).",
    );
    page.heading("What it does");
    drawn(&mut page, trained, pack)?;
    page.heading("How well it ranks");
    let rows = |name: &str, report: &Report| -> Vec<Vec<String>> {
        let row = |a: &kinesic_host::emotion::evaluate::AttributeReport| {
            vec![
                format!("{name}, {}", a.attribute),
                a.labelled.to_string(),
                a.pairs.to_string(),
                percent(a.pair_accuracy, 2),
                figure(a.spearman, 3),
            ]
        };
        report.attributes.iter().map(row).collect()
    };
    page.table(&Table {
        caption:
            "Pairs of clips with different labels, and how many of them are in that order by strength (chance: 50 %)"
                .into(),
        head: ["", "clips", "pairs", "right", "Spearman"].map(Into::into).to_vec(),
        rows: rows("trained on", training)
            .into_iter()
            .chain(held_out.into_iter().flat_map(|r| rows("held out", r)))
            .collect(),
    });
    page.table(&Table {
        caption: "Ranking functions: pairs of motions, cost of a violated pair, pair accuracy on takes held back while it was \
                  chosen"
            .into(),
        head: ["attribute", "ordered", "similar", "cost", "validation"].map(Into::into).to_vec(),
        rows: (model.attributes.iter().zip(&trained.rankings))
            .map(|(attribute, r)| {
                vec![
                    attribute.name.clone(),
                    r.ordered.to_string(),
                    r.similar.to_string(),
                    format!("{:.2e}", r.cost),
                    percent(r.validation, 2),
                ]
            })
            .collect(),
    });
    page.table(&Table {
        caption: "Strengths that are read from the training clips, by label (0 the weakest label of an order, 1 the strongest, or the \
                  numbers of the column)"
            .into(),
        head: ["attribute", "label", "clips", "mean", "from", "to"].map(Into::into).to_vec(),
        rows: (0..model.attributes.len()).flat_map(|index| by_label(trained, index, scorer, examples)).collect(),
    });
    page.heading("What it makes").text(&format!(
        "{} keyframes of {} components, which hold {:.1} % of the variance; a joint is {:.1} cm from the spline between keyframes, and \
         {:.1} cm from the training motions at the strengths that these have (root mean square).",
        model.keyframes,
        model.components(),
        100.0 * trained.explained,
        100.0 * trained.keyframe_error,
        100.0 * trained.network_error,
    ));
    let pairs = distances.iter().zip(["trained on", "held out"]);
    let named: Vec<_> = pairs.filter_map(|(found, name)| Some((name, found.as_ref()?))).collect();
    page.table(&Table {
        caption: "What the pack plays against the recorded motions, at the best alignment in time: at the strengths of the clip's \
                  labels, and at the middle of the ranges, which no label changes. RMS joint distance, cm"
            .into(),
        head: ["clips", "middle", "labels"].map(Into::into).to_vec(),
        rows: (named.iter())
            .map(|(name, d)| vec![(*name).into(), format!("{:.2}", d.identity.cm), format!("{:.2}", d.error.cm)])
            .collect(),
    });
    for (name, found) in named {
        page.table(&angles::table(
            &[("middle", Some(&found.identity.degrees)), ("labels", Some(&found.error.degrees))],
            &format!("Angles to the clips {name}"),
        ));
        if let Some(found) = &found.quality {
            let caption = format!("What the eye sees first, means of the motions {name}");
            page.table(&quality::table(found, ["middle", "recorded", "labels"], &caption));
        }
    }
    page.chart(&Chart {
        caption: "How long the motion takes at each strength, the other strengths in the middle of their range.".into(),
        x: "strength",
        y: "seconds",
        lines: durations(trained, &HostEmotion::load(pack).into_diagnostic()?),
    });
    for note in &trained.notes {
        page.text(&format!("Note: {note}."));
    }
    Ok(page)
}

/// The motion at the weakest, a middle and the strongest strength of every attribute, played by the device's code.
fn drawn(page: &mut Page, trained: &Trained, pack: &Pack) -> miette::Result<()> {
    let attributes = &trained.model.attributes;
    let fps = f64::from(trained.model.frame_rate);
    let middle = |[low, high]: [f32; 2]| low.midpoint(high);
    for (index, attribute) in attributes.iter().enumerate() {
        let [low, high] = attribute.strength;
        let mut shown = Vec::new();
        for (name, strength) in [("weakest", low), ("middle", low.midpoint(high)), ("strongest", high)] {
            let mut from = Strengths::default();
            from.iter_mut().zip(attributes).for_each(|(to, attribute)| *to = middle(attribute.strength));
            from[index] = strength;
            let played = play(pack, &Settings { from, to: from, fps, seconds: None }).into_diagnostic()?;
            shown.push((format!("{}, {name}: {strength:.2}", attribute.name), played.clip));
        }
        let rows: Vec<_> = shown.iter().map(|(name, clip)| (name.as_str(), clip)).collect();
        let what = "Eight moments of the motion as the device plays it; other attributes in the middle of their range. Strength is in units of \
             the labels; the range is that of 98 % of the training motions.";
        super::figures(page, pack, &rows, what)?;
    }
    Ok(())
}

/// Rows of one attribute: label, clips, mean and range of the strengths that are read.
fn by_label(trained: &Trained, index: usize, scorer: &Scorer, examples: &[Example]) -> Vec<Vec<String>> {
    let read = examples.iter().filter_map(|example| {
        Some((example.levels.get(index).copied()??, *mean(&scorer.read(&example.clip)).get(index)?))
    });
    let mut read: Vec<(f64, f64)> = read.collect();
    read.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let row = |same: &[(f64, f64)]| {
        let total: f64 = same.iter().map(|(_, strength)| strength).sum();
        let cell = |strength: f64| format!("{strength:.2}");
        vec![
            trained.model.attributes[index].name.clone(),
            format!("{:.2}", same[0].0),
            same.len().to_string(),
            cell(total / same.len() as f64),
            cell(same[0].1),
            cell(same[same.len() - 1].1),
        ]
    };
    read.chunk_by(|a, b| a.0 == b.0).map(row).collect()
}

/// Time from the first keyframe to the last, as the device plays it.
fn durations(trained: &Trained, emotion: &HostEmotion) -> Vec<Line> {
    let attributes = &trained.model.attributes;
    let line = |(index, attribute): (usize, &kinesic_host::emotion::Attribute)| {
        let point = |step: usize| {
            let along = step as f32 / (STEPS - 1) as f32;
            let mut strengths = Strengths::default();
            for (other, (to, attribute)) in strengths.iter_mut().zip(attributes).enumerate() {
                let [low, high] = attribute.strength;
                *to = low + if other == index { along } else { 0.5 } * (high - low);
            }
            (f64::from(strengths[index]), f64::from(seconds(emotion, &strengths)))
        };
        Line { name: attribute.name.clone(), points: (0..STEPS).map(point).collect() }
    };
    attributes.iter().enumerate().map(line).collect()
}
