//! What tables of LeRobot have of their own: lists of joints, episodes, and names in a file beside them.

use std::path::Path;

use serde_json::Value;

use super::MovesError;
use crate::files;

/// Names of the lists: what was told, then what was measured.
const LISTS: [&str; 2] = ["action", "observation.state"];

/// Whether a name is one of a list in LeRobot's tables.
pub(super) fn is_list_name(name: &str) -> bool {
    LISTS.contains(&name.trim())
}

/// Which list of several is read.
pub(super) fn chosen<'a>(names: impl Iterator<Item = &'a str>) -> Option<&'static str> {
    let places = names.filter_map(|name| LISTS.iter().position(|list| *list == name.trim()));
    places.min().and_then(|at| LISTS.get(at)).copied()
}

/// Which episode is taken, and what is left out.
pub(super) struct Episode {
    wanted: Option<u64>,
    given: bool,
    /// The first, the last and the number of frames of the others.
    others: Option<(u64, u64, usize)>,
}

impl Episode {
    /// The one with this number, the first unless given.
    pub fn new(wanted: Option<u64>) -> Self {
        Self { wanted, given: wanted.is_some(), others: None }
    }

    /// Whether a frame of this episode is taken. A table without numbers is one episode.
    pub fn takes(&mut self, number: Option<f64>) -> bool {
        let number = number.map_or(0, |number| number as u64);
        if *self.wanted.get_or_insert(number) == number {
            return true;
        }
        let (first, last, frames) = self.others.unwrap_or((number, number, 0));
        self.others = Some((first.min(number), last.max(number), frames + 1));
        false
    }

    /// Says what was left out, and refuses an episode that is not there.
    pub fn finish(self, taken: usize, notes: &mut Vec<String>) -> Result<(), MovesError> {
        let (Some(wanted), Some((first, last, frames))) = (self.wanted, self.others) else { return Ok(()) };
        if taken == 0 {
            let what = format!("found episodes from {first} to {last}, expected episode {wanted}");
            return Err(MovesError::new("episode_index", what, "choose one of them with --episode"));
        }
        if !self.given {
            notes.push(format!(
                "The table has several episodes: {wanted} is taken, {frames} frames of others are left out (--episode)."
            ));
        }
        Ok(())
    }
}

/// The joints of a list: from the data set's `meta/info.json`, else numbered. What is assumed is noted.
pub(super) fn names(path: &Path, list: &str, width: usize, notes: &mut Vec<String>) -> Vec<String> {
    notes.push(format!(
        "'{list}' of a LeRobot table names no unit: degrees, or -100 to 100 of a joint's range, as the robot was set up."
    ));
    let known = info(path, list);
    if let Some(names) = known.as_ref().filter(|names| names.len() == width) {
        return names.clone();
    }
    let why = match known {
        Some(names) => format!("meta/info.json has {} names for the {width} numbers of '{list}'", names.len()),
        None => format!("No meta/info.json names the joints of '{list}'"),
    };
    notes.push(format!("{why}: they are called {list}_0, {list}_1, ..."));
    (0..width).map(|at| format!("{list}_{at}")).collect()
}

/// The names in a data set's `meta/info.json`, beside the file or above it.
fn info(path: &Path, list: &str) -> Option<Vec<String>> {
    let folders = path.ancestors().skip(1).take(4);
    let info = folders.map(|folder| folder.join("meta/info.json")).find(|info| info.is_file())?;
    let info: Value = serde_json::from_str(&files::read_text(&info).ok()?).ok()?;
    let names = info.get("features")?.get(list)?.get("names")?;
    // Older data sets have them under the name of a group.
    let names = names.as_array().or_else(|| names.as_object()?.values().next()?.as_array())?;
    names.iter().map(|name| Some(name.as_str()?.to_owned())).collect()
}
