//! Why a skeleton map is refused.

use std::path::PathBuf;

/// Why a skeleton map is refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MapError {
    /// Something in this file.
    #[error("{}: {error}", path.display())]
    InFile {
        /// The map file.
        path: PathBuf,
        /// What is wrong.
        error: Box<MapError>,
    },
    /// The system refused.
    #[error("the map file cannot be read: {error}. Check the path")]
    Io {
        /// What the system said.
        error: String,
    },
    /// Not TOML.
    #[error("not a TOML map file: {error}. Expected lines like  pelvis = \"Hips\"  below  [joints]")]
    Toml {
        /// What the parser said, with line and column.
        error: String,
    },
    /// A key at the top that means nothing.
    #[error("unknown key '{key}', expected [joints], units or up{}", suggestion(near))]
    UnknownKey {
        /// The key.
        key: String,
        /// A known key that is spelled alike.
        near: Option<String>,
    },
    /// No table `[joints]`, or something else by this name.
    #[error("the table [joints] is missing. Add it, with lines like  pelvis = \"Hips\"")]
    NoJoints,
    /// A canonical joint that does not exist.
    #[error(
        "[joints]: '{name}' is not a canonical joint{}. Known: pelvis spine chest neck head, and with l_ or r_: collar \
             shoulder elbow wrist hip knee ankle toe",
        suggestion(near)
    )]
    UnknownCanonical {
        /// The name.
        name: String,
        /// A canonical joint that is spelled alike.
        near: Option<String>,
    },
    /// A value that is not text.
    #[error("'{key}' is {found}, expected text in quotes")]
    NotText {
        /// The key.
        key: String,
        /// Type of the value.
        found: String,
    },
    /// `units` or `up` with an unknown value.
    #[error("'{key}': {error}")]
    Value {
        /// The key.
        key: &'static str,
        /// What is wrong with it.
        error: String,
    },
    /// The pelvis is always needed.
    #[error("[joints] has no pelvis, which is always needed. Add  pelvis = \"name of the hips joint\"")]
    NoPelvis,
    /// A map cannot be suggested.
    #[error(
        "no map can be suggested: {found}; expected two legs, two arms and a trunk between them. Write the map by hand: \
             `kinesic inspect --help` shows one"
    )]
    NoBody {
        /// What was found instead.
        found: String,
    },
    /// A joint of the map is not in the skeleton.
    #[error(
        "{canonical} = \"{name}\": the skeleton has no joint of this name{}. `kinesic inspect` lists its joints",
        suggestion(near)
    )]
    MissingJoint {
        /// The canonical joint.
        canonical: &'static str,
        /// The name the map gives.
        name: String,
        /// A joint of the skeleton that is spelled alike.
        near: Option<String>,
    },
}

fn suggestion(near: &Option<String>) -> String {
    near.as_ref().map_or(String::new(), |n| format!("; did you mean '{n}'?"))
}
