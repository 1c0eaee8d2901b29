//! What the commands for expressiveness share: a body-mechanics pack, clips on its rig, masks, times, and what is said of a result.

use std::path::{Path, PathBuf};

use kinesic::Pack;
use kinesic::Pose;
use kinesic::mechanics::{Decoupled, Modulation};
use kinesic_host::clip::Clip;
use kinesic_host::mechanics::{Expressive, NEW, decouple};
use kinesic_host::pack::PackFile;
use kinesic_host::prepare::Source;
use kinesic_host::rig::{MAX_JOINTS, Rig};
use miette::{IntoDiagnostic, miette};
use serde::Serialize;

use super::clips::Reading;
use super::land::{Feet, Judged, Landed, On, Place};
use super::mask;

/// Jerk over the clip's own from which a result is called rough.
const ROUGH: f64 = 1.3;
/// Jerk over the clip's own up to which expression is smoothed, and by how much at most, in widths of its bell.
const SMOOTH: f64 = 1.25;
const SLOWER: [f64; 7] = [1.0, 1.4, 2.0, 2.8, 4.0, 5.6, 8.0];
/// Softness of held feet under the narrowest bell, s.
const SOFT: f64 = 0.025;
/// Part of the network's input that is new to it from which a clip is called unlike the training, percent.
const UNLIKE: f64 = 3.0;

/// A pack and its rig.
pub struct Body {
    file: PackFile,
    /// The pack's skeleton.
    pub rig: Rig,
    /// The pack's frames per second.
    pub fps: f64,
}

/// A clip, and what it is on the rig.
pub struct Motion {
    /// As it was given.
    pub source: Source,
    /// On the rig, at the pack's rate.
    pub clip: Clip,
    /// The same as poses.
    pub poses: Vec<Pose<MAX_JOINTS>>,
    /// Its parts, frame by frame as on the device.
    pub parts: Vec<Decoupled<MAX_JOINTS>>,
    /// What it expresses, smooth.
    pub expressive: Expressive,
}

impl Body {
    /// Reads a pack.
    pub fn read(path: &Path) -> miette::Result<Self> {
        let file = PackFile::read(path).into_diagnostic()?;
        let pack = file.pack().into_diagnostic()?;
        let rig = Rig::from_pack(&pack).into_diagnostic()?;
        let fps = f64::from(pack.metadata().frame_rate);
        Ok(Self { file, rig, fps })
    }

    /// The pack.
    pub fn pack(&self) -> miette::Result<Pack<'_>> {
        self.file.pack().into_diagnostic()
    }

    /// Reads a clip, puts it on the rig and decouples it.
    pub fn decouple(&self, path: &Path, reading: &Reading) -> miette::Result<Motion> {
        let source = Source::read(path, &reading.options()?).into_diagnostic()?;
        let clip = source.on_rig(&self.rig, self.fps).into_diagnostic()?;
        let poses = self.rig.poses(&clip);
        let pack = self.pack()?;
        let parts = decouple(&pack, &poses).into_diagnostic()?;
        let joints = self.rig.joints();
        let expressive = Expressive::of(&pack, &poses, joints, source.clip.fps()).into_diagnostic()?;
        Ok(Motion { source, clip, poses, parts, expressive })
    }

    /// Where results land that are made of this clip.
    pub fn place(&self, on: Option<On>, feet: Option<Feet>, source: &Source) -> miette::Result<Place> {
        Place::choose(on, feet, &self.pack()?, Some(source))
    }

    /// A clip on the rig at its own rate.
    pub fn own_rate(&self, source: &Source) -> miette::Result<Clip> {
        source.quiet().on_rig(&self.rig, source.clip.fps()).into_diagnostic()
    }

    /// Poses as a clip.
    pub fn clip(&self, poses: &[Pose<MAX_JOINTS>]) -> Clip {
        self.rig.clip(poses, 1.0 / self.fps)
    }

    /// Amount and mask, see [`super::mask`].
    pub fn modulation(&self, amount: f32, masks: &[String]) -> miette::Result<Modulation<MAX_JOINTS>> {
        if !amount.is_finite() {
            return Err(miette!("--amount {amount}: expected a finite number, for example 1.5"));
        }
        let mut modulation = Modulation { amount, ..Modulation::default() };
        mask::apply(masks, &self.rig, f32::MAX, &mut modulation.mask)?;
        Ok(modulation)
    }
}

impl Motion {
    /// Its name.
    pub fn name(&self) -> String {
        self.source.name()
    }

    /// Mean angle of the expressive part over frames and joints but the hips, degrees.
    pub fn expression_deg(&self) -> f64 {
        let joints = self.clip.skeleton.len();
        let angles = self.parts.iter().flat_map(|p| p.expressive.iter().take(joints).skip(1));
        let sum: f64 = angles.map(kinesic::mechanics::angle).map(f64::from).sum();
        sum.to_degrees() / (self.parts.len() * joints.saturating_sub(1)).max(1) as f64
    }
}

/// A result, as quick as it can be without being rough.
pub struct Smooth<'a> {
    /// Where it belongs.
    pub landed: Landed<'a>,
    quality: Judged,
    slower: Option<f64>,
}

impl<'a> Smooth<'a> {
    /// As the device makes it.
    pub fn not(landed: Landed<'a>) -> Self {
        let quality = landed.judge(&landed.clip);
        Self { landed, quality, slower: None }
    }

