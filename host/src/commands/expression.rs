//! What the commands for expressiveness share: a body-mechanics pack, clips on its rig, masks, times.

use std::path::{Path, PathBuf};

use kinesic::Pose;
use kinesic::mechanics::{Decoupled, Modulation};
use kinesic_host::clip::Clip;
use kinesic_host::mechanics::decouple;
use kinesic_host::pack::PackFile;
use kinesic_host::prepare::Source;
use kinesic_host::rig::{MAX_JOINTS, Rig};
use miette::{IntoDiagnostic, miette};

use super::clips::Reading;
use super::mask;

/// A pack and its rig.
pub struct Body {
    file: PackFile,
    /// The skeleton of all results.
    pub rig: Rig,
    /// Frames per second of all results.
    pub fps: f64,
}

/// A clip on the rig, in its two parts.
pub struct Motion {
    /// The clip's name.
    pub name: String,
    /// What was observed.
    pub poses: Vec<Pose<MAX_JOINTS>>,
    /// Its parts.
    pub parts: Vec<Decoupled<MAX_JOINTS>>,
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

    /// Reads a clip, puts it on the rig and decouples it.
    pub fn decouple(&self, path: &Path, reading: &Reading) -> miette::Result<Motion> {
        let source = Source::read(path, &reading.options()?).into_diagnostic()?;
        let clip = source.on_rig(&self.rig, self.fps).into_diagnostic()?;
        let poses = self.rig.poses(&clip);
        let parts = decouple(&self.file.pack().into_diagnostic()?, &poses).into_diagnostic()?;
        Ok(Motion { name: source.name(), poses, parts })
    }

    /// Poses as a clip.
    pub fn clip(&self, poses: &[Pose<MAX_JOINTS>]) -> Clip {
        self.rig.clip(poses, 1.0 / self.fps)
    }

    /// Writes poses in the format that the path says.
    pub fn write(&self, poses: &[Pose<MAX_JOINTS>], path: &Path) -> miette::Result<()> {
        self.clip(poses).write(path).into_diagnostic()
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

/// Mean angle of the expressive part over frames and joints but the hips, degrees.
pub fn expression_deg(parts: &[Decoupled<MAX_JOINTS>], joints: usize) -> f64 {
    let angles = parts.iter().flat_map(|p| p.expressive.iter().take(joints).skip(1)).map(kinesic::mechanics::angle);
    angles.map(f64::from).sum::<f64>().to_degrees() / (parts.len() * joints.saturating_sub(1)).max(1) as f64
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
