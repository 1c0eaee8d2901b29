//! `kinesic view`.

use std::path::{Path, PathBuf};

use kinesic::model::ModelMeta;
use kinesic_host::clip::JointMap;
use kinesic_host::engines::known;
use kinesic_host::gait::{Manner, walk};
use kinesic_host::models;
use kinesic_host::pack::PackFile;
use kinesic_host::plain;
use kinesic_host::prepare::Source;
use kinesic_host::robot::look::{Drives, Look};
use kinesic_host::robot::{Machine, Robot};
use kinesic_host::view::{self, View, ViewClip, ViewFace, ViewPack};
use miette::{Context, IntoDiagnostic, miette};
use serde::Serialize;

use super::clips::{Reading, clip_paths};
use super::inspect::is_pack;
use super::origin::command_line;
use super::output::{check_output, print_json, spinner, write_whole};
use super::pictures::{Photographed, photographed};

/// Make a page on which packs play clips, emotions and faces, live: one HTML file that opens from disk
///
/// The page runs the device's own code, compiled to WebAssembly, frame by frame: skeletons side by side, time, strength or
/// expressiveness, joints, plots, foot contacts. A robot is drawn as --model describes it. Without packs it shows the two that come with the program; without clips, a
/// made-up walk. An emotion pack makes its motion itself, at strengths that sliders change while it plays. A face pack with pictures and their landmarks shows the faces with a slider.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  kinesic view
  kinesic view tired.kin walk.bvh --out tired.html
  kinesic view tired.kin walk.bvh --target tired-walk.bvh
  kinesic view models/mechanics.kin walk.bvh dance.bvh
  kinesic view anger.kin
  kinesic view lively.kin wave.csv --model desk.urdf
  kinesic view lively.kin nod.json --model mini.urdf --drives head=head_link --drives body_yaw=yaw_joint
  kinesic view smile.kin --image me.jpg --landmarks me.csv --out me.html")]
