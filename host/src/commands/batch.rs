//! One clip to a file, or many to a folder: what is written where, and what happens when one of them fails.

use std::collections::HashMap;
use std::io::IsTerminal;
use std::path::{Path, PathBuf};

use indicatif::{ProgressBar, ProgressStyle};
use kinesic_host::clip::Format;
use kinesic_host::clip::formats::READERS;
use miette::miette;
use serde::Serialize;
use serde_json::{Value, json};

use super::clips::paths_of;
use super::guard;
use super::output::{MOVES, check_motion, is_moves, print_json};

/// A clip, and the file that is made of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Job {
    pub clip: PathBuf,
    pub out: PathBuf,
}

/// What is to be done.
#[derive(Debug)]
pub struct Batch {
    pub jobs: Vec<Job>,
    /// The folder that everything is written to; none for one clip and one file.
    folder: Option<PathBuf>,
}

/// The formats that a folder is filled with.
pub const FORMATS: [&str; 9] = ["bvh", "glb", "gltf", "csv", "positions.csv", "json", "jsonl", "yaml", "yml"];

impl Batch {
    /// From the clips, folders and tables of a command line and its `--out`: a folder if it is there, ends with a slash, or has to hold more
    /// than one clip. Files in it are named after their clips, in the clip's own format or in `format`.
    pub fn new(clips: &[PathBuf], out: &Path, format: Option<&str>, machine: bool) -> miette::Result<Self> {
        let extensions: Vec<&str> = match machine {
            true => MOVES.to_vec(),
            false => READERS.iter().flat_map(|reader| reader.extensions).copied().collect(),
        };
        let several = clips.len() > 1 || clips.iter().any(|clip| clip.is_dir());
        let paths = paths_of(clips, &extensions)?;
        let slash = out.as_os_str().as_encoded_bytes().ends_with(b"/");
        let [clip] = &paths[..] else { return Self::folder(paths, out, format, machine) };
        // A folder with the name of a motion is more likely a slip.
        let named = Format::of(out).is_some() || is_moves(out);
        if several || slash || out.is_dir() && !named {
            return Self::folder(paths, out, format, machine);
        }
        if let Some(format) = format {
            return Err(miette!(
                help = "leave --format out, or write to a folder: --out results/",
                "--format {format}: {} says its format itself",
                out.display()
            ));
        }
        check_motion(out, machine)?;
        Ok(Self { jobs: vec![Job { clip: clip.clone(), out: out.to_owned() }], folder: None })
    }

    fn folder(paths: Vec<PathBuf>, out: &Path, format: Option<&str>, machine: bool) -> miette::Result<Self> {
        let clips = paths.len();
        if out.is_file() || !out.is_dir() && (Format::of(out).is_some() || is_moves(out)) {
            return Err(miette!(
                help = format!("name a folder: --out {}/", out.with_extension("").display()),
                "--out {}: found the name of a file for {clips} clips, expected a folder",
                out.display()
            ));
        }
        if let Some(parent) = out.parent().filter(|parent| !parent.as_os_str().is_empty() && !parent.is_dir()) {
            return Err(miette!(
                help = format!("create it: mkdir -p {}", parent.display()),
                "--out {}: the folder {} does not exist",
                out.display(),
                parent.display()
            ));
        }
        let mut taken: HashMap<PathBuf, PathBuf> = HashMap::new();
        let mut jobs = Vec::new();
        for clip in paths {
            let file = out.join(name(&clip, format, machine));
            check_format(&file, machine)?;
            if !guard::overwrites() && guard::same(&clip, &file) {
                return Err(miette!(
                    help = "write to another folder, or say --overwrite to replace the clips",
                    "{}: it is read and would be replaced",
                    clip.display()
                ));
            }
            if let Some(other) = taken.insert(file.clone(), clip.clone()) {
                return Err(miette!(
                    help = "rename one, or write them to folders of their own",
                    "{}: {} and {} would both be written to it",
                    file.display(),
                    other.display(),
                    clip.display()
                ));
            }
            jobs.push(Job { clip, out: file });
        }
        Ok(Self { jobs, folder: Some(out.to_owned()) })
    }

    /// Whether results go to a folder.
    pub fn is_folder(&self) -> bool {
        self.folder.is_some()
    }

