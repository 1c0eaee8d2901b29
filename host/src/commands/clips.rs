//! Arguments that name clips and pairs of clips.

use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use clap::Args;
use kinesic::Pack;
use kinesic_host::clip::formats::READERS;
use kinesic_host::clip::{NoteLog, ReadOptions, SkeletonMap, Unit, UpAxis};
use kinesic_host::pack::PackFile;
use kinesic_host::prepare::fingerprint;
use kinesic_host::robot::Machine;
use kinesic_host::{files, moves};
use miette::{IntoDiagnostic, miette};

/// How clips are read.
#[derive(Args, Clone, Debug, Default)]
pub struct Reading {
    /// Skeleton map (TOML) that says which joint is which, for skeletons with unknown joint names
    #[arg(long, value_name = "FILE")]
    pub map: Option<PathBuf>,
    /// Unit of length of the files: m, cm, mm, inch, cmu, dm, foot, mmd, or metres a unit like 0.08 (default: found from the size of the
    /// skeleton)
    #[arg(long, value_name = "UNIT")]
    pub units: Option<Unit>,
    /// Up axis of the files: x, y, z, -x, -y or -z (default: found from rest pose and motion)
    #[arg(long, value_name = "AXIS", allow_hyphen_values = true)]
    pub up: Option<UpAxis>,
    /// Which hand the files' axes are of
    #[arg(long, value_enum, default_value_t = Hand::Right)]
    pub handed: Hand,
    /// Which figure of a file with several: the name of its ROOT (default: the first)
    #[arg(long, value_name = "NAME")]
    pub root: Option<String>,
    /// Bridge lost frames and single frames that leap
    #[arg(long)]
    pub repair: bool,
    /// Refuse a file about which something would be assumed
    #[arg(long)]
    pub strict: bool,
    /// Robot whose motions the files hold, as `kinesic robot import` makes it; a pack trained on one knows its own
    #[arg(long, value_name = "ROBOT.kin")]
    pub robot: Option<PathBuf>,
    /// What a robot's angles are counted in where the file does not say it: deg, rad, ticks or us (default: as the robot's servos)
    #[arg(long, value_name = "UNIT", value_parser = angles)]
    pub angles: Option<moves::Unit>,
    /// Frames per second of a robot's motion whose file has no times
    #[arg(long, value_name = "RATE")]
    pub rate: Option<f64>,
    /// Which episode of a table with several (default: the first)
    #[arg(long, value_name = "N")]
    pub episode: Option<u64>,
}

/// A unit of angles from the command line.
fn angles(text: &str) -> Result<moves::Unit, String> {
    let angle = |unit: &moves::Unit| !matches!(unit, moves::Unit::Metres | moves::Unit::Millimetres);
    moves::unit_of(text).filter(angle).ok_or_else(|| "expected deg, rad, ticks or us".to_owned())
}

/// The robot of a pack that `kinesic robot import` made, or that was trained on one.
pub fn robot(path: &Path) -> miette::Result<Machine> {
    let file = PackFile::read(path).into_diagnostic()?;
    let machine = Machine::from_pack(&file.pack().into_diagnostic()?).into_diagnostic()?;
    machine.ok_or_else(|| {
        miette!(
            help = "make one: kinesic robot import robot.urdf --out robot.kin",
            "{}: found a pack without servos, expected one of a robot",
            path.display()
        )
    })
}

/// Handedness of axes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum Hand {
    /// X right, Y up, Z towards the viewer
    #[default]
    Right,
    /// X right, Y up, Z away: Unity, DirectX
    Left,
}

/// What was assumed about the clips of this command.
pub static NOTES: NoteLog = NoteLog::new();

impl Reading {
    /// Options for the reader.
    pub fn options(&self) -> miette::Result<ReadOptions> {
        let map = self.map.as_ref().map(SkeletonMap::read).transpose().into_diagnostic()?;
        Ok(ReadOptions {
            units: self.units,
            up: self.up,
            left_handed: self.handed == Hand::Left,
            root: self.root.clone(),
            repair: self.repair,
            strict: self.strict,
            log: Some(&NOTES),
            machine: self.robot.as_ref().map(|path| robot(path).map(Arc::new)).transpose()?,
            angles: self.angles,
            moves: moves::Options { rate: self.rate, episode: self.episode },
            map,
            ..ReadOptions::default()
        })
    }
}

