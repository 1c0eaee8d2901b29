//! Output files: whole or not at all.

use std::io::Write;
use std::path::Path;

/// Writes a file through a temporary neighbour that is renamed over `path` at the end: an older file there stays untouched
/// until then, and nothing half-written is ever seen under that name.
pub fn write_whole(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut builder = tempfile::Builder::new();
    #[cfg(unix)]
    {
        // Temporary files are private by default; a clip gets the rights that any new file would get.
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    let mut file = builder.prefix(".kinesic").tempfile_in(folder)?;
    file.write_all(bytes)?;
    // On the disk before it has the name: after a power cut there is the old file or the new one, not an empty one.
    file.as_file().sync_all()?;
    file.persist(path).map(|_| ()).map_err(|e| e.error)
}