    /// The first of ever slower results that is smooth, else the smoothest. `make` makes one with expression under a bell so many times as wide,
    /// and feet as soft as told, s. Where they are rough with feet held, and `held` is not what the user asked for, feet are let go.
    pub fn of(
        place: &Place,
        held: bool,
        make: impl Fn(&Place, f64, f64) -> miette::Result<Landed<'a>>,
    ) -> miette::Result<Self> {
        let best = Self::smoothest(|slower, soft| make(place, slower, soft))?;
        if held || best.quality.jerk_ratio().is_none_or(|ratio| ratio <= ROUGH) {
            return Ok(best);
        }
        let place = place.let_go();
        let free = Self::smoothest(|slower, soft| make(&place, slower, soft))?;
        Ok(if free.quality.jerk_ratio() < best.quality.jerk_ratio() { free } else { best })
    }

    fn smoothest(make: impl Fn(f64, f64) -> miette::Result<Landed<'a>>) -> miette::Result<Self> {
        let mut best: Option<(f64, Self)> = None;
        for slower in SLOWER {
            let landed = make(slower, SOFT * slower.min(4.0))?;
            let quality = landed.judge(&landed.clip);
            let ratio = quality.jerk_ratio().unwrap_or(0.0);
            if best.as_ref().is_none_or(|(least, _)| ratio < *least) {
                best = Some((ratio, Self { landed, quality, slower: Some(slower) }));
            }
            if ratio <= SMOOTH {
                break;
            }
        }
        best.map(|(_, result)| result).ok_or_else(|| miette!("no result was made"))
    }
}

/// What is said of a result.
#[derive(Serialize)]
pub struct Said {
    /// Mean angle of the clip's own E* frame by frame, degrees.
    expressive_deg: f64,
    /// Part of what the network saw that is new to it, percent.
    new_percent: f64,
    #[serde(flatten)]
    quality: Judged,
    /// Movements a second that keep half their size in what is scaled; none where every frame is split by itself.
    #[serde(skip_serializing_if = "Option::is_none")]
    cut_off_hz: Option<f64>,
    /// Jerk of the result over that of the clip.
    #[serde(skip_serializing_if = "Option::is_none")]
    jerk_ratio: Option<f64>,
    /// What is doubtful.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    notes: Vec<String>,
}

impl Said {
    /// Of a result that `motions` were made into, the first of which it is compared with.
    pub fn of(motions: &[&Motion], result: Smooth<'_>) -> Self {
        let quality = result.quality;
        let jerk_ratio = quality.jerk_ratio();
        let mut notes = Vec::new();
        for motion in motions.iter().filter(|motion| motion.expressive.new_percent() > UNLIKE) {
            notes.push(format!(
                "{}: {:.0} % of what the network sees lies beyond {NEW} deviations of its training: what it calls expression may be the \
                 body's own way, or the skeleton's",
                motion.name(),
                motion.expressive.new_percent()
            ));
        }
        if let Some(ratio) = jerk_ratio.filter(|ratio| *ratio > ROUGH) {
            notes.push(format!(
                "the result's jerk is {ratio:.2} times the clip's: over {ROUGH} it looks rough. Ask for less, or smooth it: kinesic edit --smooth"
            ));
        }
        let first = motions.first();
        let cut_off = |slower: f64| first.map(|motion| motion.expressive.slower(slower).cut_off());
        Self {
            cut_off_hz: result.slower.and_then(cut_off),
            expressive_deg: first.map_or(0.0, |motion| motion.expression_deg()),
            new_percent: first.map_or(0.0, |motion| motion.expressive.new_percent()),
            quality,
            jerk_ratio,
            notes,
        }
    }

    /// Warnings, on standard error.
    pub fn warn(&self) {
        self.notes.iter().for_each(|note| eprintln!("warning: {note}"));
    }

    /// The table.
    pub fn print(&self) {
        self.quality.print();
        if let Some(ratio) = self.jerk_ratio {
            println!("jerk       {ratio:.2} times the clip's");
        }
        println!(
            "expression {:.1} degrees a joint; {:.1} % of the network's input is beyond its training",
            self.expressive_deg, self.new_percent
        );
        if let Some(hz) = self.cut_off_hz {
            println!("scaled     movements below about {hz:.1} a second");
        }
    }
}

/// `T0..T1` in seconds.
pub fn window(text: &str) -> Result<[f32; 2], String> {
    let parse = || {
        let (start, end) = text.split_once("..")?;
        Some([start.trim().parse().ok()?, end.trim().parse().ok()?])
    };
    match parse() {
        Some([start, end]) if f32::is_finite(start) && f32::is_finite(end) && start <= end => Ok([start, end]),
        _ => Err("expected T0..T1 in seconds, T0 not after T1, for example 1.0..1.5".to_owned()),
    }
}

/// A time within a motion of `seconds`.
pub fn time(option: &str, time: f64, seconds: f64, clip: &str) -> miette::Result<()> {
    if !(time.is_finite() && time >= 0.0) {
        return Err(miette!("{option} {time}: expected seconds from 0 up"));
    }
    if time > seconds {
        return Err(miette!(
            help = "give an earlier time",
            "{option} {time}: {clip} lasts {seconds:.2} s, that is past its end"
        ));
    }
    Ok(())
}

/// Outputs that must be motions.
pub fn outputs(paths: &[&PathBuf]) -> miette::Result<()> {
    paths.iter().try_for_each(|path| super::output::check_motion(path, false))
}