impl Reading {
    /// The same for clips that a pack plays: a pack of a robot says whose motions they are.
    pub fn options_for(&self, pack: &Pack) -> miette::Result<ReadOptions> {
        let own = Machine::from_pack(pack).into_diagnostic()?.map(Arc::new);
        let options = self.options()?;
        Ok(ReadOptions { machine: options.machine.clone().or(own), ..options })
    }

    /// Everything here that decides what a clip becomes.
    pub fn deciding(&self) -> miette::Result<String> {
        let map = self.map.as_ref().map(|path| fingerprint(path)).transpose().into_diagnostic()?;
        let hand = self.handed == Hand::Left;
        let robot = self.robot.as_ref().map(|path| fingerprint(path)).transpose().into_diagnostic()?;
        let moves = format!("{robot:?} {:?} {:?} {:?}", self.angles, self.rate, self.episode);
        Ok(format!("{map:?} {:?} {:?} {hand} {:?} {} {moves}", self.units, self.up, self.root, self.repair))
    }
}

/// Which pairs of clips.
#[derive(Args, Clone, Debug, Default)]
pub struct Pairs {
    /// A pair of clips of the same content: first the source manner, then the wanted one (may be repeated)
    #[arg(long, num_args = 2, value_names = ["NEUTRAL", "STYLED"], action = clap::ArgAction::Append)]
    pub pair: Vec<PathBuf>,
    /// Table of pairs: tab-separated, with columns `neutral` and `styled` (paths from the table's folder)
    #[arg(long, value_name = "TSV")]
    pub pairs: Option<PathBuf>,
    /// Rows of the table to take: COLUMN=VALUE, COLUMN!=VALUE, COLUMN~PART or COLUMN!~PART (may be repeated: all must hold)
    #[arg(long = "where", value_name = "CONDITION", requires = "pairs")]
    pub conditions: Vec<String>,
}

impl Pairs {
    /// The pairs' paths.
    pub fn paths(&self) -> miette::Result<Vec<(PathBuf, PathBuf)>> {
        let mut paths: Vec<_> = self.pair.as_chunks::<2>().0.iter().map(|[a, b]| (a.clone(), b.clone())).collect();
        if let Some(table) = &self.pairs {
            paths.extend(self.rows_of(table)?);
        }
        if paths.is_empty() {
            return Err(miette!(
                help = "give --pair NEUTRAL STYLED, or --pairs TABLE.tsv --where style=NAME",
                "there is no pair of clips"
            ));
        }
        Ok(paths)
    }

    fn rows_of(&self, table: &Path) -> miette::Result<Vec<(PathBuf, PathBuf)>> {
        let refuse = |error: csv::Error| miette!("{}: cannot be read: {error}", table.display());
        let bytes = files::read(table).map_err(|error| refuse(error.into()))?;
        let mut reader = csv::ReaderBuilder::new().delimiter(b'\t').quoting(false).from_reader(&bytes[..]);
        let headers = reader.headers().map_err(refuse)?.clone();
        let column = |name: &str| {
            headers.iter().position(|header| header == name).ok_or_else(|| {
                let columns: Vec<_> = headers.iter().collect();
                miette!(
                    help = format!("its columns are: {}", columns.join(", ")),
                    "{}: there is no column {name:?}",
                    table.display()
                )
            })
        };
        let (neutral, styled) = (column("neutral")?, column("styled")?);
        let conditions =
            self.conditions.iter().map(|text| Condition::parse(text, &column)).collect::<Result<Vec<_>, _>>()?;
        let folder = table.parent().unwrap_or(Path::new(""));
        let mut pairs = Vec::new();
        for record in reader.records() {
            let record = record.map_err(refuse)?;
            if conditions.iter().all(|condition| condition.holds(record.get(condition.column).unwrap_or(""))) {
                let path = |column| folder.join(record.get(column).unwrap_or(""));
                pairs.push((path(neutral), path(styled)));
            }
        }
        if pairs.is_empty() {
            return Err(miette!(
                help = "loosen a --where condition",
                "{}: no row fits {}",
                table.display(),
                self.conditions.join(" and ")
            ));
        }
        Ok(pairs)
    }
}

/// Clips named by files, folders and tables.
///
/// `walk.bvh`, `walks/` (every .bvh and .csv in it), `manifest.tsv` (its column `file`, paths from the table's folder), or
/// `manifest.tsv:label=body-mechanics,skeleton=cmu31` (the rows that fulfil all conditions).
pub fn clip_paths(sets: &[PathBuf]) -> miette::Result<Vec<PathBuf>> {
    paths_of(sets, &READERS.iter().flat_map(|reader| reader.extensions).copied().collect::<Vec<_>>())
}

