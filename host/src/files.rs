//! Files: read if they are regular, written whole or not at all.

use std::ffi::{OsStr, OsString};
use std::fs::FileType;
use std::io::{Error, ErrorKind, Read, Result, Write};
use std::path::Path;
use std::sync::{Mutex, PoisonError};

use sha2::{Digest, Sha256};
use tempfile::NamedTempFile;

/// Characters of the random part of a temporary name.
const RANDOM: usize = 6;
/// End of every temporary name.
const SUFFIX: &str = ".part";
/// Longer names are told by their hash, so that the temporary one is not too long for the file system.
const LONGEST: usize = 200;

/// Bytes of standard input at most; nothing says beforehand how many there are.
const LONGEST_INPUT: u64 = 1 << 30;

/// The bytes of a regular file, or of a link to one. A path `-` is standard input, as often as it is read.
///
/// Anything else is refused: a pipe may never end or never begin, a device has no end.
pub fn read(path: &Path) -> Result<Vec<u8>> {
    if path == Path::new("-") {
        return standard_input();
    }
    check_regular(path)?;
    std::fs::read(path)
}

/// As [`read`], for text in UTF-8.
pub fn read_text(path: &Path) -> Result<String> {
    let refuse = || Error::new(ErrorKind::InvalidData, "it is not text in UTF-8");
    String::from_utf8(read(path)?).map_err(|_| refuse())
}

/// Refuses what is there and is no regular file, without opening it.
pub fn check_regular(path: &Path) -> Result<()> {
    let kind = std::fs::metadata(path)?.file_type();
    if kind.is_file() {
        return Ok(());
    }
    let message = format!("it is {}, expected a regular file (or - for standard input)", name_of(kind));
    Err(Error::new(if kind.is_dir() { ErrorKind::IsADirectory } else { ErrorKind::InvalidInput }, message))
}

fn name_of(kind: FileType) -> &'static str {
    #[cfg(unix)]
    {
        use std::os::unix::fs::FileTypeExt;
        if kind.is_fifo() {
            return "a pipe";
        }
        if kind.is_socket() {
            return "a socket";
        }
        if kind.is_char_device() || kind.is_block_device() {
            return "a device";
        }
    }
    if kind.is_dir() { "a folder" } else { "no file" }
}

/// All of standard input, kept: a command reads a file's bytes and its digest.
fn standard_input() -> Result<Vec<u8>> {
    static READ: Mutex<Option<Vec<u8>>> = Mutex::new(None);
    let mut kept = READ.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(bytes) = &*kept {
        return Ok(bytes.clone());
    }
    let mut bytes = Vec::new();
    std::io::stdin().lock().take(LONGEST_INPUT + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > LONGEST_INPUT {
        let message = format!("standard input has more than {LONGEST_INPUT} bytes, expected at most that: name a file");
        return Err(Error::new(ErrorKind::FileTooLarge, message));
    }
    Ok(kept.insert(bytes).clone())
}

/// Writes a file through a temporary neighbour that is renamed over `path` at the end: an older file there stays untouched
/// until then, and nothing half-written is ever seen under that name.
///
/// The neighbour is called `.kinesic-NAME-RANDOM.part` and locked while it is written. One that a killed process has left, for the
/// same name, is removed.
///
/// A file that is replaced leaves its permissions to the new one.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<()> {
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let prefix = prefix(path);
    remove_stale(folder, &prefix);
    let mut file = temporary(folder, &prefix)?;
    if let Ok(older) = std::fs::metadata(path)
        && older.is_file()
    {
        file.as_file().set_permissions(older.permissions())?;
    }
    file.write_all(bytes)?;
    // On the disk before it has the name: after a power cut there is the old file or the new one, not an empty one.
    file.as_file().sync_all()?;
    file.persist(path).map(|_| ()).map_err(|e| e.error)
}

/// How the temporary files for `path` begin.
fn prefix(path: &Path) -> OsString {
    let name = path.file_name().unwrap_or_default();
    let mut prefix = OsString::from(".kinesic-");
    if name.len() <= LONGEST {
        prefix.push(name);
    } else {
        let hash = Sha256::digest(name.as_encoded_bytes());
        prefix.push(hash.iter().map(|byte| format!("{byte:02x}")).collect::<String>());
    }
    prefix.push("-");
    prefix
}

