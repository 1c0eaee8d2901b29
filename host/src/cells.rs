//! Tables as text: which sign separates their cells, and names of columns whatever their case and separators.

/// A reader of rows whose cells are separated by whatever separates most cells of the first line, and that sign.
pub fn reader(bytes: &[u8]) -> (u8, csv::Reader<&[u8]>) {
    let header = bytes.split(|b| matches!(b, b'\n' | b'\r')).next().unwrap_or(&[]);
    let count = |separator: &u8| header.iter().filter(|b| *b == separator).count();
    // The last of the most: a comma where the line has none of them.
    let separator = [b'\t', b';', b','].into_iter().max_by_key(count).unwrap_or(b',');
    let reader = csv::ReaderBuilder::new().flexible(true).trim(csv::Trim::All).delimiter(separator).from_reader(bytes);
    (separator, reader)
}

/// A column's name without case and separators: `HipCenter_X` and `hipcenter.x` are `HipCenterX`.
pub fn plain(name: &str) -> String {
    name.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect()
}