pub struct Args {
    /// Packs (.kin) and clips (BVH, Kinect CSV, a robot's moves, or folders of them), in any order
    #[arg(value_name = "FILE")]
    files: Vec<PathBuf>,
    /// What the clip should become: shown beside it (may be repeated, in the order of the clips)
    #[arg(long, value_name = "CLIP")]
    target: Vec<PathBuf>,
    /// Description of the packs' robot (URDF, or MJCF of MuJoCo): its links are drawn, with their meshes (STL, OBJ, COLLADA), which are looked for from its folder
    /// upwards; without, bones
    #[arg(long, value_name = "ROBOT.urdf")]
    model: Option<PathBuf>,
    /// What the description calls otherwise: a pose of the pack and the link that it moves, or a joint of the pack and its name there (may be repeated)
    #[arg(long, value_name = "NAME=LINK|JOINT", requires = "model", value_parser = drives)]
    drives: Vec<Drives>,
    /// Picture of a face for the face packs (JPEG or PNG; may be repeated)
    #[arg(long, value_name = "IN.jpg", requires = "landmarks")]
    image: Vec<PathBuf>,
    /// Table with the pictures' landmarks: the line whose image is the picture's file name, or the only line
    #[arg(long, value_name = "FILE.csv", requires = "image")]
    landmarks: Option<PathBuf>,
    /// HTML file to write
    #[arg(long, value_name = "FILE.html", default_value = "kinesic-view.html")]
    out: PathBuf,
    /// Seed of the made-up walk
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Print one JSON object: out, bytes, packs, clips, faces
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
    faces: Vec<String>,
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
    let (face_packs, packs) =
        read_packs(&packs, args)?.into_iter().partition::<Vec<_>, _>(|pack| holds(pack, |m| m.face().is_some()));
    let plays_clips = |m: &ModelMeta| known(m).player().is_some();
    check_plays(&packs)?;
    let (emotions, packs) = packs
        .into_iter()
        .partition::<Vec<_>, _>(|pack| holds(pack, |m| m.emotion().is_some()) && !holds(pack, plays_clips));
    for pack in packs.iter().filter(|pack| holds(pack, |m| m.emotion().is_some())) {
        eprintln!("{}.kin: the page plays its engines for clips, not its emotion", pack.name);
    }
    if let (Some(emotion), Some(clip), []) = (emotions.first(), clips.first(), &packs[..]) {
        return Err(miette!(
            help = "leave the clip out, or name a pack that plays clips too: models/weary.kin",
            "no pack plays {}: {}.kin holds emotions, whose motion comes from strengths alone",
            clip.display(),
            emotion.name
        ));
    }
    match (face_packs.first(), args.image.first()) {
        (Some(pack), None) => {
            return Err(miette!(
                help = "add --image PICTURE and --landmarks TABLE, as for `kinesic face`",
                "{}.kin is a face pack, and there is no picture of a face",
                pack.name
            ));
        }
        (None, Some(picture)) => {
            return Err(miette!(
                help = "name one: kinesic view smile.kin --image ...; `kinesic train face` makes it",
                "there is no face pack for {}",
                picture.display()
            ));
        }
        _ => {}
    }
    let faces = args.landmarks.as_ref().map(|table| photographed(&args.image, table)).transpose()?.unwrap_or_default();
    let mut shown = View { emotions, face_packs, faces: faces.into_iter().map(face).collect(), ..View::default() };
    let alone = shown.emotions.is_empty() && shown.faces.is_empty();
    check_robots(&packs, &clips)?;
    if !packs.is_empty() || !clips.is_empty() || alone {
        shown.packs = if packs.is_empty() { own_packs() } else { packs };
        shown.clips =
            if clips.is_empty() { vec![made_walk(args.seed)?] } else { read_clips(&clips, args, &shown.packs)? };
    }
    bar.set_message("playing");
    let packs = [&shown.packs, &shown.emotions, &shown.face_packs].into_iter().flatten();
    let packs: Vec<String> = packs.map(|pack| pack.name.clone()).collect();
    let title = format!("kinesic: {}", packs.join(", "));
    let made = format!("Made by kinesic {} with: {}", env!("CARGO_PKG_VERSION"), command_line());
    let page = view::page(&title, &made, &shown, view::WASM).into_diagnostic()?;
    write_whole(&args.out, page.as_bytes())?;
    bar.finish_and_clear();
    let summary = Summary {
        out: args.out.display().to_string(),
        bytes: page.len(),
        packs,
        clips: shown.clips.into_iter().map(|clip| clip.name).collect(),
        faces: shown.faces.into_iter().map(|face| face.name).collect(),
    };
    if args.json {
        return print_json(&summary);
    }
    let list = |what: &str, names: &[String]| match names {
        [] => String::new(),
        names => format!("; {what}: {}", names.join(", ")),
    };
    let [packs, clips, faces] = [("packs", &summary.packs), ("clips", &summary.clips), ("faces", &summary.faces)]
        .map(|(what, names)| list(what, names));
    println!("{}: {} bytes{packs}{clips}{faces}", summary.out, summary.bytes);
    println!("Open it in a browser.");
    Ok(())
}

/// Refuses packs of limits alone.
fn check_plays(packs: &[ViewPack]) -> miette::Result<()> {
    if let Some(pack) = packs.iter().find(|pack| !plays(pack)) {
        return Err(miette!(
            help = "learn a style first: kinesic train translate --robot ROBOT.kin --pair calm.csv lively.csv --out lively.kin",
            "{}.kin has nothing to play: it holds limits alone, and no style",
            pack.name
        ));
    }
    Ok(())
}

/// Refuses packs for clips that have no clip in common, and a robot's without one: a made-up walk is no robot's.
fn check_robots(packs: &[ViewPack], clips: &[PathBuf]) -> miette::Result<()> {
    if let (Some(pack), []) = (packs.iter().find(|pack| machine(pack).is_some()), clips) {
        return Err(miette!(
            help = "name one that it should play: kinesic view lively.kin move.csv",
            "{}.kin is a robot's pack, and there is no move of the robot",
            pack.name
        ));
    }
    let names = |of: fn(&ViewPack) -> bool| packs.iter().find(|pack| of(pack)).map(|pack| pack.name.clone());
    if let (Some(robot), Some(body)) = (names(|pack| machine(pack).is_some()), names(|pack| machine(pack).is_none())) {
        return Err(miette!(
            help = "make a page of each",
            "{robot}.kin is a robot's pack and {body}.kin a person's: no clip is one of both"
        ));
    }
    Ok(())
}