/// A new file that nobody takes for a left one: it is locked, and still there after that.
fn temporary(folder: &Path, prefix: &OsStr) -> Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    #[cfg(unix)]
    {
        // Temporary files are private by default; a clip gets the rights that any new file would get.
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    builder.prefix(prefix).suffix(SUFFIX).rand_bytes(RANDOM);
    loop {
        let file = builder.tempfile_in(folder)?;
        // Where the file system knows no locks, nobody can lock the file to remove it either.
        if file.as_file().lock().is_err() || file.path().exists() {
            return Ok(file);
        }
    }
}

/// Removes what killed processes have left: files of this prefix that nobody holds a lock on. What cannot be removed does no harm.
fn remove_stale(folder: &Path, prefix: &OsStr) {
    let Ok(entries) = std::fs::read_dir(folder) else { return };
    for entry in entries.flatten() {
        let name = entry.file_name();
        let rest = name.as_encoded_bytes().strip_prefix(prefix.as_encoded_bytes());
        let random = rest.and_then(|rest| rest.strip_suffix(SUFFIX.as_bytes()));
        if !random.is_some_and(|random| random.len() == RANDOM && random.iter().all(u8::is_ascii_alphanumeric)) {
            continue;
        }
        let Ok(file) = std::fs::OpenOptions::new().write(true).open(entry.path()) else { continue };
        if file.try_lock().is_ok() {
            let _ = std::fs::remove_file(entry.path());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_killed_process_left_is_removed_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let foreign = [
            ".kinesic-x.kin-aB3dE.part",
            ".kinesic-x.kin-aB3dE7",
            ".kinesic-y.kin-aB3dE7.part",
            ".kinesic-x.kin-a-3dE7.part",
        ];
        for name in foreign.into_iter().chain([".kinesic-x.kin-aB3dE7.part"]) {
            std::fs::write(at(name), "half").unwrap();
        }
        // Another process is writing the same file.
        let live = temporary(folder.path(), &prefix(&at("x.kin"))).unwrap();
        write_whole(&at("x.kin"), b"whole").unwrap();
        assert_eq!(std::fs::read(at("x.kin")).unwrap(), b"whole");
        assert!(!at(".kinesic-x.kin-aB3dE7.part").exists());
        assert!(live.path().exists());
        assert!(foreign.iter().all(|name| at(name).exists()));
        drop(live);
        let long = "n".repeat(250);
        write_whole(&at(&long), b"long").unwrap();
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), foreign.len() + 2);
    }

    #[test]
    #[cfg(unix)]
    fn what_is_replaced_leaves_its_permissions() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x.kin");
        let mode = || std::fs::metadata(&path).unwrap().permissions().mode() & 0o777;
        for wanted in [0o600, 0o644, 0o444, 0o755] {
            std::fs::write(&path, "older").unwrap();
            std::fs::set_permissions(&path, std::fs::Permissions::from_mode(wanted)).unwrap();
            write_whole(&path, b"newer").unwrap();
            assert_eq!((mode(), std::fs::read(&path).unwrap()), (wanted, b"newer".to_vec()));
            std::fs::remove_file(&path).unwrap();
        }
    }

    #[test]
    #[cfg(unix)]
    fn only_regular_files_are_read() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        std::fs::write(at("file"), "text").unwrap();
        std::os::unix::fs::symlink(at("file"), at("link")).unwrap();
        std::os::unix::fs::symlink("/dev/zero", at("zeros")).unwrap();
        assert!(std::process::Command::new("mkfifo").arg(at("pipe")).status().unwrap().success());
        assert_eq!(read_text(&at("link")).unwrap(), "text");
        for (name, what) in [("zeros", "a device"), ("pipe", "a pipe"), ("", "a folder")] {
            let error = read(&at(name)).unwrap_err().to_string();
            assert!(error.contains(what) && error.contains("expected a regular file"), "{error}");
        }
        assert_eq!(read(&at("gone")).unwrap_err().kind(), ErrorKind::NotFound);
    }

    #[test]
    fn writers_of_one_file_do_not_take_it_from_each_other() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x.kin");
        std::thread::scope(|scope| {
            for writer in 0..4u8 {
                let path = &path;
                scope.spawn(move || (0..50).for_each(|_| write_whole(path, &[writer; 100]).unwrap()));
            }
        });
        assert_eq!(std::fs::read(&path).unwrap().len(), 100);
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }
}
