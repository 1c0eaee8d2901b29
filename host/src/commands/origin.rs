//! Where a pack or a page comes from: its command line and files. `--private` leaves out what says more than names and digests.

use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use kinesic_host::pack::{InputFile, Provenance};
use kinesic_host::prepare;
use miette::{IntoDiagnostic, WrapErr};

/// `--private`, of the process's one command line.
static PRIVATE: AtomicBool = AtomicBool::new(false);

/// Takes `--private` from the command line.
pub fn keep_private(private: bool) {
    PRIVATE.store(private, Ordering::Relaxed);
}

fn private() -> bool {
    PRIVATE.load(Ordering::Relaxed)
}

/// The command line as given, for the provenance. What is about checkpoints is left out: a training that goes on after a kill
/// makes the same pack as one that was never stopped.
pub fn command_line() -> String {
    let quoted = |arg: String| if arg.contains(' ') { format!("'{arg}'") } else { arg };
    // Paths need not be Unicode; `std::env::args` would panic over them.
    let args = std::env::args_os().skip(1).map(|arg| arg.to_string_lossy().into_owned());
    if private() {
        return "kinesic (the command line was left out: --private)".to_owned();
    }
    let mut seconds = false;
    let args = args.filter(|arg| {
        let value = std::mem::replace(&mut seconds, arg == "--checkpoint-every");
        !(value || seconds || arg == "--resume" || arg == "--overwrite" || arg.starts_with("--checkpoint-every="))
    });
    std::iter::once("kinesic".to_owned()).chain(args.map(quoted)).collect::<Vec<_>>().join(" ")
}

/// A path as packs and pages name it: as given, or the file's name alone.
pub fn name_of(path: &str) -> String {
    let name = || Path::new(path).file_name().map(|name| name.to_string_lossy().into_owned());
    if private() { name().unwrap_or_default() } else { path.to_owned() }
}

/// Path and digest of a training file.
pub fn fingerprint(path: &Path) -> miette::Result<InputFile> {
    let print = prepare::fingerprint(path).into_diagnostic().wrap_err_with(|| path.display().to_string())?;
    Ok(InputFile { path: name_of(&print.path), ..print })
}

/// Path and digest of each of the training files.
pub fn fingerprints<'p>(paths: impl IntoIterator<Item = &'p Path>) -> miette::Result<Vec<InputFile>> {
    paths.into_iter().map(fingerprint).collect()
}

/// How the note about an earlier pack's command begins; see [`made_from`].
const MADE_WITH: &str = "from a pack that was made with: ";

/// The provenance of a pack that is made from another one: with its files and notes, and how it was made itself.
pub fn made_from(earlier: Provenance, how: Option<&str>) -> Provenance {
    let mut provenance = Provenance { command: command_line(), ..earlier.clone() };
    if let Some(how) = how {
        provenance.notes.push(format!("{how}, {MADE_WITH}{}", earlier.command));
    }
    if private() {
        provenance.inputs.iter_mut().for_each(|input| input.path = name_of(&input.path));
        for note in &mut provenance.notes {
            if let Some((before, _)) = note.split_once(MADE_WITH) {
                *note = format!("{before}{MADE_WITH}(left out: --private)");
            }
        }
    }
    provenance
}