/// The same; of a folder what has one of these extensions.
pub fn paths_of(sets: &[PathBuf], extensions: &[&str]) -> miette::Result<Vec<PathBuf>> {
    let mut paths: Vec<PathBuf> = Vec::new();
    let mut known: HashSet<PathBuf> = HashSet::new();
    for set in sets {
        let text = set.display().to_string();
        let found = if set.is_dir() {
            folder_clips(set, extensions)?
        } else if let Some((table, conditions)) = text.split_once(".tsv") {
            table_clips(Path::new(&format!("{table}.tsv")), conditions.strip_prefix(':').unwrap_or(conditions))?
        } else {
            vec![set.clone()]
        };
        for path in found {
            if known.insert(path.clone()) {
                paths.push(path);
            }
        }
    }
    Ok(paths)
}

fn folder_clips(folder: &Path, extensions: &[&str]) -> miette::Result<Vec<PathBuf>> {
    let refuse = |error: std::io::Error| miette!("{}: cannot be read: {error}", folder.display());
    let mut paths = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(refuse)? {
        let path = entry.map_err(refuse)?.path();
        let is_clip = |e: &std::ffi::OsStr| extensions.iter().any(|extension| e.eq_ignore_ascii_case(extension));
        if path.extension().is_some_and(is_clip) {
            paths.push(path);
        }
    }
    if paths.is_empty() {
        let help = format!("name a folder with files of these names: .{}", extensions.join(", ."));
        return Err(miette!(help = help, "{}: there is no clip", folder.display()));
    }
    paths.sort();
    Ok(paths)
}

fn table_clips(table: &Path, conditions: &str) -> miette::Result<Vec<PathBuf>> {
    let refuse = |error: csv::Error| miette!("{}: cannot be read: {error}", table.display());
    let bytes = files::read(table).map_err(|error| refuse(error.into()))?;
    let mut reader = csv::ReaderBuilder::new().delimiter(b'\t').quoting(false).from_reader(&bytes[..]);
    let headers = reader.headers().map_err(refuse)?.clone();
    let column = |name: &str| {
        headers.iter().position(|header| header == name).ok_or_else(|| {
            let columns: Vec<_> = headers.iter().collect();
            miette!(
                help = format!("its columns are: {}", columns.join(", ")),
                "{}: there is no column {name:?}",
                table.display()
            )
        })
    };
    let file = column("file")?;
    let parts = conditions.split(',').filter(|part| !part.is_empty());
    let parsed = parts.map(|text| Condition::parse(text, &column)).collect::<miette::Result<Vec<_>>>()?;
    let folder = table.parent().unwrap_or(Path::new(""));
    let mut paths = Vec::new();
    for record in reader.records() {
        let record = record.map_err(refuse)?;
        if parsed.iter().all(|condition| condition.holds(record.get(condition.column).unwrap_or(""))) {
            paths.push(folder.join(record.get(file).unwrap_or("")));
        }
    }
    if paths.is_empty() {
        return Err(miette!(help = "loosen a condition", "{}: no row fits {conditions}", table.display()));
    }
    Ok(paths)
}

struct Condition {
    column: usize,
    operator: Operator,
    value: String,
}

#[derive(Clone, Copy)]
enum Operator {
    Equal,
    Different,
    Contains,
    Lacks,
}

impl Condition {
    fn parse(text: &str, column: &dyn Fn(&str) -> miette::Result<usize>) -> miette::Result<Self> {
        let operators =
            [("!=", Operator::Different), ("!~", Operator::Lacks), ("=", Operator::Equal), ("~", Operator::Contains)];
        let found = operators.into_iter().find_map(|(sign, operator)| {
            text.split_once(sign).map(|(name, value)| (name.trim(), operator, value.trim()))
        });
        let Some((name, operator, value)) = found else {
            return Err(miette!("condition {text}: expected COLUMN=VALUE, COLUMN!=VALUE, COLUMN~PART or COLUMN!~PART"));
        };
        Ok(Self { column: column(name)?, operator, value: value.to_owned() })
    }

    fn holds(&self, found: &str) -> bool {
        match self.operator {
            Operator::Equal => found == self.value,
            Operator::Different => found != self.value,
            Operator::Contains => found.contains(&self.value),
            Operator::Lacks => !found.contains(&self.value),
        }
    }
}
