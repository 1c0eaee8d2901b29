//! `kinesic view`.

use std::path::{Path, PathBuf};

use kinesic_host::clip::JointMap;
use kinesic_host::gait::{Manner, walk};
use kinesic_host::models;
use kinesic_host::pack::PackFile;
use kinesic_host::prepare::Source;
use kinesic_host::view::{self, ViewClip, ViewPack};
use miette::{IntoDiagnostic, miette};
use serde::Serialize;

use super::clips::{Reading, clip_paths};
use super::inspect::is_pack;
use super::output::{check_output, command_line, print_json, spinner, write_whole};

/// Make a page on which packs play clips, live: one HTML file that opens from disk
///
/// The page runs the device's own code, compiled to WebAssembly, frame by frame: skeletons side by side, time, strength or
/// expressiveness, joints, plots, foot contacts. Without packs it shows the two that come with the program; without clips, a
/// made-up walk.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  kinesic view
  kinesic view angry.kin walk.bvh --out angry.html
  kinesic view angry.kin walk.bvh --target angry-walk.bvh
  kinesic view models/mechanics.kin walk.bvh dance.bvh")]
pub struct Args {
    /// Packs (.kin) and clips (BVH, Kinect CSV, or folders of them), in any order
    #[arg(value_name = "FILE")]
    files: Vec<PathBuf>,
    /// What the clip should become: shown beside it (may be repeated, in the order of the clips)
    #[arg(long, value_name = "CLIP")]
    target: Vec<PathBuf>,
    /// HTML file to write
    #[arg(long, value_name = "FILE.html", default_value = "kinesic-view.html")]
    out: PathBuf,
    /// Seed of the made-up walk
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Print one JSON object: out, bytes, packs, clips
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    reading: Reading,
}

#[derive(Serialize)]
struct Summary {
    out: String,
    bytes: usize,
    packs: Vec<String>,
    clips: Vec<String>,
}

/// Runs the command.
pub fn run(args: &Args) -> miette::Result<()> {
    check_output(&args.out, "html")?;
    let (packs, clips): (Vec<PathBuf>, Vec<PathBuf>) = args.files.iter().cloned().partition(|path| is_pack(path));
    let clips = clip_paths(&clips)?;
    if args.target.len() > clips.len() {
        return Err(miette!(
            help = "name the clip that each target belongs to, in the same order",
            "there are {} targets for {} clips",
            args.target.len(),
            clips.len()
        ));
    }
    let bar = spinner();
    bar.set_message("reading");
    let packs = if packs.is_empty() { own_packs() } else { read_packs(&packs)? };
    let clips = if clips.is_empty() { vec![made_walk(args.seed)?] } else { read_clips(&clips, args)? };
    bar.set_message("playing");
    let title = format!("kinesic: {}", packs.iter().map(|pack| pack.name.as_str()).collect::<Vec<_>>().join(", "));
    let made = format!("Made by kinesic {} with: {}", env!("CARGO_PKG_VERSION"), command_line());
    let page = view::page(&title, &made, &packs, &clips, view::WASM).into_diagnostic()?;
    write_whole(&args.out, page.as_bytes())?;
    bar.finish_and_clear();
    let summary = Summary {
        out: args.out.display().to_string(),
        bytes: page.len(),
        packs: packs.into_iter().map(|pack| pack.name).collect(),
        clips: clips.into_iter().map(|clip| clip.name).collect(),
    };
    if args.json {
        return print_json(&summary);
    }
    println!(
        "{}: {} bytes, packs: {}; clips: {}",
        summary.out,
        summary.bytes,
        summary.packs.join(", "),
        summary.clips.join(", ")
    );
    println!("Open it in a browser.");
    Ok(())
}

fn stem(path: &Path) -> String {
    path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

fn own_packs() -> Vec<ViewPack> {
    let pack = |name: &str, file| ViewPack { name: name.to_owned(), file };
    vec![pack("weary", models::weary()), pack("mechanics", models::mechanics())]
}

fn read_packs(paths: &[PathBuf]) -> miette::Result<Vec<ViewPack>> {
    let read = |path: &PathBuf| Ok(ViewPack { name: stem(path), file: PackFile::read(path).into_diagnostic()? });
    paths.iter().map(read).collect()
}

fn read_clips(paths: &[PathBuf], args: &Args) -> miette::Result<Vec<ViewClip>> {
    let options = args.reading.options()?;
    let read = |path: &Path| Source::read(path, &options).into_diagnostic();
    let mut targets = args.target.iter();
    paths
        .iter()
        .map(|path| {
            Ok(ViewClip { name: stem(path), source: read(path)?, target: targets.next().map(|p| read(p)).transpose()? })
        })
        .collect()
}

/// A walk and what it is in the weary manner, as in the demo.
fn made_walk(seed: u64) -> miette::Result<ViewClip> {
    const SECONDS: f64 = 6.0;
    let made = |name: &str, manner: &Manner, seed: u64| {
        let seconds = SECONDS * Manner::NEUTRAL.cadence / manner.cadence;
        let clip = walk(manner, seconds, 60.0, 0.3, seed);
        let map = JointMap::detect(&clip.skeleton).ok_or_else(|| miette!("the made skeleton is not known"))?;
        Ok::<_, miette::Report>(Source { path: PathBuf::from(name), clip, map })
    };
    let seeds = seed.wrapping_mul(1000);
    Ok(ViewClip {
        name: "a made-up walk".to_owned(),
        source: made("made-up walk", &Manner::NEUTRAL, seeds.wrapping_add(3))?,
        target: Some(made("made-up weary walk", &Manner::WEARY, seeds.wrapping_add(4))?),
    })
}
