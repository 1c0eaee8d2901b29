//! `kinesic face`.

use std::io::Cursor;
use std::path::{Path, PathBuf};

use image::imageops::{FilterType, overlay};
use image::{DynamicImage, ImageFormat, RgbImage};
use kinesic::Pack;
use kinesic::face::{Landmarks, POINTS};
use kinesic_host::face::warp::Warp;
use kinesic_host::face::{Edit, Wish, edit};
use kinesic_host::pack::PackFile;
use miette::{IntoDiagnostic, WrapErr, miette};
use serde::Serialize;

use super::output::{check_output, print_json, spinner, write_whole};
use super::pictures::{Photographed, photographed};

/// Width of a picture on a sheet.
const SHEET: u32 = 256;

/// Change how strongly a face in a picture shows an expression
///
/// The landmarks go through the device's code, which says where each moves; the picture is warped after them. What is outside
/// the face stays as it is, pixel for pixel. No teeth are painted: a closed mouth becomes a wider closed mouth.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  kinesic face smile.kin --image me.jpg --landmarks me.csv --change +0.5 --out more.png
  kinesic face smile.kin --image me.jpg --landmarks me.csv --to 0 --out neutral.png --json
  kinesic face smile.kin --image a.jpg --image b.jpg --landmarks us.csv --change 0.5 --sheet --out sheet.png")]
pub struct Args {
    /// Face pack
    #[arg(value_name = "PACK.kin")]
    pack: PathBuf,
    /// Picture (JPEG or PNG); several for a sheet
    #[arg(long, value_name = "IN.jpg", required = true)]
    image: Vec<PathBuf>,
    /// Table with the picture's landmarks: the line whose image is the picture's file name, or the only line
    #[arg(long, value_name = "FILE.csv")]
    landmarks: PathBuf,
    /// So much more, or less if negative, in units of the training labels
    #[arg(
        long,
        value_name = "BY",
        allow_negative_numbers = true,
        required_unless_present = "to",
        conflicts_with = "to"
    )]
    change: Option<f32>,
    /// So strong: 0 as faces labelled 0, 1 as faces labelled 1
    #[arg(long, value_name = "STRENGTH", allow_negative_numbers = true, conflicts_with = "sheet")]
    to: Option<f32>,
    /// Write a sheet: each picture with less, as it is, with more
    #[arg(long)]
    sheet: bool,
    /// Picture to write
    #[arg(long, value_name = "OUT.png")]
    out: PathBuf,
    /// Also write the changed landmarks as a table (not with --sheet)
    #[arg(long, value_name = "FILE.csv", conflicts_with = "sheet")]
    landmarks_out: Option<PathBuf>,
    /// Print the results as one JSON object
    #[arg(long)]
    json: bool,
}

/// A change and its warp.
#[derive(Serialize)]
struct Changed {
    image: String,
    cluster: usize,
    strength_before: f32,
    strength_asked: f32,
    strength_target: f32,
    strength_after: f32,
    largest_offset_pixels: f32,
    landmarks_missed_by_pixels: f64,
    least_jacobian: f64,
}

#[derive(Serialize)]
struct Summary {
    out: String,
    faces: Vec<Changed>,
}

