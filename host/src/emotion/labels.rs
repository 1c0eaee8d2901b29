//! Tables of labelled motions: which file, what it shows, and how strongly.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use crate::files;

/// Why a table cannot be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{}{}: {fault}", path.display(), line.map(|line| format!(":{line}")).unwrap_or_default())]
pub struct LabelsError {
    /// The table.
    pub path: PathBuf,
    /// Where in it.
    pub line: Option<u64>,
    /// What is wrong.
    pub fault: LabelsFault,
}

/// What is wrong with a table.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LabelsFault {
    /// It cannot be opened or split into columns.
    #[error("cannot be read: {0}")]
    Unreadable(String),
    /// A column is missing.
    #[error(
        "there is no column {missing:?}; expected a tab-separated table with a line of names first, found: {found}"
    )]
    Column {
        /// What it is called.
        missing: String,
        /// The columns that there are.
        found: String,
    },
    /// A strength is no number.
    #[error("column {column:?}: found {found:?}, expected a number, or nothing where nobody judged")]
    Number {
        /// Which column.
        column: String,
        /// What is there.
        found: String,
    },
    /// A row without a file.
    #[error("the column file is empty")]
    NoFile,
    /// A clip that is not there.
    #[error("the clip {} does not exist; paths start from the table's folder", .0.display())]
    Missing(PathBuf),
    /// A label of the order that no row has.
    #[error("no row is labelled {missing:?}, as --order wants; the labels are: {found}")]
    Label {
        /// The label.
        missing: String,
        /// Those that there are.
        found: String,
    },
    /// Nothing to rank by.
    #[error("no row says anything about {0:?}: its label is in no order, its strength is empty")]
    Nothing(String),
    /// All strengths are the same.
    #[error("all {rows} rows have the same {attribute:?}: nothing shows more or less of it")]
    OneLevel {
        /// Which attribute.
        attribute: String,
        /// Rows that have it.
        rows: usize,
    },
}

/// Something that motions show more or less of, and where the table says how much.
#[derive(Clone, Debug, PartialEq)]
pub struct Attribute {
    /// Name, as in the pack.
    pub name: String,
    /// Where its levels come from.
    pub levels: Levels,
}

/// How notes about attributes begin.
const ORDER: &str = "order ";
const COLUMN: &str = "strengths in column ";

/// Where levels come from.
#[derive(Clone, Debug, PartialEq)]
pub enum Levels {
    /// Labels, strongest first; those of one step show it alike.
    Order(Vec<Vec<String>>),
    /// Numbers in the column of the attribute's name.
    Column,
}

impl Attribute {
    /// From `happy>normal>sad`, `anger: angry>normal=sad`: the name is the strongest label unless it is given.
    pub fn from_order(text: &str) -> Result<Self, String> {
        let (name, order) = text.split_once(':').map_or((None, text), |(name, order)| (Some(name.trim()), order));
        let step = |step: &str| step.split('=').map(|label| label.trim().to_owned()).collect::<Vec<String>>();
        let steps: Vec<Vec<String>> = order.split('>').map(step).collect();
        let mut labels: Vec<&String> = steps.iter().flatten().collect();
        labels.sort();
        if steps.len() < 2 || labels.iter().any(|label| label.is_empty()) || name == Some("") {
            return Err(
                "expected labels from strongest to weakest, as in happy>normal>sad or anger:angry>normal=sad".into()
            );
        }
        if let Some(twice) = labels.windows(2).find(|pair| pair[0] == pair[1]) {
            return Err(format!("the label {:?} is there twice", twice[0]));
        }
        let name = name.map_or_else(|| steps[0][0].clone(), str::to_owned);
        Ok(Self { name, levels: Levels::Order(steps) })
    }

    /// From the name of a column of numbers.
    pub fn from_column(name: &str) -> Self {
        Self { name: name.to_owned(), levels: Levels::Column }
    }

    /// For the pack's notes, so that a pack knows what it was trained on.
    pub fn note(&self) -> String {
        match &self.levels {
            Levels::Column => format!("{COLUMN}{}", self.name),
            Levels::Order(steps) => {
                let steps: Vec<String> = steps.iter().map(|step| step.join("=")).collect();
                format!("{ORDER}{}:{}", self.name, steps.join(">"))
            }
        }
    }

    /// What a note of [`note`](Self::note) says; `None` for any other note.
    pub fn from_note(note: &str) -> Option<Self> {
        let order = note.strip_prefix(ORDER).and_then(|order| Self::from_order(order).ok());
        order.or_else(|| note.strip_prefix(COLUMN).map(Self::from_column))
    }