/// Whether anything in a pack can be shown. (One that cannot be read is refused later.)
fn plays(pack: &ViewPack) -> bool {
    let shown = |m: &ModelMeta| known(m).player().is_some() || m.emotion().is_some() || m.face().is_some();
    pack.file.pack().is_err() || holds(pack, shown)
}

/// The robot of a pack.
fn machine(pack: &ViewPack) -> Option<Machine> {
    Machine::from_pack(&pack.file.pack().ok()?).ok()?
}

/// Whether a pack holds such a model. (One that cannot be read holds none; the page's maker says why.)
fn holds(pack: &ViewPack, such: impl Fn(&ModelMeta) -> bool) -> bool {
    pack.file.pack().is_ok_and(|pack| pack.metadata().models.iter().any(|model| such(&model)))
}

fn face(from: Photographed) -> ViewFace {
    ViewFace { name: from.name, picture: from.picture, landmarks: from.landmarks }
}

fn stem(path: &Path) -> String {
    path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

fn own_packs() -> Vec<ViewPack> {
    let pack = |name: &str, file| ViewPack { name: name.to_owned(), file, look: None };
    vec![pack("weary", models::weary()), pack("mechanics", models::mechanics())]
}

fn read_packs(paths: &[PathBuf], args: &Args) -> miette::Result<Vec<ViewPack>> {
    let robot = args.model.as_ref().map(|path| description(path)).transpose()?;
    let mut notes = Vec::new();
    let mut machines = 0;
    let read = |path: &PathBuf| {
        let file = PackFile::read(path).into_diagnostic()?;
        let pack = file.pack().into_diagnostic()?;
        let machine = Machine::from_pack(&pack).into_diagnostic().wrap_err_with(|| path.display().to_string())?;
        machines += usize::from(machine.is_some());
        let look = match (&robot, machine, &args.model) {
            (Some(robot), Some(machine), Some(model)) => {
                let folder = model.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
                let look = Look::of_robot(&machine, robot, folder, &args.drives);
                Some(look.map_err(|error| error.in_file(model)).wrap_err_with(|| path.display().to_string())?)
            }
            _ => None,
        };
        notes.extend(look.iter().flat_map(|look| look.notes.iter().cloned()));
        Ok(ViewPack { name: stem(path), file, look })
    };
    let packs = paths.iter().map(read).collect::<miette::Result<_>>()?;
    if let (Some(model), 0) = (&args.model, machines) {
        return Err(miette!(
            help = "name one: kinesic robot import makes it, and training with --robot keeps it",
            "no pack has a robot to draw as {}",
            model.display()
        ));
    }
    notes.dedup();
    let model = args.model.as_ref().map_or(String::new(), |model| model.display().to_string());
    notes.iter().for_each(|note| eprintln!("note: {}", plain::line(&format!("{model}: {note}"))));
    Ok(packs)
}

/// Reads a robot's description.
fn description(path: &Path) -> miette::Result<Robot> {
    if is_pack(path) || path.extension().is_some_and(|found| found.eq_ignore_ascii_case("toml")) {
        return Err(miette!(
            help = "leave --model out: the pack's bones are drawn",
            "--model {}: found a pack or a table of servos, expected a description (URDF, or MJCF of MuJoCo): the others do not say how links look",
            path.display()
        ));
    }
    Ok(Robot::read(path)?)
}

/// `NAME=LINK`.
fn drives(text: &str) -> Result<Drives, String> {
    match text.split_once('=') {
        Some((name, what)) if !name.is_empty() && !what.is_empty() => {
            Ok(Drives { name: name.to_owned(), what: what.to_owned() })
        }
        _ => Err("expected NAME=LINK or NAME=JOINT, as in head=head_link".to_owned()),
    }
}

fn read_clips(paths: &[PathBuf], args: &Args, packs: &[ViewPack]) -> miette::Result<Vec<ViewClip>> {
    let options = match packs.first() {
        Some(pack) => args.reading.options_for(&pack.file.pack().into_diagnostic()?)?,
        None => args.reading.options()?,
    };
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
        Ok::<_, miette::Report>(Source::new(name, clip, map))
    };
    let seeds = seed.wrapping_mul(1000);
    Ok(ViewClip {
        name: "a made-up walk".to_owned(),
        source: made("made-up walk", &Manner::NEUTRAL, seeds.wrapping_add(3))?,
        target: Some(made("made-up weary walk", &Manner::WEARY, seeds.wrapping_add(4))?),
    })
}
