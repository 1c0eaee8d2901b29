//! What the commands share on the way out: whole files, JSON, progress.

use std::io::IsTerminal;
use std::path::Path;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};
use kinesic_host::clip::Format;
use kinesic_host::{files, plain};
use miette::{IntoDiagnostic, WrapErr, miette};
use serde::Serialize;

use super::clips::NOTES;
use super::print;

/// Writes a file whole or not at all.
pub fn write_whole(path: &Path, bytes: &[u8]) -> miette::Result<()> {
    files::write_whole(path, bytes).map_err(|error| {
        miette!(
            help = "check that the folder exists and may be written to",
            "{}: cannot be written: {error}",
            path.display()
        )
    })
}

/// Refuses an output path before long work: wrong extension, or a folder that is not there.
pub fn check_output(path: &Path, extension: &str) -> miette::Result<()> {
    if path.extension().is_none_or(|found| !found.eq_ignore_ascii_case(extension)) {
        return Err(miette!(
            help = format!("name it {}", path.with_extension(extension).display()),
            "{}: the output is a .{extension} file",
            path.display()
        ));
    }
    check_folder(path)
}

/// As [`check_output`], for a motion: its extension says the format.
pub fn check_motion(path: &Path) -> miette::Result<()> {
    if Format::of(path).is_none() {
        return Err(miette!(
            help = format!("name it {}", path.with_extension("bvh").display()),
            "{}: the output is a .bvh, .glb, .gltf or .csv file",
            path.display()
        ));
    }
    check_folder(path)
}

fn check_folder(path: &Path) -> miette::Result<()> {
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if !folder.is_dir() {
        return Err(miette!(
            help = format!("create it: mkdir -p {}", folder.display()),
            "{}: the folder {} does not exist",
            path.display(),
            folder.display()
        ));
    }
    Ok(())
}

/// Prints one JSON object, with what was assumed about the clips in `reading`.
pub fn print_json(value: &impl Serialize) -> miette::Result<()> {
    let mut value = serde_json::to_value(value).into_diagnostic().wrap_err("cannot write JSON")?;
    let notes = NOTES.take();
    if let Some(object) = value.as_object_mut()
        && !notes.is_empty()
    {
        object.insert("reading".into(), notes.into());
    }
    let text = serde_json::to_string_pretty(&value).into_diagnostic().wrap_err("cannot write JSON")?;
    print::raw(&format!("{}\n", plain::json(&text)));
    Ok(())
}

/// A spinner on standard error, silent where nobody watches.
pub fn spinner() -> ProgressBar {
    if !std::io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new_spinner();
    bar.set_style(
        ProgressStyle::with_template("{spinner} {msg} ({elapsed})")
            .unwrap_or_else(|_| ProgressStyle::default_spinner()),
    );
    bar.enable_steady_tick(Duration::from_millis(100));
    bar
}
