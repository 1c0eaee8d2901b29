//! Tables of mean angles, in degrees: all joints, leaves, inner joints, then joint by joint.

use kinesic_host::measure::Degrees;
use kinesic_host::report::Table;
use kinesic_host::translate::Errors;

/// Heads of the columns and what they hold; a model that the pack knows nothing of is absent.
pub type Columns<'a> = [(&'static str, Option<&'a Degrees>)];

/// What the columns are of.
pub const CAPTION: &str = "mean angle between local rotations, degrees (of sliders: mm); the last model's as swing of the bone and twist about it";
/// Heads of the last two columns.
const SPLIT: [&str; 2] = ["swing", "twist"];
/// What they are, for a report.
const SPLIT_OF: &str = "Swing of the bone and twist about it are the last model's";

/// The figures of a translation, in the order of those in cm.
pub fn columns(errors: &Errors) -> [(&'static str, Option<&Degrees>); 4] {
    let angles = &errors.degrees;
    [
        ("identity", Some(&angles.identity)),
        ("offset", angles.offset.as_ref()),
        ("affine", angles.affine.as_ref()),
        ("pack", Some(&angles.error)),
    ]
}

/// Rows of a table: its name, and a cell for each column. The last column's joints are split into swing and twist.
pub fn rows(columns: &Columns) -> Vec<(String, Vec<String>)> {
    let row = |name: &str, of: &dyn Fn(&Degrees) -> Option<f64>| {
        let cell = |(_, degrees): &(_, Option<&Degrees>)| {
            degrees.and_then(of).map_or_else(|| "-".to_owned(), |angle| format!("{angle:.2}"))
        };
        (name.to_owned(), columns.iter().map(cell).collect::<Vec<String>>())
    };
    let mut rows = [
        row("all joints", &|d| Some(d.all)),
        row("leaves", &|d| Some(d.leaves)),
        row("inner joints", &|d| Some(d.inner)),
    ]
    .to_vec();
    rows.iter_mut().for_each(|(_, cells)| cells.extend(SPLIT.map(|_| String::new())));
    let last = columns.iter().rev().find_map(|(_, degrees)| *degrees);
    for (index, joint) in last.map_or(&[][..], |degrees| &degrees.joints).iter().enumerate() {
        let (name, mut cells) = row(&joint.joint, &|d| d.joints.get(index).map(|joint| joint.angle));
        if joint.millimetres.is_some() {
            let length = |degrees: &Degrees| degrees.joints.get(index).and_then(|joint| joint.millimetres);
            let cell = |(_, degrees): &(_, Option<&Degrees>)| {
                degrees.and_then(length).map_or_else(|| "-".to_owned(), |length| format!("{length:.2} mm"))
            };
            cells = columns.iter().map(cell).chain(SPLIT.map(|_| String::new())).collect();
        } else {
            cells.extend([joint.swing, joint.twist].map(|angle| format!("{angle:.2}")));
        }
        rows.push((name, cells));
    }
    rows
}

/// Prints the table.
pub fn print(columns: &Columns) {
    let heads = columns.iter().map(|(name, _)| *name).chain(SPLIT).map(str::to_owned).collect();
    for (name, cells) in std::iter::once(("joint".to_owned(), heads)).chain(rows(columns)) {
        println!("{}   {name}", cells.iter().map(|cell| format!("{cell:>10}")).collect::<String>());
    }
}

/// The table of a report.
pub fn table(columns: &Columns, caption: &str) -> Table {
    let heads = columns.iter().map(|(name, _)| *name).chain(SPLIT);
    Table {
        caption: format!(
            "{caption}, degrees: mean geodesic angle between local rotations, the root's tilt. {SPLIT_OF}"
        ),
        head: std::iter::once("joint").chain(heads).map(str::to_owned).collect(),
        rows: rows(columns).into_iter().map(|(name, cells)| std::iter::once(name).chain(cells).collect()).collect(),
    }
}