/// Runs the command.
pub fn run(args: &Args) -> miette::Result<()> {
    check_output(&args.out, "png")?;
    if let Some(path) = &args.landmarks_out {
        check_output(path, "csv")?;
    }
    let wish = match (args.change, args.to) {
        (Some(by), _) if by.is_finite() => Wish::Change(by),
        (None, Some(to)) if to.is_finite() => Wish::Strength(to),
        _ => return Err(miette!("--change and --to take a finite number, like +0.5")),
    };
    if args.image.len() > 1 && !args.sheet {
        return Err(miette!(
            help = "add --sheet, or run the command once a picture",
            "{} pictures for one output",
            args.image.len()
        ));
    }
    let file = PackFile::read(&args.pack).into_diagnostic()?;
    let pack = file.pack().into_diagnostic()?;
    let bar = spinner();
    bar.set_message("warping");
    let mut done = Vec::new();
    let mut rows = Vec::new();
    let mut moved = Vec::new();
    for (path, face) in args.image.iter().zip(photographed(&args.image, &args.landmarks)?) {
        let wishes = match (args.sheet, wish) {
            (true, Wish::Change(by)) => vec![Wish::Change(-by), Wish::Change(by)],
            _ => vec![wish],
        };
        let mut made = Vec::new();
        for wish in wishes {
            let (edited, warp, picture) = change(&pack, &face, wish, path)?;
            done.push(changed(path, wish, &edited, &warp));
            moved.push((face.name.clone(), edited.landmarks));
            made.push(picture);
        }
        if let [less, more] = &made[..] {
            made = vec![less.clone(), face.picture, more.clone()];
        }
        rows.push(made);
    }
    let picture = match args.sheet {
        true => sheet(&rows),
        false => rows.into_iter().flatten().next().ok_or_else(|| miette!("no picture was given"))?,
    };
    let mut png = Cursor::new(Vec::new());
    picture.write_to(&mut png, ImageFormat::Png).into_diagnostic()?;
    write_whole(&args.out, png.get_ref())?;
    if let Some(path) = &args.landmarks_out {
        write_whole(path, table_of(&moved).as_bytes())?;
    }
    bar.finish_and_clear();
    let summary = Summary { out: args.out.display().to_string(), faces: done };
    if args.json {
        return print_json(&summary);
    }
    println!("strength   before     asked    target     after   landmarks move by, pixels");
    for face in &summary.faces {
        println!(
            "         {:8.3}  {:8.3}  {:8.3}  {:8.3}   up to {:.1}; {}",
            face.strength_before,
            face.strength_asked,
            face.strength_target,
            face.strength_after,
            face.largest_offset_pixels,
            face.image
        );
        if (face.strength_asked - face.strength_target).abs() > 1e-6 {
            println!("note: asked for more than nearly all training faces show; held at {:.3}", face.strength_target);
        }
    }
    println!("{}", summary.out);
    Ok(())
}

fn change(pack: &Pack, face: &Photographed, wish: Wish, path: &Path) -> miette::Result<(Edit, Warp, DynamicImage)> {
    let edited = edit(pack, &face.landmarks, wish).into_diagnostic()?;
    let edited = edited.ok_or_else(|| miette!("{}: the landmarks are no face", path.display()))?;
    let warp = Warp::new(&face.landmarks, &edited.offsets).into_diagnostic()?;
    let picture = warp.apply(&face.picture).into_diagnostic().wrap_err_with(|| path.display().to_string())?;
    Ok((edited, warp, picture))
}

fn changed(path: &Path, wish: Wish, edited: &Edit, warp: &Warp) -> Changed {
    let before = edited.reading.strength;
    Changed {
        image: path.display().to_string(),
        cluster: edited.reading.cluster,
        strength_before: before,
        strength_asked: match wish {
            Wish::Change(by) => before + by,
            Wish::Strength(to) => to,
        },
        strength_target: edited.reading.target,
        strength_after: edited.strength_after,
        largest_offset_pixels: edited.offsets.iter().map(|[x, y]| (x * x + y * y).sqrt()).fold(0.0, f32::max),
        landmarks_missed_by_pixels: warp.missed(),
        least_jacobian: warp.least_jacobian(),
    }
}

/// Pictures in rows, each [`SHEET`] pixels wide.
fn sheet(rows: &[Vec<DynamicImage>]) -> DynamicImage {
    let small = |picture: &DynamicImage| {
        let height = (picture.height() * SHEET / picture.width().max(1)).max(1);
        picture.resize_exact(SHEET, height, FilterType::Triangle).to_rgb8()
    };
    let rows: Vec<Vec<RgbImage>> = rows.iter().map(|row| row.iter().map(small).collect()).collect();
    let height = |row: &Vec<RgbImage>| row.iter().map(RgbImage::height).max().unwrap_or(0);
    let mut sheet = RgbImage::new(3 * SHEET, rows.iter().map(height).sum());
    let mut top = 0;
    for row in &rows {
        for (column, picture) in row.iter().enumerate() {
            overlay(&mut sheet, picture, i64::from(column as u32 * SHEET), top);
        }
        top += i64::from(height(row));
    }
    DynamicImage::ImageRgb8(sheet)
}

fn table_of(faces: &[(String, Landmarks)]) -> String {
    let header = (0..POINTS).map(|i| format!(",x{i},y{i}")).collect::<String>();
    let row = |(name, landmarks): &(String, Landmarks)| {
        name.clone() + &landmarks.iter().map(|[x, y]| format!(",{x},{y}")).collect::<String>() + "\n"
    };
    format!("image{header}\n") + &faces.iter().map(row).collect::<String>()
}
