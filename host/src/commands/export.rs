//! `kinesic export`.

use std::path::PathBuf;

use kinesic_host::clip::{self, ReadOptions};
use kinesic_host::embed;
use kinesic_host::pack::PackFile;
use kinesic_host::prepare::Source;
use miette::{IntoDiagnostic, miette};
use serde::Serialize;

use super::clips::Reading;
use super::inspect::is_pack;
use super::output::{check_motion, check_output, print_json, write_motion, write_whole};

/// Write a clip in another format, or a pack or a robot's move as Rust source
///
/// A clip keeps its frame rate and its motion, and its skeleton but for what reading leaves out: scene roots above the hips are composed
/// into them, joints beside them are dropped, with a note. BVH is in centimetres; glTF 2.0 in metres, +Y up, one key a frame, the
/// root's path as the translation of the first node; CSV is a table of joint angles in degrees.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  kinesic export walk.bvh --out walk.glb
  kinesic export walk.bvh --out walk-angles.csv
  kinesic export nod.csv --robot desk.kin --out nod.json
  kinesic export --rust angry.kin --out src/pack.rs
  kinesic export --rust nod.csv --robot desk.kin --out src/nod.rs")]
pub struct Args {
    /// A clip (BVH, Kinect CSV), a robot's move with --robot, or a pack with --rust
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// Write a Rust module: a pack's bytes, aligned, and the capacities that they need as constants; or, with --robot, a move's frames at the
    /// robot's frame rate, rad and m
    #[arg(long)]
    rust: bool,
    /// File to write: .bvh, .glb, .gltf or .csv for a clip; .csv, .json, .jsonl or .yaml for a robot's move, or .bvh, .glb, .gltf for pictures of
    /// it; .rs with --rust
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Print one JSON object: out, bytes
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    reading: Reading,
}

#[derive(Serialize)]
struct Summary {
    out: String,
    bytes: u64,
}

/// Runs the command.
pub fn run(args: &Args) -> miette::Result<()> {
    let options = args.reading.options()?;
    if args.rust {
        check_output(&args.out, "rs")?;
        let module = rust(args, &options)?;
        write_whole(&args.out, module.as_bytes())?;
    } else {
        check_motion(&args.out, options.machine.is_some())?;
        if is_pack(&args.file) {
            return Err(miette!(
                help =
                    "write it as Rust source with --rust --out pack.rs, or play a clip through it with kinesic apply",
                "{}: a pack is no motion",
                args.file.display()
            ));
        }
        if options.machine.is_some() {
            let Source { clip, machine, moves, .. } = Source::read(&args.file, &options).into_diagnostic()?;
            write_motion(&args.out, &clip, machine.as_deref(), moves.as_ref())?;
        } else {
            let clip = clip::read_with(&args.file, &options).into_diagnostic()?;
            clip.write(&args.out).into_diagnostic()?;
        }
    }
    let bytes = std::fs::metadata(&args.out).map_or(0, |meta| meta.len());
    let summary = Summary { out: args.out.display().to_string(), bytes };
    if args.json {
        return print_json(&summary);
    }
    println!("{}: {} bytes", summary.out, summary.bytes);
    Ok(())
}

/// A pack, or a move of a machine, as Rust source.
fn rust(args: &Args, options: &ReadOptions) -> miette::Result<String> {
    let name = args.file.file_name().unwrap_or_default().to_string_lossy();
    if is_pack(&args.file) {
        return embed::rust_module(&PackFile::read(&args.file).into_diagnostic()?, &name).into_diagnostic();
    }
    let Some(machine) = &options.machine else {
        return Err(miette!(
            help = "expected a pack; or, for a robot's move, its robot: kinesic export --rust nod.csv --robot desk.kin --out nod.rs",
            "{}: not a pack",
            args.file.display()
        ));
    };
    let source = Source::read(&args.file, options).into_diagnostic()?;
    let clip = source.on_rig(&machine.rig, machine.limits.frame_rate).into_diagnostic()?;
    Ok(embed::rust_move(&clip, machine, &name))
}
