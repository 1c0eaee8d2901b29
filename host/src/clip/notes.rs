//! What was assumed over many files, once a kind.

use std::path::Path;
use std::sync::Mutex;

/// Notes of all clips that were read, gathered by kind.
#[derive(Debug, Default)]
pub struct NoteLog(Mutex<Vec<Kind>>);

#[derive(Debug)]
struct Kind {
    key: String,
    file: String,
    text: String,
    count: usize,
}

impl NoteLog {
    /// An empty log.
    pub const fn new() -> Self {
        Self(Mutex::new(Vec::new()))
    }

    /// Adds the notes of a file.
    pub fn add(&self, path: &Path, notes: &[String]) {
        let Ok(mut kinds) = self.0.lock() else { return };
        for note in notes {
            let key = kind(note);
            match kinds.iter_mut().find(|k| k.key == key) {
                Some(known) => known.count += 1,
                None => kinds.push(Kind { key, file: path.display().to_string(), text: note.clone(), count: 1 }),
            }
        }
    }

    /// One line a kind: the first file and its note, and how many more there were. The log is empty afterwards.
    pub fn take(&self) -> Vec<String> {
        let Ok(mut kinds) = self.0.lock() else { return Vec::new() };
        let line = |k: Kind| match k.count {
            1 => format!("{}: {}", k.file, k.text),
            n => format!("{}: {} (and {} more of this kind)", k.file, k.text, n - 1),
        };
        std::mem::take(&mut *kinds).into_iter().map(line).collect()
    }
}

/// A note without its names and numbers.
fn kind(note: &str) -> String {
    let quoted = note.split('\'').step_by(2).collect::<String>();
    quoted.split_whitespace().filter(|w| !w.contains(|c: char| c.is_ascii_digit())).collect::<Vec<_>>().join(" ")
}

/// Whether a note says that something was assumed; what was given, and what is done to every file of its kind, was not.
pub(super) fn is_assumption(note: &str) -> bool {
    const ALWAYS: [&str; 3] = ["Camera coordinates turned", "Positions only:", "Uneven clock"];
    !note.contains("as given") && !note.contains("from the skeleton map") && !ALWAYS.iter().any(|a| note.starts_with(a))
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    #[test]
    fn notes_of_one_kind_are_counted() {
        let log = NoteLog::new();
        log.add(Path::new("a.bvh"), &["A leg of 0.9 m: 'x' is long.".into(), "Other.".into()]);
        log.add(Path::new("b.bvh"), &["A leg of 0.8 m: 'it is' is long.".into()]);
        assert_eq!(log.take(), ["a.bvh: A leg of 0.9 m: 'x' is long. (and 1 more of this kind)", "a.bvh: Other."]);
        assert!(log.take().is_empty());
    }

    #[test]
    fn what_was_given_is_no_assumption() {
        assert!(!is_assumption("Units: cm, as given."));
        assert!(is_assumption("Units: cm assumed (1 unit = 0.01 m): ..."));
    }
}
