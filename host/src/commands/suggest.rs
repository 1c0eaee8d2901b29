//! `kinesic inspect --suggest-map`: a skeleton map for somebody to look at.

use std::path::Path;

use kinesic_host::clip::map::{Sides, Suggestion, Sure, suggest};
use kinesic_host::clip::{self, Canonical, Clip, JointMap, ReadError, ReadOptions, SkeletonMap, Unit};
use miette::{IntoDiagnostic, miette};
use serde::Serialize;

use super::clips::Reading;
use super::inspect::is_pack;
use super::output::print_json;
use super::print::raw;

#[derive(Serialize)]
struct Report {
    file: String,
    /// Canonical joint and name in the file.
    joints: Vec<(&'static str, String)>,
    /// Whether legs, arms and head are those.
    limbs: Sure,
    left_and_right: Sides,
    /// Direction from the ankles to the head over the motion.
    up: [f64; 3],
    notes: Vec<String>,
    /// The map file.
    map: String,
}

/// Runs the command.
pub fn run(file: &Path, json: bool, reading: &Reading) -> miette::Result<()> {
    if is_pack(file) {
        return Err(miette!(
            help = "name a clip; a pack's joints are known",
            "{}: found a pack, expected a clip with joint names that are not known",
            file.display()
        ));
    }
    let options = ReadOptions { log: None, ..reading.options()? };
    let (clip, scaled) = read(file, &options)?;
    let made = suggest(&clip).map_err(|error| miette!("{}: {error}", file.display()))?;
    let mut notes = notes(&clip, &made);
    if scaled {
        notes.push("The unit of length could not be told, and does not matter here; with the map, give --units if it is asked for.".into());
    }
    notes.extend(with_map(file, &options, &made)?);
    if json {
        let name = |joint: usize| clip.skeleton.joints[joint].name.clone();
        let joints = Canonical::ALL.into_iter().filter_map(|c| Some((c.name(), name(made.map.joint(c)?))));
        return print_json(&Report {
            file: file.display().to_string(),
            joints: joints.collect(),
            limbs: made.limbs,
            left_and_right: made.sides,
            up: made.up,
            notes,
            map: made.toml,
        });
    }
    raw(&made.toml);
    for note in notes {
        eprintln!("note: {}: {note}", file.display());
    }
    Ok(())
}

/// The clip, and whether its unit had to be left open: shapes have none.
fn read(file: &Path, options: &ReadOptions) -> miette::Result<(Clip, bool)> {
    match clip::read_with(file, options) {
        Err(ReadError::UnknownUnits { .. }) => {
            let metres = ReadOptions { units: Some(Unit::Metre), ..options.clone() };
            Ok((clip::read_with(file, &metres).into_diagnostic()?, true))
        }
        Err(ReadError::Machine { path }) => Err(miette!(
            help = "a robot's joints are known by its description: kinesic robot import --help",
            "{}: found a motion in the joints of a robot, expected a clip of a person",
            path.display()
        )),
        read => Ok((read.into_diagnostic()?, false)),
    }
}

/// What to look at before the map is used.
fn notes(clip: &Clip, made: &Suggestion) -> Vec<String> {
    let mut notes = vec!["This map is a suggestion, and nothing uses it until you give it with --map.".to_owned()];
    if made.limbs != Sure::Certain {
        notes.push(format!("Legs and arms are {}: other chains are as much like them.", made.limbs.name()));
    }
    match (made.sides.sure, made.sides.by_names()) {
        (_, Some(true)) => notes.push(
            "The names say left and right, but toes or knees point backwards: are the axes left-handed (--handed left)?".into(),
        ),
        (Sure::Certain, _) => {}
        (sure, _) => notes.push(format!("Left and right are {}: look at the motion.", sure.name())),
    }
    if let Some(known) = JointMap::detect(&clip.skeleton) {
        let differ: Vec<&str> =
            Canonical::ALL.into_iter().filter(|c| known.joint(*c) != made.map.joint(*c)).map(Canonical::name).collect();
        let same = match differ.is_empty() {
            true => "the map agrees with it".to_owned(),
            false => format!("the map differs from it in {}", differ.join(", ")),
        };
        notes.push(format!("The names are of the known layout {} and need no map; {same}.", known.layout()));
    }
    notes
}

/// What the reader makes of the file with the map, as any command would.
fn with_map(file: &Path, options: &ReadOptions, made: &Suggestion) -> miette::Result<Vec<String>> {
    let map = SkeletonMap { layout: "suggested".into(), ..SkeletonMap::parse(&made.toml).into_diagnostic()? };
    let options = ReadOptions { map: Some(map), ..options.clone() };
    match clip::read_with(file, &options) {
        Ok(clip) => Ok(clip.notes.iter().map(|note| format!("With this map: {note}")).collect()),
        Err(error @ ReadError::UnknownUnits { .. }) => Ok(vec![format!("With this map: {error}.")]),
        Err(error) => Err(error).into_diagnostic(),
    }
}
