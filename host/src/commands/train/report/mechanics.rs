//! The report of `kinesic train mechanics`.

use kinesic_host::mechanics::{Distances, Figures, NamedClip, Trained, decouple};
use kinesic_host::pack::PackFile;
use kinesic_host::report::{Chart, Line, Report as Page, Table};
use kinesic_host::rig::Rig;
use miette::IntoDiagnostic;

use crate::commands::angles;

/// The page about a training; `history` is the training error of every epoch with its stage, `shown` the clip in the picture.
pub fn page(
    trained: &Trained,
    (distances, unseen): (&Distances, bool),
    history: &[(&'static str, f64)],
    shown: &NamedClip,
    rig: &Rig,
    file: &PackFile,
) -> miette::Result<Page> {
    let mut page = Page::new(
        "Body mechanics",
        "Networks that say which pose a body's own movement asks for; what the observed pose has beyond is expression (Boehs, \
         Vieira, Pereira 2017).",
    );
    let pack = file.pack().into_diagnostic()?;
    let parts = decouple(&pack, &rig.poses(&shown.clip)).into_diagnostic()?;
    let mechanics: Vec<_> = parts.iter().map(|parts| parts.mechanics).collect();
    page.heading("What it does");
    let rows = [("observed", &shown.clip), ("mechanics", &rig.clip(&mechanics, shown.clip.frame_time))];
    let what =
        format!("Eight moments of {}, a clip without expression: the mechanics should look like it.", shown.name);
    super::figures(&mut page, &pack, &rows, &what)?;
    let row = |name: &str, of: fn(&Figures) -> f64| {
        let held_back = trained.held_back.as_ref().map_or_else(|| "-".to_owned(), |f| format!("{:.5}", of(f)));
        vec![name.to_owned(), held_back, format!("{:.5}", of(&trained.training))]
    };
    page.table(&Table {
        caption: format!(
            "Mean squared errors are of single quaternion components of the {} joints that move; angles are geodesic, degrees a \
             joint. Mean pose and linear regression from the same features are the baselines",
            trained.moving
        ),
        head: ["figure", "held back", "training"].map(Into::into).to_vec(),
        rows: vec![
            row("autoencoder, MSE", |f| f.autoencoder_mse),
            row("mean pose of the pool, MSE", |f| f.pool_mean_mse[0]),
            row("features to code, MSE", |f| f.feature_mse),
            row("stacked network, MSE", |f| f.stacked_mse),
            row("linear regression, MSE", |f| f.linear_mse),
            row("mean pose, MSE", |f| f.mean_pose_mse),
            row("stacked network, degrees", |f| f.geodesic_deg),
            row("linear regression, degrees", |f| f.linear_deg),
            row("mean pose, degrees", |f| f.mean_pose_deg),
        ],
    });
    let clips = if unseen { "held back" } else { "trained on" };
    let models = [
        ("mean pose", &distances.mean_pose),
        ("linear regression", &distances.linear),
        ("stacked network", &distances.predicted),
    ];
    page.table(&Table {
        caption: format!("RMS joint distance to the observed poses, frame for frame, on body-mechanics clips {clips}"),
        head: ["model", "cm"].map(Into::into).to_vec(),
        rows: models.map(|(name, distance)| vec![name.to_owned(), format!("{:.2}", distance.cm)]).to_vec(),
    });
    page.table(&angles::table(
        &models.map(|(name, distance)| (name, Some(&distance.degrees))),
        &format!("Angles to the observed poses, all joints of the skeleton, on body-mechanics clips {clips}"),
    ));
    let mut lines: Vec<Line> = Vec::new();
    for (stage, error) in history {
        if lines.last().is_none_or(|line| line.name != *stage) {
            lines.push(Line { name: (*stage).to_owned(), points: Vec::new() });
        }
        if let Some(line) = lines.last_mut() {
            line.points.push((line.points.len() as f64 + 1.0, *error));
        }
    }
    page.heading("How the training went").chart(&Chart {
        caption:
            "Mean squared training error of every epoch, in deviations of what the stage learns; noise is added to the \
                  inputs, so it does not fall to the errors above."
                .into(),
        x: "epoch",
        y: "error",
        lines,
    });
    Ok(page)
}
