//! `kinesic edit`.

use std::path::PathBuf;

use kinesic_host::clip::{self, Clip, ReadOptions};
use kinesic_host::edit::{self, Cycle, Seam, Sway, Time};
use kinesic_host::prepare::Source;
use kinesic_host::robot::Machine;
use miette::{IntoDiagnostic, WrapErr, miette};
use serde::Serialize;

use super::batch::{Batch, FORMATS, Job};
use super::clips::Reading;
use super::output::write_motion;

/// Cut clips, smooth them, close them to a cycle, keep them in place
///
/// A clip keeps its skeleton, its frame rate and its names. What is asked for is done in this order: cut, smooth, close, in place. Times are
/// seconds (1.2s) or frames (36f) of the clip. A robot's motion is cut, smoothed and closed in its own joints.
///
/// Smoothing and staying in place make feet slide: the ground is not known to them.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  kinesic edit walk.bvh --from 1.2s --to 3s --out part.bvh
  kinesic edit noisy.bvh --smooth 0.2 --out calm.bvh
  kinesic edit walk.bvh --loop --length 1.1 --in-place --sway --out cycle.glb
  kinesic edit clips/ --smooth 0.1 --out smooth/ --format glb
  kinesic edit nod.csv --robot desk.kin --loop --out nod-cycle.csv")]
pub struct Args {
    /// Clips, or folders and tables of clips; motions of a robot with --robot
    #[arg(value_name = "CLIP", required = true)]
    clips: Vec<PathBuf>,
    /// Motion to write, in the format that its name says: .bvh, .glb, .gltf, .csv (angles), .positions.csv; of a robot .csv, .json, .jsonl,
    /// .yaml. For several clips a folder
    #[arg(long, value_name = "FILE|FOLDER")]
    out: PathBuf,
    /// Format of the files in a folder [default: each as its clip]
    #[arg(long, value_parser = FORMATS)]
    format: Option<String>,
    /// First frame: 1.2s or 36f
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    from: Option<Time>,
    /// Last frame
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    to: Option<Time>,
    /// Take out what is faster: a movement of this period keeps half its size, one of twice the period 84 %, one of half the period 6 %
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    smooth: Option<f64>,
    /// Take the part that can best be played over and over, and blend its end into its beginning; way and turn of a cycle stay
    #[arg(long = "loop")]
    closed: bool,
    /// Length of the cycle within a quarter [default: at least half of the clip]
    #[arg(long, value_name = "SECONDS", requires = "closed", allow_negative_numbers = true)]
    length: Option<f64>,
    /// How long its end passes over into its beginning
    #[arg(long, value_name = "SECONDS", requires = "closed", default_value_t = 0.2, allow_negative_numbers = true)]
    blend: f64,
    /// Take out the way along the ground; heights and turns stay
    #[arg(long)]
    in_place: bool,
    /// Keep the sway of every step, what is faster than 2 s
    #[arg(long, requires = "in_place")]
    sway: bool,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    reading: Reading,
}

/// Ends farther apart, cm, are hardly those of one cycle. With `--loop --length 1.1` walks of xia (`_01_`) are 1.6 to 8.4 cm apart, other clips
/// of it up to 30.
const FAR: f64 = 12.0;

#[derive(Serialize)]
struct Summary {
    clip: String,
    out: String,
    frames: usize,
    frame_rate: f64,
    duration_s: f64,
    /// The cycle, in seconds of what was left of the clip.
    #[serde(skip_serializing_if = "Option::is_none")]
    cycle: Option<Seam>,
    /// Way along the ground that was taken out, as the crow flies, m.
    #[serde(skip_serializing_if = "Option::is_none")]
    way_m: Option<f64>,
}

/// Runs the command.
pub fn run(args: &Args) -> miette::Result<()> {
    let nothing = args.from.is_none() && args.to.is_none() && args.smooth.is_none() && !args.closed && !args.in_place;
    if nothing {
        return Err(miette!(
            help = "say what: --from, --to, --smooth, --loop or --in-place; kinesic export writes another format",
            "found nothing to change, expected at least one edit"
        ));
    }
    let options = args.reading.options()?;
    let machine = options.machine.clone();
    let batch = Batch::new(&args.clips, &args.out, args.format.as_deref(), machine.is_some())?;
    let machine = machine.as_deref();
    let print = |_: &Job, summary: &Summary| print(summary, machine.is_some());
    batch.run(args.json, |job| edit(args, job, &options, machine), print)
}

/// Makes one file.
fn edit(args: &Args, job: &Job, options: &ReadOptions, machine: Option<&Machine>) -> miette::Result<Summary> {
    let (clip, moves) = match machine {
        Some(_) => {
            let source = Source::read(&job.clip, options).into_diagnostic()?;
            (source.clip, source.moves)
        }
        // Its joints need not be known.
        None => (clip::read_with(&job.clip, options).into_diagnostic()?, None),
    };
    let (mut made, cycle, way_m) = changed(args, clip).wrap_err_with(|| job.clip.display().to_string())?;
    if let Some(machine) = machine {
        edit::show(&mut made, &machine.rig);
    }
    write_motion(&job.out, &made, machine, moves.as_ref())?;
    Ok(Summary {
        clip: job.clip.display().to_string(),
        out: job.out.display().to_string(),
        frames: made.frames(),
        frame_rate: made.fps(),
        duration_s: made.duration(),
        cycle,
        way_m,
    })
}

fn changed(args: &Args, mut clip: Clip) -> miette::Result<(Clip, Option<Seam>, Option<f64>)> {
    if args.from.is_some() || args.to.is_some() {
        clip = edit::trim(&clip, args.from, args.to).into_diagnostic()?;
    }
    if let Some(seconds) = args.smooth {
        clip = edit::smooth(&clip, seconds).into_diagnostic()?;
    }
    let mut cycle = None;
    if args.closed {
        let (closed, seam) = edit::close(&clip, &Cycle { length: args.length, blend: args.blend }).into_diagnostic()?;
        (clip, cycle) = (closed, Some(seam));
    }
    let mut way = None;
    if args.in_place {
        let sway = match (args.sway, args.closed) {
            (false, _) => Sway::None,
            (true, false) => Sway::Kept,
            (true, true) => Sway::KeptInCycle,
        };
        let (still, metres) = edit::stay(&clip, sway).into_diagnostic()?;
        (clip, way) = (still, Some(metres));
    }
    Ok((clip, cycle, way))
}

fn print(summary: &Summary, machine: bool) {
    let mut line = format!(
        "{}: {} frames at {:.2} a second, {:.2} s",
        summary.out, summary.frames, summary.frame_rate, summary.duration_s
    );
    if let Some(seam) = &summary.cycle {
        line += &format!("; a cycle of {:.2} s from {:.2} s on, its ends ", seam.length_s, seam.start_s);
        line += &match machine {
            true => format!("{:.3} rad or m apart before blending", seam.apart),
            false => format!(
                "{:.1} cm apart before blending, {:.2} m and {:.1} degrees a cycle",
                seam.apart, seam.travel_m, seam.turn_deg
            ),
        };
    }
    if let Some(way) = summary.way_m {
        line += &format!("; {way:.2} m of way taken out");
    }
    println!("{line}");
    if let Some(seam) = summary.cycle.as_ref().filter(|seam| !machine && seam.apart > FAR) {
        println!(
            "note: {}: joints jump by {:.0} cm on average from the end of the cycle to its beginning before blending; the clip may not repeat itself, or \
             needs another --length",
            summary.clip, seam.apart
        );
    }
}
