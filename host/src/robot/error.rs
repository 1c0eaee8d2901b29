//! Why a robot's description or its map is refused.

/// Where, what was found and expected, and what to do about it.
#[derive(Clone, Debug, PartialEq, thiserror::Error, miette::Diagnostic)]
#[error("{place}: {what}")]
pub struct RobotError {
    /// Line, joint or key.
    pub place: String,
    /// What was found, and what was expected.
    pub what: String,
    /// The next step.
    #[help]
    pub help: String,
}

impl RobotError {
    pub(crate) fn new(place: impl Into<String>, what: impl Into<String>, help: impl Into<String>) -> Self {
        Self { place: place.into(), what: what.into(), help: help.into() }
    }

    /// The same error, in this file.
    pub fn in_file(mut self, path: &std::path::Path) -> Self {
        self.place = format!("{}: {}", path.display(), self.place);
        self
    }
}
