//! Runs an image in QEMU, with the plugin counting, and reads what the image reports.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use crate::build::{BuildError, write};
use crate::data::Target;
use crate::elf::{ElfError, Image};
use crate::profile::{Profile, ProfileError};

/// Longer than any run takes; a hung image ends here.
const TIME_LIMIT: Duration = Duration::from_secs(300);
/// The same for a run that is not counted: a soak.
const SOAK_LIMIT: Duration = Duration::from_secs(3600);

/// What a run of an image gave.
#[derive(Clone, Debug)]
pub struct Run {
    /// Hash of each frame's output.
    pub hashes: Vec<u64>,
    /// Deepest stack until the first frame, B.
    pub stack_start_up: u64,
    /// Deepest stack while frames ran, B.
    pub stack_frames: u64,
    /// What the plugin counted.
    pub profile: Profile,
}

/// A run failed.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum RunError {
    /// The image lacks something.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Elf(#[from] ElfError),
    /// A file cannot be written.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Write(#[from] BuildError),
    /// The counts cannot be used.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Profile(#[from] ProfileError),
    /// QEMU cannot be started.
    #[error("cannot start {program}: {source}")]
    #[diagnostic(help("run firmware-sim/setup.sh as root (Debian: installs qemu-system-arm and qemu-system-misc)"))]
    Start {
        /// The program.
        program: String,
        /// Why.
        source: std::io::Error,
    },
    /// The image gave up: it panicked, faulted, or refused its input.
    #[error("the image {} stopped: {reason}", image.display())]
    #[diagnostic(help("{command}"))]
    Stopped {
        /// The image.
        image: PathBuf,
        /// Its last words, or the emulator's.
        reason: String,
        /// The command, to run by hand.
        command: String,
    },
    /// The image did not end.
    #[error("the image {} ran for more than {} s and was ended", image.display(), limit.as_secs())]
    Hung {
        /// The image.
        image: PathBuf,
        /// The time that it had.
        limit: Duration,
    },
}

/// Runs `image` on `target` over `input` (a block of frames). All files stay in `folder`. Without the plugin nothing is counted, and
/// the profile is empty: several times as fast.
pub fn run(
    target: &Target,
    image: &Image,
    plugin: Option<&Path>,
    input: &[u8],
    folder: &Path,
) -> Result<Run, RunError> {
    let file = |name: &str| folder.join(name);
    write(&file("frames.bin"), input)?;
    for stale in ["report.txt", "counts.txt"] {
        // A file of an earlier run must not pass for this one's; it may well not exist.
        let _ = std::fs::remove_file(file(stale));
    }
    let (begin, end) = (image.address("kinesic_frame_begin")?, image.address("kinesic_frame_end")?);
    let mut qemu = Command::new(&target.emulator);
    qemu.args(["-M", &target.machine, "-display", "none", "-monitor", "none", "-serial", "none", "-nodefaults"])
        // One instruction is one nanosecond of virtual time: a run repeats to the digit, timers included.
        .args(["-icount", "shift=0"])
        .arg("-kernel")
        .arg(&image.path)
        .arg("-device")
        .arg(format!("loader,file={},addr={:#x},force-raw=on", file("frames.bin").display(), target.frames))
        .arg("-chardev")
        .arg(format!("file,id=report,path={}", file("report.txt").display()))
        .args(["-semihosting-config", "enable=on,target=native,chardev=report"])
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::piped());
    if let Some(plugin) = plugin {
        qemu.arg("-plugin").arg(format!(
            "{},out={},begin={begin:x},end={end:x},code={}",
            plugin.display(),
            file("counts.txt").display(),
            target.isa.code()
        ));
    }
    if target.machine == "virt" {
        qemu.args(["-bios", "none"]);
    }
    let command = format!("{qemu:?}");
    let limit = if plugin.is_some() { TIME_LIMIT } else { SOAK_LIMIT };
    let (success, words) = wait(qemu, target, image, limit)?;
    let report = std::fs::read_to_string(file("report.txt")).unwrap_or_default();
    let stopped = || RunError::Stopped {
        image: image.path.clone(),
        reason: last_words(&report, &words),
        command: command.clone(),
    };
    let mut run = parse(&report).filter(|_| success).ok_or_else(stopped)?;
    if plugin.is_some() {
        run.profile = Profile::read(&file("counts.txt"))?;
    }
    Ok(run)
}

fn wait(mut qemu: Command, target: &Target, image: &Image, limit: Duration) -> Result<(bool, String), RunError> {
    let start = |source| RunError::Start { program: target.emulator.clone(), source };
    let mut child = qemu.spawn().map_err(start)?;
    let began = Instant::now();
    loop {
        if child.try_wait().map_err(start)?.is_some() {
            let output = child.wait_with_output().map_err(start)?;
            return Ok((output.status.success(), String::from_utf8_lossy(&output.stderr).into_owned()));
        }
        if began.elapsed() > limit {
            child.kill().map_err(start)?;
            child.wait().map_err(start)?;
            return Err(RunError::Hung { image: image.path.clone(), limit });
        }
        std::thread::sleep(Duration::from_millis(5));
    }
}

fn last_words(report: &str, words: &str) -> String {
    let aborted = report.lines().find_map(|line| line.strip_prefix("abort "));
    aborted.or(words.lines().last()).unwrap_or("without a word").to_owned()
}

/// Lines `frame HASH`, `stack-start-up N`, `stack-frames N`, `done`, numbers in hexadecimal.
fn parse(report: &str) -> Option<Run> {
    let empty = Profile { frames: Vec::new(), instructions: Default::default() };
    let mut run = Run { hashes: Vec::new(), stack_start_up: 0, stack_frames: 0, profile: empty };
    let mut done = false;
    for line in report.lines() {
        let (label, digits) = line.split_once(' ').unwrap_or((line, "0"));
        let value = u64::from_str_radix(digits, 16).ok()?;
        match label {
            "frame" => run.hashes.push(value),
            "stack-start-up" => run.stack_start_up = value,
            "stack-frames" => run.stack_frames = value,
            "done" => done = true,
            _ => return None,
        }
    }
    done.then_some(run)
}
