//! The CSV table: timestamps and 20 positions a row.

use nalgebra::Vector3;

use super::{JOINTS, KinectFault, Skeleton20};

/// The rows of a recording, in file order. Missing numbers are NaN.
pub(super) struct Table {
    /// Line in the file of each row.
    pub lines: Vec<u64>,
    /// Seconds since the first row.
    pub times: Vec<f64>,
    /// Positions `[rows][20]`, camera coordinates, m.
    pub rows: Vec<Skeleton20>,
    /// Rows dropped because their timestamp was that of the row before.
    pub repeated: usize,
}

pub(super) fn read(bytes: &[u8]) -> Result<Table, KinectFault> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    if bytes.trim_ascii().is_empty() {
        return Err(KinectFault::Empty);
    }
    let mut reader = csv::ReaderBuilder::new().flexible(true).trim(csv::Trim::All).from_reader(bytes);
    let broken = |e: csv::Error| KinectFault::Csv { line: e.position().map_or(1, |p| p.line()), error: e.to_string() };
    let header = reader.headers().map_err(broken)?.clone();
    let find = |column: String| match header.iter().position(|h| h.eq_ignore_ascii_case(&column)) {
        Some(at) => Ok((at, column)),
        None => Err(KinectFault::MissingColumn { column }),
    };
    let time_column = find("Timestamp".into())?;
    let mut columns = Vec::with_capacity(3 * JOINTS.len());
    for (joint, _) in JOINTS {
        for axis in ["X", "Y", "Z"] {
            columns.push(find(format!("{joint}{axis}"))?);
        }
    }
    let expected = 1 + columns.iter().map(|c| c.0).max().unwrap_or(0).max(time_column.0);

    let mut table = Table { lines: Vec::new(), times: Vec::new(), rows: Vec::new(), repeated: 0 };
    let (mut first, mut previous) = (None, f64::NEG_INFINITY);
    let mut record = csv::StringRecord::new();
    while reader.read_record(&mut record).map_err(broken)? {
        let line = record.position().map_or(0, |p| p.line());
        if record.len() < expected {
            return Err(KinectFault::ShortRow { line, found: record.len(), expected });
        }
        let time = number(&record, &time_column, line)?;
        if !time.is_finite() {
            let found = record.get(time_column.0).unwrap_or_default().into();
            return Err(KinectFault::NoTime { line, found });
        }
        if time < previous {
            return Err(KinectFault::Backward { line, found: time, previous });
        }
        if time == previous {
            table.repeated += 1;
            continue;
        }
        previous = time;
        let mut row = [Vector3::zeros(); 20];
        for (position, columns) in row.iter_mut().zip(columns.chunks_exact(3)) {
            for (value, column) in position.iter_mut().zip(columns) {
                *value = number(&record, column, line)?;
            }
        }
        table.lines.push(line);
        table.times.push((time - *first.get_or_insert(time)) / 1000.0);
        table.rows.push(row);
    }
    Ok(table)
}

/// A cell's number; NaN where the cell is empty or says so.
fn number(record: &csv::StringRecord, (at, name): &(usize, String), line: u64) -> Result<f64, KinectFault> {
    let text = record.get(*at).unwrap_or_default();
    if text.is_empty() {
        return Ok(f64::NAN);
    }
    match text.parse::<f64>() {
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
