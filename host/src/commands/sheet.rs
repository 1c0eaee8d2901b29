//! `kinesic sheet`.

use std::path::{Path, PathBuf};

use clap::ValueEnum;
use kinesic_host::clip::{self, JointMap, ReadOptions};
use kinesic_host::prepare::Source;
use kinesic_host::robot::look::Look;
use kinesic_host::sheet::{Actor, Film, Moving, View, animation, png, sheet};
use miette::{IntoDiagnostic, miette};
use serde::Serialize;

use super::clips::{Reading, clip_paths};
use super::output::{check_folder, print_json, spinner, write_whole};

/// Draw clips as stick figures: a contact sheet, or a picture that moves
///
/// A sheet has a row a clip: its name, figures from its first frame to its last, and their times. In a picture that moves the clips play beside
/// each other. Left limbs are blue, right ones orange. Figures stay in the middle and face the viewer; marks on the ground are half a metre apart.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  kinesic sheet walk.bvh --out walk.png
  kinesic sheet neutral.bvh angry.bvh --out both.svg --frames 12 --view side
  kinesic sheet neutral.bvh angry.bvh --out both.gif --view side
  kinesic sheet clips/ --out all.png --frames 6 --size 90
  kinesic sheet nod.csv --robot desk.kin --out nod.gif")]
pub struct Args {
    /// Clips, or folders and tables of clips; motions of a robot with --robot
    #[arg(value_name = "CLIP", required = true)]
    clips: Vec<PathBuf>,
    /// Picture to write: .png or .svg is a sheet, .gif or .apng (animated PNG) moves
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Figures in a row of a sheet [default: 8]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=200))]
    frames: Option<u16>,
    /// From where figures are seen
    #[arg(long, value_enum, default_value_t = From::Oblique)]
    view: From,
    /// Height of the largest figure, pixels
    #[arg(long, value_name = "PIXELS", default_value_t = 150, value_parser = clap::value_parser!(u16).range(20..=2000))]
    size: u16,
    /// Pictures a second of a picture that moves [default: 25]
    #[arg(long, value_name = "RATE", value_parser = clap::value_parser!(u16).range(1..=50))]
    fps: Option<u16>,
    /// Print one JSON object: out, width, height, pictures
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    reading: Reading,
}

/// A direction of view.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum From {
    /// From the front, a little from the side and from above
    Oblique,
    /// From the front
    Front,
    /// From the right: walks go to the right
    Side,
    /// From above: walks go down
    Top,
}

impl From {
    fn view(self) -> View {
        match self {
            Self::Oblique => View::Oblique,
            Self::Front => View::Front,
            Self::Side => View::Side,
            Self::Top => View::Top,
        }
    }
}

#[derive(Clone, Copy)]
enum Format {
    Png,
    Svg,
    Moving(Moving),
}

#[derive(Serialize)]
struct Summary {
    out: String,
    width: u32,
    height: u32,
    /// Figures of a sheet's rows together, or pictures of one that moves.
    pictures: usize,
}

/// Pictures of a film at most: two minutes at the usual rate.
const MOST_PICTURES: f64 = 3000.0;

/// Runs the command.
pub fn run(args: &Args) -> miette::Result<()> {
    let format = format(&args.out)?;
    let moves = matches!(format, Format::Moving(_));
    if moves && args.frames.is_some() {
        return Err(miette!(
            help = "leave --frames out, or write a sheet: --out sheet.png",
            "--frames: {} is a picture that moves, expected --fps",
            args.out.display()
        ));
    }
    if !moves && args.fps.is_some() {
        return Err(miette!(
            help = "leave --fps out, or write a picture that moves: --out film.gif",
            "--fps: {} is a sheet, expected --frames",
            args.out.display()
        ));
    }
    let bar = spinner();
    bar.set_message("reading");
    let options = args.reading.options()?;
    let paths = clip_paths(&args.clips)?;
    let actors = paths.iter().map(|path| actor(path, &options)).collect::<miette::Result<Vec<_>>>()?;
    bar.set_message("drawing");
    let (view, size) = (args.view.view(), f64::from(args.size));
    let summary = |width, height, pictures| Summary { out: args.out.display().to_string(), width, height, pictures };
    let (bytes, summary) = match format {
        Format::Moving(moving) => {
            // Times of GIF are whole hundredths of a second.
            let step = (100.0 / f64::from(args.fps.unwrap_or(25))).round() / 100.0;
            let longest = actors.iter().map(Actor::duration).fold(0.0, f64::max);
            if longest / step > MOST_PICTURES {
                return Err(miette!(
                    help =
                        "cut the clip (kinesic edit --from 0s --to 20s), or ask for fewer pictures a second (--fps 10)",
                    "{}: {longest:.0} s are {:.0} pictures, expected at most {MOST_PICTURES}",
                    args.out.display(),
                    longest / step
                ));
            }
            let film = Film::new(&actors, view, size, step).into_diagnostic()?;
            let first = film.drawing(0).into_diagnostic()?;
            let bytes = animation(&film, moving).into_diagnostic()?;
            (bytes, summary(first.width, first.height, film.frames()))
        }
        Format::Png | Format::Svg => {
            let count = usize::from(args.frames.unwrap_or(8));
            let rows: Vec<_> =
                actors.into_iter().map(|actor| (actor.even(count), actor)).map(|(f, a)| (a, f)).collect();
            let drawing = sheet(&rows, view, size).into_diagnostic()?;
            let bytes = match format {
                Format::Svg => drawing.svg().into_bytes(),
                _ => png(&drawing).into_diagnostic()?,
            };
            (bytes, summary(drawing.width, drawing.height, count * rows.len()))
        }
    };
    write_whole(&args.out, &bytes)?;
    bar.finish_and_clear();
    if args.json {
        return print_json(&summary);
    }
    let what = if moves { "pictures" } else { "figures" };
    println!("{}: {} x {} pixels, {} {what}", summary.out, summary.width, summary.height, summary.pictures);
    Ok(())
}

/// The format that the name says, in a folder that is there.
fn format(out: &Path) -> miette::Result<Format> {
    let extension = out.extension().map(|found| found.to_ascii_lowercase());
    let format = match extension.as_ref().and_then(|found| found.to_str()) {
        Some("png") => Format::Png,
        Some("svg") => Format::Svg,
        Some("gif") => Format::Moving(Moving::Gif),
        Some("apng") => Format::Moving(Moving::Png),
        _ => {
            return Err(miette!(
                help = format!("name it {}", out.with_extension("png").display()),
                "{}: the output is a .png or .svg sheet, or a .gif or .apng that moves",
                out.display()
            ));
        }
    };
    check_folder(out)?;
    Ok(format)
}

/// A clip of a body, whose joints need not be known, or of the robot that was named.
fn actor(path: &Path, options: &ReadOptions) -> miette::Result<Actor> {
    let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
    let Some(machine) = &options.machine else {
        let clip = clip::read_with(path, options).into_diagnostic()?;
        let map = JointMap::choose(&clip.skeleton, options.map.as_ref()).into_diagnostic()?;
        return Ok(Actor::body(&name, clip, map.as_ref()));
    };
    let source = Source::read(path, options).into_diagnostic()?;
    Ok(Actor::machine(&name, source.clip, Look::of_machine(machine)))
}
