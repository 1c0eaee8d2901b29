//! How a file spells things: kept, so that it is written back as the programs that read it expect it.

use super::{Channel, Extra};

/// Headers, separator and layout of a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Spelling {
    /// Headers of channels.
    pub labels: Vec<(Channel, String)>,
    /// All headers in the order of the file.
    pub order: Vec<String>,
    /// Header of the times, and the seconds that one of its numbers stands for.
    pub time: Option<(String, f64)>,
    /// Header of the numbers of frames.
    pub index: Option<String>,
    /// Between cells.
    pub separator: Option<char>,
    /// Whether a comma stands for the point.
    pub comma: bool,
    /// Key and word of the unit of all channels that name none.
    pub unit: Option<(String, String)>,
    /// Key and value of the rate of a file without times.
    pub rate: Option<(String, f64)>,
    /// Whether JSON has a list of frames, not of joints.
    pub frames: bool,
    /// Name of the list of a LeRobot table.
    pub list: Option<String>,
    /// Lines of comment at the beginning.
    pub comments: Vec<String>,
}

impl Spelling {
    /// Header of a channel: the file's, while it is true.
    pub fn label(&self, at: usize, channel: &Channel) -> String {
        let here = self.labels.get(at).filter(|(own, _)| own == channel);
        let known = here.or_else(|| self.labels.iter().find(|(own, _)| own == channel));
        known.map_or_else(|| channel.header(), |(_, label)| label.clone())
    }
}

/// What a column of a table or a member of a record is.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Slot {
    /// Times; seconds in one of its units.
    Time(f64),
    /// Numbers of frames.
    Index,
    /// Numbers of LeRobot's episodes.
    Episode,
    /// A joint.
    Joint(usize),
    /// LeRobot's list of all joints.
    List,
    /// What is no joint: index of its column.
    Extra(usize),
}

fn is_joint(slot: &Slot) -> bool {
    matches!(slot, Slot::Joint(_))
}

/// Headers of what is written per frame, and what each is, in the order of the file. Joints stand in the order of the channels.
pub(super) fn slots(channels: &[Channel], extra: &Extra, time: &str) -> Vec<(String, Slot)> {
    let spelling = &extra.spelling;
    let mut slots = Vec::new();
    slots.extend(spelling.index.iter().map(|label| (label.clone(), Slot::Index)));
    let (label, seconds) = spelling.time.clone().unwrap_or_else(|| (time.to_owned(), 1.0));
    slots.push((label, Slot::Time(seconds)));
    match &spelling.list {
        Some(list) => slots.push((list.clone(), Slot::List)),
        None => slots.extend(channels.iter().enumerate().map(|(at, own)| (spelling.label(at, own), Slot::Joint(at)))),
    }
    slots.extend(extra.columns.iter().enumerate().map(|(at, label)| (label.clone(), Slot::Extra(at))));
    let place: std::collections::HashMap<&str, usize> =
        spelling.order.iter().enumerate().map(|(at, label)| (label.as_str(), at)).collect();
    let mut joints = slots.iter().filter(|(_, slot)| is_joint(slot)).cloned().collect::<Vec<_>>().into_iter();
    slots.sort_by_key(|(label, _)| place.get(label.as_str()).copied().unwrap_or(usize::MAX));
    let places = slots.iter_mut().filter(|(_, slot)| is_joint(slot));
    places.zip(&mut joints).for_each(|(to, joint)| *to = joint);
    slots
}

/// A time in units of `seconds`, to the nanosecond: sums of frames have more digits than clocks.
pub(super) fn clock(time: f64, seconds: f64) -> f64 {
    let nanoseconds = (time * 1e9).round();
    // Whole divisors, so that 0.02 s is 20 ms and not 20.000000000000004.
    let divisor = (1e9 * seconds).round().max(1.0);
    let value = nanoseconds / divisor;
    value + 0.0
}
