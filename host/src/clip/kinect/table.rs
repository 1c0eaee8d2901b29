//! The CSV table: timestamps and 20 positions a row.

use nalgebra::Vector3;

use super::{JOINTS, KinectFault, Skeleton20};
use crate::cells::{plain, reader};
use crate::clip::bvh::text::utf16;

/// The rows of a recording, in file order. Missing numbers are NaN.
#[derive(Default)]
pub(super) struct Table {
    /// Line in the file of each row.
    pub lines: Vec<u64>,
    /// Seconds since the first row.
    pub times: Vec<f64>,
    /// Positions `[rows][20]`, camera coordinates, m.
    pub rows: Vec<Skeleton20>,
    /// Rows dropped because their timestamp was that of the row before.
    pub repeated: usize,
    /// Of these, rows in which the body is at another place.
    pub elsewhere: usize,
    /// What was made of the clock and of several people.
    pub notes: Vec<String>,
}

/// Other names of the joints of the trunk: the second Kinect's, then Azure's.
const ALIASES: [(&str, &[&str]); 3] = [
    ("hipcenter", &["spinebase", "pelvis"]),
    ("spine", &["spinemid", "spinenavel"]),
    ("shouldercenter", &["spineshoulder", "neck"]),
];
/// Columns of time, and of who it is.
const CLOCKS: [&str; 6] = ["timestamp", "time", "timestampms", "timems", "frame", "framenumber"];
const PEOPLE: [&str; 10] =
    ["bodyid", "bodyindex", "body", "trackingid", "personid", "person", "userid", "skeletonid", "playerid", "player"];

/// Whether a line names the columns of such a table.
pub(in crate::clip) fn is_header(line: &str) -> bool {
    let line = plain(line);
    ALIASES[..1].iter().any(|(name, others)| {
        std::iter::once(name).chain(*others).any(|name| line.contains(&format!("{name}x")))
            && line.contains("kneeleftx")
    })
}

pub(super) fn read(bytes: &[u8]) -> Result<Table, KinectFault> {
    let wide = utf16(bytes);
    let bytes = wide.as_ref().map_or(bytes, |text| text.trim_start_matches('\u{feff}').as_bytes());
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    if bytes.trim_ascii().is_empty() {
        return Err(KinectFault::Empty);
    }
    let (separator, mut reader) = reader(bytes);
    let broken = |e: csv::Error| KinectFault::Csv { line: e.position().map_or(1, |p| p.line()), error: e.to_string() };
    let header = reader.headers().map_err(broken)?.clone();
    let names: Vec<String> = header.iter().map(plain).collect();
    let find = |name: &str| names.iter().position(|n| n == name);
    let first = |all: &[&str]| all.iter().find_map(|name| find(name));
    let time_at = first(&CLOCKS).ok_or(KinectFault::MissingColumn { column: "Timestamp".into() })?;
    let time_column = (time_at, header.get(time_at).unwrap_or_default().to_owned());
    let body_column = first(&PEOPLE);
    let body = body_column.map(|at| commonest(bytes, at));
    let mut others = 0;
    let mut columns = Vec::with_capacity(3 * JOINTS.len());
    for (joint, _) in JOINTS {
        let own = joint.to_lowercase();
        let other = ALIASES.iter().find(|(name, _)| *name == own).map_or(&[][..], |(_, others)| others);
        for axis in ["X", "Y", "Z"] {
            let named = |name: &str| find(&format!("{name}{}", axis.to_lowercase()));
            let column = format!("{joint}{axis}");
            let at = named(&own).or_else(|| other.iter().find_map(|name| named(name)));
            columns.push((at.ok_or_else(|| KinectFault::MissingColumn { column: column.clone() })?, column));
        }
    }
    let number = |record: &csv::StringRecord, column: &(usize, String), line: u64| {
        number(record, column, line, separator != b',')
    };
    let expected = 1 + columns.iter().map(|c| c.0).max().unwrap_or(0).max(time_column.0);

    let mut table = Table::default();
    let (mut first, mut previous) = (None, f64::NEG_INFINITY);
    let mut record = csv::StringRecord::new();
    while reader.read_record(&mut record).map_err(broken)? {
        let line = record.position().map_or(0, |p| p.line());
        if record.len() < expected {
            return Err(KinectFault::ShortRow { line, found: record.len(), expected });
        }
        if let (Some(at), Some(body)) = (body_column, &body)
            && record.get(at).unwrap_or_default() != body
        {
            others += 1;
            continue;
        }
        let time = number(&record, &time_column, line)?;
        if !time.is_finite() {
            let found = record.get(time_column.0).unwrap_or_default().into();
            return Err(KinectFault::NoTime { line, found });
        }
        if time < previous {
            return Err(KinectFault::Backward { line, found: time, previous });
        }
        let mut row = [Vector3::zeros(); 20];
        for (position, columns) in row.iter_mut().zip(columns.chunks_exact(3)) {
            for (value, column) in position.iter_mut().zip(columns) {
                *value = number(&record, column, line)?;
            }
        }
        if let Some(known) = table.rows.last().filter(|_| time == previous) {
            table.repeated += 1;
            // Elsewhere by half a trunk: another person.
            let trunk = (known[3] - known[0]).norm();
            table.elsewhere += usize::from((known[0] - row[0]).norm() > trunk / 2.0);
            continue;
        }
        previous = time;
        table.lines.push(line);
        table.times.push(time - *first.get_or_insert(time));
        table.rows.push(row);
    }
    if others > 0 {
        let body = body.unwrap_or_default();
        table.notes.push(format!(
            "Several people: '{body}' has the most rows and is read, {others} row(s) of others are left out."
        ));
    }
    let seconds = clock(&table.times, &time_column.1, &mut table.notes);
    table.times.iter_mut().for_each(|t| *t *= seconds);
    Ok(table)
}

