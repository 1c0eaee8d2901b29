//! What the columns of a table are: one look over all of it, before its numbers are taken.

use super::build::{is_index, time_unit};
use super::error::shown;
use super::spelling::{Slot, Spelling};
use super::table::{Rows, number, separator};
use super::{Channel, MovesError, Options, lerobot};

/// The columns of a table.
pub(super) struct Columns {
    pub separator: char,
    /// All headers.
    pub names: Vec<String>,
    /// One per header.
    pub slots: Vec<Slot>,
    /// Headers of joints.
    pub labels: Vec<String>,
    /// Headers of what is no joint.
    pub columns: Vec<String>,
    pub spelling: Spelling,
    pub notes: Vec<String>,
    /// LeRobot's list.
    pub list: Option<&'static str>,
}

/// The columns of a table, by their headers and by how many of their cells are numbers.
pub(super) fn of(text: &str) -> Result<Columns, MovesError> {
    let comment = |line: &&str| line.trim().is_empty() || line.starts_with('#');
    let header = text.lines().find(|line| !comment(line)).unwrap_or("");
    let separator = separator(header);
    let (names, mut rows) = Rows::new(text, separator)?;
    let line = 1 + text.lines().take_while(comment).count();
    if names.iter().all(|name| number(name, separator).is_some()) {
        let what = "found numbers in the first line, expected the names of the joints";
        return Err(MovesError::new(
            format!("line {line}"),
            what,
            "put a header above them, as in time_s,pan_deg,tilt_deg",
        ));
    }
    let mut seen = std::collections::HashSet::new();
    for (at, name) in names.iter().enumerate().filter(|(_, name)| !name.is_empty()) {
        if !seen.insert(name.as_str()) {
            let what = format!("found the joint {} twice", shown(name));
            return Err(MovesError::new(format!("line {line}, column {}", at + 1), what, "name every joint once"));
        }
    }
    let (mut numbers, mut frames) = (vec![0_usize; names.len()], 0);
    let mut row = csv::StringRecord::new();
    while rows.next(&mut row)?.is_some() {
        frames += 1;
        for (count, cell) in numbers.iter_mut().zip(&row) {
            *count += usize::from(number(cell, separator).is_some());
        }
    }
    if frames == 0 {
        return Err(MovesError::new("", "found a header without rows, expected frames below it", "is the file whole?"));
    }
    let mut found = Columns {
        separator,
        slots: Vec::new(),
        labels: Vec::new(),
        columns: Vec::new(),
        spelling: Spelling { separator: Some(separator), order: names.clone(), ..Spelling::default() },
        notes: Vec::new(),
        list: lerobot::chosen(names.iter().map(String::as_str)),
        names: Vec::new(),
    };
    found.spelling.list = found.list.map(str::to_owned);
    found.spelling.comments =
        text.lines().take_while(comment).filter(|line| line.starts_with('#')).map(str::to_owned).collect();
    let comments = text.lines().filter(|line| line.starts_with('#')).count();
    if comments > found.spelling.comments.len() {
        found.notes.push("Lines of comment between the frames are left out.".into());
    }
    for (name, numbers) in names.iter().zip(numbers) {
        let slot = found.slot(name, [numbers, frames]);
        found.slots.push(slot);
    }
    Ok(Columns { names, ..found })
}

impl Columns {
    /// What a column is, `numbers` of whose `frames` cells are numbers.
    fn slot(&mut self, name: &str, [numbers, frames]: [usize; 2]) -> Slot {
        let unit = Channel::from_header(name).unit.is_some();
        match time_unit(name) {
            Some(seconds) if self.spelling.time.is_none() && 2 * numbers > frames => {
                self.spelling.time = Some((name.to_owned(), seconds));
                return Slot::Time(seconds);
            }
            Some(_) => {
                self.notes.push(format!("A further column of times is no joint: {}.", shown(name)));
                return self.extra(name);
            }
            None => {}
        }
        if is_index(name) && self.spelling.index.is_none() {
            self.spelling.index = Some(name.to_owned());
            return Slot::Index;
        }
        if self.list.is_some() {
            if self.list == Some(name) {
                return Slot::List;
            }
            let slot = self.extra(name);
            return if name == "episode_index" { Slot::Episode } else { slot };
        }
        // A unit makes it a joint, whatever is in it. So do numbers in more than a few of its cells.
        if unit && numbers > 0 || 10 * numbers > frames {
            self.labels.push(name.to_owned());
            return Slot::Joint(self.labels.len() - 1);
        }
        if numbers > 0 {
            self.notes.push(format!(
                "Column {} is no joint: it has text in {} of {frames} frames.",
                shown(name),
                frames - numbers
            ));
        }
        self.extra(name)
    }

    fn extra(&mut self, name: &str) -> Slot {
        self.columns.push(name.to_owned());
        Slot::Extra(self.columns.len() - 1)
    }
}

/// Whether it is the header of the table that `Clip::to_angles` writes.
pub(super) fn is_angles(names: &[String]) -> bool {
    let ends = ["_x_m", "_y_m", "_z_m", "_z_deg", "_x_deg", "_y_deg"];
    let starts = names.iter().map(String::as_str).take(2).eq(["frame", "time_s"]);
    starts && names.len() >= 8 && names.iter().skip(2).zip(ends).all(|(name, end)| name.ends_with(end))
}

/// When frames are due, by their numbers, where these leave some out.
pub(super) fn gaps(indices: &[f64], frames: usize, options: &Options, notes: &mut Vec<String>) -> Option<Vec<f64>> {
    let rate = options.rate.filter(|rate| rate.is_finite() && *rate > 0.0)?;
    let rising = indices.len() == frames && indices.windows(2).all(|pair| matches!(pair, [a, b] if b > a));
    let first = indices.first()?;
    let even = indices.iter().zip(0..).all(|(index, at)| index - first == f64::from(at));
    if !rising || even {
        return None;
    }
    notes.push("The numbers of the frames leave gaps: frames are put where their numbers say.".into());
    Some(indices.iter().map(|index| (index - first) / rate).collect())
}