    /// Makes every file. What fails is said, and the rest is made; at the end a failure of one is a failure of the command. `print` shows one
    /// result; with `json` there is one object of them all.
    pub fn run<R: Serialize>(
        &self,
        json: bool,
        mut make: impl FnMut(&Job) -> miette::Result<R>,
        print: impl Fn(&Job, &R),
    ) -> miette::Result<()> {
        let Some(folder) = &self.folder else {
            return self.jobs.iter().try_for_each(|job| {
                let made = make(job)?;
                if json {
                    return print_json(&made);
                }
                print(job, &made);
                Ok(())
            });
        };
        let new = !folder.is_dir();
        if new {
            std::fs::create_dir(folder).map_err(|error| {
                miette!(help = "name another folder", "--out {}: cannot be made: {error}", folder.display())
            })?;
        }
        let bar = bar(self.jobs.len());
        let (mut results, mut failed) = (Vec::new(), 0);
        for job in &self.jobs {
            bar.set_message(job.clip.display().to_string());
            match make(job) {
                Ok(made) if json => results.push(serde_json::to_value(&made).unwrap_or(Value::Null)),
                Ok(made) => bar.suspend(|| print(job, &made)),
                Err(error) => {
                    failed += 1;
                    let told = told(&job.clip, &error);
                    if json {
                        results.push(json!({"clip": job.clip.display().to_string(), "error": told}));
                    } else {
                        bar.suspend(|| eprintln!("failed: {told}"));
                    }
                }
            }
            bar.inc(1);
        }
        bar.finish_and_clear();
        if new && failed == self.jobs.len() {
            // Only if it is empty.
            let _ = std::fs::remove_dir(folder);
        }
        if json {
            print_json(&json!({"out": folder.display().to_string(), "clips": results, "failed": failed}))?;
        }
        if failed == 0 {
            return Ok(());
        }
        Err(miette!(
            help = "the others are written; what each failure says to do is above",
            "{failed} of {} clips failed",
            self.jobs.len()
        ))
    }
}

/// An error with its causes and its help in one line, which names the clip.
fn told(clip: &Path, error: &miette::Report) -> String {
    let mut text = error.chain().map(ToString::to_string).collect::<Vec<_>>().join(": ");
    let name = clip.display().to_string();
    if !text.contains(&name) {
        text = format!("{name}: {text}");
    }
    match error.help() {
        Some(help) => format!("{text} ({help})"),
        None => text,
    }
}

/// The name of what is made of a clip: its own. A table of a body's motion becomes BVH, since a table that is written holds angles.
fn name(clip: &Path, format: Option<&str>, machine: bool) -> PathBuf {
    let plain = if clip.extension().is_some_and(|end| end.eq_ignore_ascii_case("gz")) {
        clip.with_extension("")
    } else {
        clip.to_owned()
    };
    let stem = plain.file_stem().unwrap_or(plain.as_os_str()).to_owned();
    let own = plain.extension().map(|end| end.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
    let known = match machine {
        true => is_moves(&plain),
        false => own != "csv" && Format::of(&plain).is_some(),
    };
    let without = if machine { "csv" } else { "bvh" };
    let end = format.unwrap_or(if known { &own } else { without });
    let mut name = stem;
    name.push(".");
    name.push(end);
    name.into()
}

/// As [`check_motion`], for a folder that need not be there yet.
fn check_format(file: &Path, machine: bool) -> miette::Result<()> {
    check_motion(Path::new(file.file_name().unwrap_or_default()), machine)
}

/// How far it is, on standard error, silent where nobody watches.
fn bar(count: usize) -> ProgressBar {
    if !std::io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new(count as u64);
    let style = ProgressStyle::with_template("{pos}/{len} {msg} ({elapsed})");
    bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
    bar
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_named_after_their_clips() {
        let made = |clip: &str, format, machine| name(Path::new(clip), format, machine).display().to_string();
        assert_eq!(made("a/walk.BVH", None, false), "walk.bvh");
        assert_eq!(made("a/walk.bvh.gz", None, false), "walk.bvh");
        assert_eq!(made("kinect.csv", None, false), "kinect.bvh");
        assert_eq!(made("walk.glb", Some("positions.csv"), false), "walk.positions.csv");
        assert_eq!(made("nod.json", None, true), "nod.json");
        assert_eq!(made("nod", None, true), "nod.csv");
    }

    #[test]
    fn two_clips_do_not_take_one_name_and_no_clip_is_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        std::fs::create_dir(at("b")).unwrap();
        for name in ["walk.bvh", "b/walk.bvh", "x.bvh"] {
            std::fs::write(at(name), "").unwrap();
        }
        let refuse = |clips: &[&str], out: &str| {
            let clips: Vec<_> = clips.iter().map(|name| at(name)).collect();
            Batch::new(&clips, &at(out), None, false).unwrap_err().to_string()
        };
        assert!(refuse(&["walk.bvh", "b"], "out/").contains("would both be written"));
        assert!(refuse(&["walk.bvh", "x.bvh"], "").contains("would be replaced"));
        assert!(refuse(&["walk.bvh", "x.bvh"], "o.bvh").contains("expected a folder"));
        assert!(refuse(&["walk.bvh", "x.bvh"], "no/out").contains("does not exist"));
        let batch = Batch::new(&[at("b")], &at("out"), Some("glb"), false).unwrap();
        assert_eq!(batch.jobs, [Job { clip: at("b/walk.bvh"), out: at("out/walk.glb") }]);
        assert!(!at("out").exists());
    }
}
