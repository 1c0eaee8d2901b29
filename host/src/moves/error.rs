//! Why a file of moves is refused.

/// Where, what was found and expected, and what to do about it.
#[derive(Clone, Debug, PartialEq, thiserror::Error, miette::Diagnostic)]
#[error("{place}{}{what}", if place.is_empty() { "" } else { ": " })]
pub struct MovesError {
    /// File, then line and column, joint or frame.
    pub place: String,
    /// What was found, and what was expected.
    pub what: String,
    /// The next step.
    #[help]
    pub help: String,
}

impl MovesError {
    pub(super) fn new(place: impl Into<String>, what: impl Into<String>, help: impl Into<String>) -> Self {
        Self { place: place.into(), what: what.into(), help: help.into() }
    }

    /// The same error, in this file.
    pub fn in_file(mut self, path: &std::path::Path) -> Self {
        self.place = match self.place.as_str() {
            "" => path.display().to_string(),
            place => format!("{}: {place}", path.display()),
        };
        self
    }
}

/// A text out of a file, short enough for a message and without what a terminal would obey.
pub(super) fn shown(text: &str) -> String {
    let mut short: String = text.chars().take(40).map(|c| if c.is_control() { ' ' } else { c }).collect();
    if text.chars().nth(40).is_some() {
        short.push_str("...");
    }
    format!("'{short}'")
}
