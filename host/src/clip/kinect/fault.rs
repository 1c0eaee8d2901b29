//! What can be wrong with a Kinect CSV, by line and column.

/// What is wrong with a Kinect recording, and where. Lines count from 1, the header is line 1.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs)] // The messages say what the fields are.
pub enum KinectFault {
    #[error("the file is empty, expected a header 'Timestamp,HipCenterX,...' and one line per frame")]
    Empty,
    #[error("line {line}: not readable as CSV text: {error}. Save the file as UTF-8 CSV with commas")]
    Csv { line: u64, error: String },
    #[error(
        "line 1: the column '{column}' is missing. Expected 'Timestamp' (ms) and X, Y, Z of the 20 Kinect joints \
             (HipCenterX, ..., FootRightZ, metres)"
    )]
    MissingColumn { column: String },
    #[error("line {line}: {found} cells, expected at least {expected}. The line is cut off; complete or remove it")]
    ShortRow { line: u64, found: usize, expected: usize },
    #[error("line {line}, column '{column}': '{found}' is not a number")]
    NotANumber { line: u64, column: String, found: String },
    #[error("line {line}, column 'Timestamp': '{found}' is missing or not finite, expected milliseconds")]
    NoTime { line: u64, found: String },
    #[error(
        "line {line}, column 'Timestamp': the clock goes back to {found} ms from {previous} ms. Sort the lines, or cut \
             the file there"
    )]
    Backward { line: u64, found: f64, previous: f64 },
    #[error(
        "line {line}, column '{column}': values are missing for {seconds:.2} s, at most {limit:.2} s are bridged. \
             Cut the recording there, or allow a longer gap"
    )]
    Gap { line: u64, column: String, seconds: f64, limit: f64 },
    #[error(
        "joint '{joint}' has no value in any row: it was never tracked. Leave out what needs it, or record it; all 20 joints are needed"
    )]
    NeverTracked { joint: &'static str },
    #[error(
        "the unit of length cannot be told: a leg (hip to ankle) of {leg:.4} units fits a human size in none of m, foot, dm, cm, mm. Say which \
             it is (`--units cm`)"
    )]
    UnknownUnits { leg: f64 },
    #[error("only {found} frame(s) with different timestamps, expected at least 2")]
    TooShort { found: usize },
    #[error(
        "the column of time counts {seconds:.4} s over {rows} rows, which is one frame at {fps} fps: it counts in another unit. Write \
             milliseconds or seconds into it"
    )]
    TooFast { rows: usize, seconds: f64, fps: f64 },
    #[error("the frame rate to resample to is {found}, expected a number from 1 to 1000")]
    Rate { found: f64 },
    #[error(
        "the recording lasts {seconds:.0} s by its timestamps, more than a day: they are not milliseconds. Check the \
             column 'Timestamp'"
    )]
    TooLong { seconds: f64 },
    #[error(
        "line {line}: {seconds:.0} s after the line before, at most {limit:.0} s are filled by straight lines. Cut the recording \
             there"
    )]
    Pause { line: u64, seconds: f64, limit: f64 },
    #[error("joint '{joint}' is always at its parent's place, so the bone has no length. The recording holds no body")]
    NoBone { joint: &'static str },
}
