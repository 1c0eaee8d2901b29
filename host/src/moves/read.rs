//! From a path to a motion: which format it has.

use std::path::Path;

use super::{Moves, MovesError, Options, json, table, trajectory};
use crate::clip;

/// Reads a motion of any format that `docs/moves.md` lists, also compressed with gzip.
pub fn read(path: &Path, options: &Options) -> Result<Moves, MovesError> {
    let bytes = clip::contents(path).map_err(|error| MovesError::new("", error.to_string(), "name a file of moves"))?;
    parse(&bytes, path, options)
}

/// Reads the bytes of a file; the path is for messages, for its extension, and for files beside it.
pub fn parse(bytes: &[u8], path: &Path, options: &Options) -> Result<Moves, MovesError> {
    let in_file = |error: MovesError| error.in_file(path);
    if bytes.starts_with(b"PAR1") {
        let help = "python -c \"import pandas as pd; pd.read_parquet('x.parquet').to_json('x.jsonl', orient='records', lines=True)\"";
        return Err(in_file(MovesError::new("", "found a parquet file, expected a table as CSV or JSON lines", help)));
    }
    let text = match std::str::from_utf8(bytes) {
        Ok(text) => text.trim_start_matches('\u{feff}'),
        Err(error) => {
            let line = 1 + bytes[..error.valid_up_to()].iter().filter(|byte| **byte == b'\n').count();
            let what = "found bytes that are not UTF-8, expected text";
            return Err(in_file(MovesError::new(format!("line {line}"), what, "save it as UTF-8")));
        }
    };
    if text.trim().is_empty() {
        return Err(in_file(MovesError::new("", "found an empty file, expected a motion", "is the file whole?")));
    }
    let moves = match kind(path, text.as_bytes()) {
        Kind::Json => json::parse(text, path, options),
        Kind::Yaml => trajectory::parse(text, options),
        Kind::Table => table::parse(text, path, options),
    };
    moves.map_err(in_file)
}

enum Kind {
    Json,
    Yaml,
    Table,
}

/// By content, then by extension: a wrong extension is common.
fn kind(path: &Path, text: &[u8]) -> Kind {
    let first = text.iter().find(|byte| !byte.is_ascii_whitespace());
    if matches!(first, Some(b'{' | b'[')) {
        return Kind::Json;
    }
    let yaml =
        path.extension().is_some_and(|found| found.eq_ignore_ascii_case("yaml") || found.eq_ignore_ascii_case("yml"));
    if yaml || holds(text, "joint_names:") { Kind::Yaml } else { Kind::Table }
}

fn holds(text: &[u8], word: &str) -> bool {
    text[..text.len().min(4096)].windows(word.len()).any(|part| part == word.as_bytes())
}

/// Whether the first bytes of a file are a motion in joints: a table with a time or with numbers, JSON of joints or of targets, a trajectory.
/// Not a BVH, a glTF, a table of joint positions or of landmarks.
pub fn is_moves(path: &Path, head: &[u8]) -> bool {
    if head.starts_with(b"PAR1") {
        return true;
    }
    // What is packed has a name before that.
    let name = path.file_name().and_then(|name| name.to_str()).unwrap_or("").to_lowercase();
    let extension = name.strip_suffix(".gz").unwrap_or(&name).rsplit('.').next().unwrap_or("");
    let text = String::from_utf8_lossy(head);
    let text = text.trim_start_matches('\u{feff}').trim_start();
    if text.starts_with(['{', '[']) {
        let said = ["joints", "joint_names", "set_target_data", "time", "timestamp", "t"];
        return !text.contains("\"asset\"") && said.iter().any(|key| text.contains(&format!("\"{key}\"")));
    }
    if text.contains("joint_names:") {
        return true;
    }
    extension == "csv" && table::is_motion(text)
}