    /// Level of a label: 1 the strongest, 0 the weakest, steps between evenly spaced.
    fn level(&self, label: &str) -> Option<f64> {
        let Levels::Order(steps) = &self.levels else { return None };
        let step = steps.iter().position(|step| step.iter().any(|known| known == label))?;
        Some(1.0 - step as f64 / (steps.len() - 1) as f64)
    }
}

/// One row of the table.
#[derive(Clone, Debug, PartialEq)]
pub struct Labelled {
    /// The clip.
    pub path: PathBuf,
    /// Strength of every attribute, `None` where the row says nothing.
    pub levels: Vec<Option<f64>>,
    /// Only clips of one group are compared: column `group`, all the same without it.
    pub group: usize,
    /// Clips of one take are held out together: column `take`, every file by itself without it.
    pub take: usize,
}

/// Reads a tab-separated table: a column `file` (paths from the table's folder), `label` or a column of numbers for each
/// attribute, and optionally `group` and `take` (or `subject`, if there is no take). Rows that say nothing are left out.
pub fn read(path: &Path, attributes: &[Attribute]) -> Result<Vec<Labelled>, LabelsError> {
    let error = |line: Option<u64>, fault| LabelsError { path: path.to_owned(), line, fault };
    let unreadable = |e: csv::Error| {
        let line = e.position().map(csv::Position::line);
        error(line, LabelsFault::Unreadable(e.to_string()))
    };
    let bytes = files::read(path).map_err(|error| unreadable(error.into()))?;
    let mut reader = csv::ReaderBuilder::new().delimiter(b'\t').quoting(false).flexible(true).from_reader(&bytes[..]);
    let names: Vec<String> = reader.headers().map_err(unreadable)?.iter().map(|name| name.trim().to_owned()).collect();
    let optional = |name: &str| names.iter().position(|known| known == name);
    let column = |name: &str| {
        let missing = || LabelsFault::Column { missing: name.to_owned(), found: names.join(", ") };
        optional(name).ok_or_else(|| error(Some(1), missing()))
    };
    let file = column("file")?;
    let sources = attributes
        .iter()
        .map(|attribute| match attribute.levels {
            Levels::Order(_) => column("label"),
            Levels::Column => column(&attribute.name),
        })
        .collect::<Result<Vec<usize>, _>>()?;
    let (group, take) = (optional("group"), optional("take").or(optional("subject")));
    let folder = path.parent().unwrap_or(Path::new(""));
    let (mut groups, mut takes, mut labels) = (Numbers::default(), Numbers::default(), Vec::new());
    let mut rows = Vec::new();
    for record in reader.records() {
        let record = record.map_err(unreadable)?;
        let line = record.position().map(csv::Position::line);
        let field = |column: usize| record.get(column).unwrap_or("").trim();
        let name = field(file);
        if name.is_empty() {
            return Err(error(line, LabelsFault::NoFile));
        }
        let level = |(attribute, source): (&Attribute, &usize)| match attribute.levels {
            Levels::Order(_) => Ok(attribute.level(field(*source))),
            Levels::Column => match field(*source) {
                "" => Ok(None),
                text => match text.parse::<f64>() {
                    Ok(level) if level.is_finite() => Ok(Some(level)),
                    _ => {
                        let (column, found) = (attribute.name.clone(), text.to_owned());
                        Err(error(line, LabelsFault::Number { column, found }))
                    }
                },
            },
        };
        let levels = attributes.iter().zip(&sources).map(level).collect::<Result<Vec<_>, _>>()?;
        if let Some(label) = optional("label") {
            labels.push(field(label).to_owned());
        }
        if levels.iter().all(Option::is_none) {
            continue;
        }
        let clip = folder.join(name);
        if !clip.is_file() {
            return Err(error(line, LabelsFault::Missing(clip)));
        }
        rows.push(Labelled {
            path: clip,
            levels,
            group: group.map_or(0, |column| groups.of(field(column))),
            take: takes.of(take.map_or(name, field)),
        });
    }
    labels.sort();
    labels.dedup();
    check(attributes, &rows, &labels).map_err(|fault| error(None, fault))?;
    Ok(rows)
}

/// What no row by itself can say.
fn check(attributes: &[Attribute], rows: &[Labelled], labels: &[String]) -> Result<(), LabelsFault> {
    for (index, attribute) in attributes.iter().enumerate() {
        if let Levels::Order(steps) = &attribute.levels
            && let Some(missing) = steps.iter().flatten().find(|label| labels.binary_search(label).is_err())
        {
            return Err(LabelsFault::Label { missing: missing.clone(), found: labels.join(", ") });
        }
        let levels: Vec<f64> = rows.iter().filter_map(|row| row.levels[index]).collect();
        match levels.first() {
            None => return Err(LabelsFault::Nothing(attribute.name.clone())),
            Some(first) if levels.iter().all(|level| level == first) => {
                return Err(LabelsFault::OneLevel { attribute: attribute.name.clone(), rows: levels.len() });
            }
            Some(_) => {}
        }
    }
    Ok(())
}