/// The commonest value of a column, the first where two are as common.
fn commonest(bytes: &[u8], column: usize) -> String {
    let (_, mut reader) = reader(bytes);
    let mut counts: Vec<(String, usize)> = Vec::new();
    for record in reader.records().flatten() {
        let value = record.get(column).unwrap_or_default();
        match counts.iter_mut().find(|(known, _)| known == value) {
            Some((_, count)) => *count += 1,
            None => counts.push((value.to_owned(), 1)),
        }
    }
    let most = counts.iter().map(|(_, count)| *count).max();
    counts.into_iter().find(|(_, count)| Some(*count) == most).map_or(String::new(), |(value, _)| value)
}

/// Seconds a unit of the clock: milliseconds, unless rows would then come faster than any sensor gives them, or too slowly.
fn clock(times: &[f64], name: &str, notes: &mut Vec<String>) -> f64 {
    let mut steps: Vec<f64> = times.windows(2).map(|w| w[1] - w[0]).collect();
    steps.sort_by(f64::total_cmp);
    let Some(&step) = steps.get(steps.len() / 2) else { return 1e-3 };
    // No sensor gives more than 250 rows a second.
    let numbers = times.iter().all(|t| t.fract() == 0.0) && (step < 4.0 || plain(name).starts_with("frame"));
    let (seconds, what) = match step {
        _ if numbers => (1.0 / 30.0, "frame numbers, 30 of them a second assumed"),
        s if s < 1.0 => (1.0, "seconds"),
        s if s < 5000.0 => (1e-3, ""),
        s if s < 150_000.0 => (1e-6, "microseconds"),
        s if s < 5e6 => (1e-7, "units of 100 ns"),
        _ => (1e-9, "nanoseconds"),
    };
    if !what.is_empty() {
        notes.push(format!("The clock '{name}' counts {what} (its median step is {step})."));
    }
    seconds
}

/// A cell's number; NaN where the cell is empty or says so. A comma may be its point where it separates no cells.
fn number(
    record: &csv::StringRecord,
    (at, name): &(usize, String),
    line: u64,
    commas: bool,
) -> Result<f64, KinectFault> {
    let text = record.get(*at).unwrap_or_default();
    if text.is_empty() {
        return Ok(f64::NAN);
    }
    let pointed = if commas { text.replace(',', ".") } else { text.to_owned() };
    match pointed.parse::<f64>() {
        Ok(value) if value.is_infinite() => Ok(f64::NAN),
        Ok(value) => Ok(value),
        Err(_) => Err(KinectFault::NotANumber { line, column: name.clone(), found: text.into() }),
    }
}

/// Bridges missing numbers by straight lines, up to `limit` seconds; returns how many rows were touched.
pub(super) fn bridge(table: &mut Table, limit: f64) -> Result<usize, KinectFault> {
    let mut touched = vec![false; table.rows.len()];
    for joint in 0..JOINTS.len() {
        for axis in 0..3 {
            bridge_channel(table, joint, axis, limit, &mut touched)?;
        }
    }
    Ok(touched.into_iter().filter(|&t| t).count())
}

fn bridge_channel(
    table: &mut Table,
    joint: usize,
    axis: usize,
    limit: f64,
    touched: &mut [bool],
) -> Result<(), KinectFault> {
    let known: Vec<usize> = (0..table.rows.len()).filter(|&r| table.rows[r][joint][axis].is_finite()).collect();
    let mut next = 0;
    for (row, touched) in touched.iter_mut().enumerate() {
        while known.get(next).is_some_and(|&k| k < row) {
            next += 1;
        }
        if known.get(next) == Some(&row) {
            continue;
        }
        // At the ends the nearest known value holds.
        let (before, after) = (next.checked_sub(1).and_then(|i| known.get(i)), known.get(next));
        let ends = (*before.or(after).unwrap_or(&0), *after.or(before).unwrap_or(&0));
        let (from, to) = (table.times[ends.0.min(row)], table.times[ends.1.max(row)]);
        if known.is_empty() || to - from > limit {
            let column = format!("{}{}", JOINTS[joint].0, ["X", "Y", "Z"][axis]);
            return Err(KinectFault::Gap { line: table.lines[row], column, seconds: to - from, limit });
        }
        let (a, b) = (table.rows[ends.0][joint][axis], table.rows[ends.1][joint][axis]);
        let span = table.times[ends.1] - table.times[ends.0];
        let part = if span > 0.0 { (table.times[row] - table.times[ends.0]) / span } else { 0.0 };
        table.rows[row][joint][axis] = a + (b - a) * part;
        *touched = true;
    }
    Ok(())
}
