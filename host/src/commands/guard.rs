//! Outputs that would replace an input, or each other: refused before any work, unless `--overwrite` says otherwise.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use clap::ArgMatches;
use miette::miette;

/// Arguments that name files to write, of any command.
const OUTPUTS: [&str; 4] = ["out", "report", "landmarks_out", "scores"];
/// Those of `decouple`, whose names are inputs elsewhere.
const PARTS: [&str; 2] = ["mechanics", "expressive"];

/// `--overwrite`, of the process's one command line.
static OVERWRITES: AtomicBool = AtomicBool::new(false);

/// Takes `--overwrite` from the command line.
pub fn set_overwrites(overwrites: bool) {
    OVERWRITES.store(overwrites, Ordering::Relaxed);
}

/// Whether inputs may be replaced.
pub fn overwrites() -> bool {
    OVERWRITES.load(Ordering::Relaxed)
}

/// Refuses a command line in which a file is written that it reads too, or written twice.
pub fn check(matches: &ArgMatches) -> miette::Result<()> {
    let (mut command, mut at) = ("", matches);
    while let Some((name, inner)) = at.subcommand() {
        (command, at) = (name, inner);
    }
    let (mut inputs, mut outputs): (Vec<&PathBuf>, Vec<&PathBuf>) = (Vec::new(), Vec::new());
    for id in at.ids().map(clap::Id::as_str) {
        // Arguments of other types are no files.
        let Ok(Some(paths)) = at.try_get_many::<PathBuf>(id) else { continue };
        let writes = OUTPUTS.contains(&id) || command == "decouple" && PARTS.contains(&id);
        if writes { &mut outputs } else { &mut inputs }.extend(paths);
    }
    for (index, out) in outputs.iter().enumerate() {
        if let Some(input) = inputs.iter().find(|input| input.is_file() && same(input, out)) {
            return Err(miette!(
                help = "name another file to write, or say --overwrite to replace this one",
                "{}: it is read and would be replaced, as {}",
                input.display(),
                out.display()
            ));
        }
        if outputs[..index].iter().any(|other| same(other, out)) {
            return Err(miette!(
                help = "name two files to write, or say --overwrite to keep the last one",
                "{}: it would be written twice",
                out.display()
            ));
        }
    }
    Ok(())
}

/// Whether two paths name one file, which need not be there yet.
pub fn same(a: &Path, b: &Path) -> bool {
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        if let (Ok(a), Ok(b)) = (std::fs::metadata(a), std::fs::metadata(b)) {
            return (a.dev(), a.ino()) == (b.dev(), b.ino());
        }
    }
    place(a) == place(b)
}

/// Folder without links, and name.
fn place(path: &Path) -> PathBuf {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let folder = folder.canonicalize().unwrap_or_else(|_| folder.to_owned());
    path.canonicalize().unwrap_or_else(|_| folder.join(path.file_name().unwrap_or_default()))
}