/// Names, numbered in the order in which they appear.
#[derive(Default)]
struct Numbers(HashMap<String, usize>);

impl Numbers {
    fn of(&mut self, name: &str) -> usize {
        let next = self.0.len();
        *self.0.entry(name.to_owned()).or_insert(next)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(text: &str, attributes: &[Attribute]) -> Result<Vec<Labelled>, LabelsError> {
        let folder = tempfile::tempdir().unwrap();
        for name in ["a.bvh", "b.bvh", "c.bvh"] {
            std::fs::write(folder.path().join(name), "").unwrap();
        }
        let path = folder.path().join("labels.tsv");
        std::fs::write(&path, text).unwrap();
        read(&path, attributes)
    }

    #[test]
    fn orders_and_columns_become_levels() {
        let mood = Attribute::from_order("happy > normal=calm > sad").unwrap();
        let anger = Attribute::from_order("anger:angry>normal").unwrap();
        assert_eq!((mood.name.as_str(), anger.name.as_str()), ("happy", "anger"));
        for attribute in [&mood, &anger, &Attribute::from_column("speed")] {
            assert_eq!(Attribute::from_note(&attribute.note()).as_ref(), Some(attribute));
        }
        assert_eq!(Attribute::from_note("nothing of the kind"), None);
        let text = "label\tfile\tgroup\ttake\tspeed\nhappy\ta.bvh\twalk\t1\t0.5\ncalm\tb.bvh\trun\t2\t\n\
                    angry\tc.bvh\twalk\t1\t\nsad\tb.bvh\twalk\t1\t2\nnormal\tc.bvh\t\t\t\nelse\tgone.bvh\t\t\t";
        let rows = table(text, &[mood, anger, Attribute::from_column("speed")]).unwrap();
        let levels: Vec<_> = rows.iter().map(|row| row.levels.clone()).collect();
        assert_eq!(levels[0], [Some(1.0), None, Some(0.5)]);
        assert_eq!(levels[1], [Some(0.5), None, None]);
        assert_eq!(levels[2], [None, Some(1.0), None]);
        assert_eq!(levels[3], [Some(0.0), None, Some(2.0)]);
        assert_eq!(levels[4], [Some(0.5), Some(0.0), None]);
        assert_eq!(rows.len(), 5, "a row that says nothing is not opened");
        let places: Vec<_> = rows.iter().map(|row| (row.group, row.take)).collect();
        assert_eq!(places, [(0, 0), (1, 1), (0, 0), (0, 0), (2, 2)]);
    }

    #[test]
    fn orders_that_say_nothing_are_refused() {
        for text in ["", "happy", "happy>", "a>b>a", ":a>b", "a=a>b"] {
            assert!(Attribute::from_order(text).is_err(), "{text}");
        }
    }

    #[test]
    fn faults_name_the_line_and_what_is_there() {
        let order = [Attribute::from_order("happy>sad").unwrap()];
        let fault = |text: &str| table(text, &order).unwrap_err();
        assert!(matches!(fault("clip\tlabel\n").fault, LabelsFault::Column { .. }));
        let missing = fault("file\tlabel\na.bvh\thappy\nz.bvh\tsad\n");
        assert!(matches!(missing.fault, LabelsFault::Missing(_)) && missing.line == Some(3));
        assert_eq!(fault("file\tlabel\n\thappy\n").fault, LabelsFault::NoFile);
        let unknown = fault("file\tlabel\na.bvh\thappy\nb.bvh\tcalm\n").fault;
        assert_eq!(unknown, LabelsFault::Label { missing: "sad".into(), found: "calm, happy".into() });
        let column = [Attribute::from_column("s")];
        let number = table("file\ts\na.bvh\t1\nb.bvh\tmuch\n", &column).unwrap_err();
        assert!(matches!(number.fault, LabelsFault::Number { .. }) && number.line == Some(3));
        let one = table("file\ts\na.bvh\t1\nb.bvh\t1\n", &column).unwrap_err().fault;
        assert_eq!(one, LabelsFault::OneLevel { attribute: "s".into(), rows: 2 });
        assert_eq!(table("file\ts\na.bvh\t\n", &column).unwrap_err().fault, LabelsFault::Nothing("s".into()));
        assert!(matches!(read(Path::new("/nowhere.tsv"), &column).unwrap_err().fault, LabelsFault::Unreadable(_)));
    }
}
