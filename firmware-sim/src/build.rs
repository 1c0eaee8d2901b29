//! Builds images and the emulator's plugin into the folder `firmware` of cargo's target folder, where they stay cached.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::data::{Target, home};
use crate::toolchain::Toolchain;

/// A build failed.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum BuildError {
    /// A file of the build cannot be written.
    #[error("cannot write {}: {source}", path.display())]
    Write {
        /// The file or folder.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// cargo cannot be started.
    #[error("cannot start {}: {source}", program.display())]
    Start {
        /// The program.
        program: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// cargo says no.
    #[error("building {what} failed:\n{log}")]
    #[diagnostic(help("{command}"))]
    Failed {
        /// What was built.
        what: String,
        /// What cargo printed.
        log: String,
        /// The command, to run by hand.
        command: String,
    },
}

/// Where everything of a run lies.
#[derive(Clone, Debug)]
pub struct Folders {
    root: PathBuf,
}

impl Folders {
    /// The folder `firmware` in cargo's target folder.
    pub fn new() -> Self {
        let workspace = home().parent().map_or_else(home, Path::to_owned);
        let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| workspace.join("target"), PathBuf::from);
        let root = if target.is_absolute() { target } else { workspace.join(target) };
        Self { root: root.join("firmware") }
    }

    /// The packs that images include.
    pub fn packs(&self) -> PathBuf {
        self.root.join("packs")
    }

    /// A folder of a target.
    pub fn target(&self, name: &str) -> PathBuf {
        self.root.join(name)
    }

    /// The folder of a run's files: input frames, output, counts.
    pub fn run(&self, target: &str, workload: &str) -> PathBuf {
        self.target(target).join("run").join(workload)
    }
}

impl Default for Folders {
    fn default() -> Self {
        Self::new()
    }
}

/// Writes a file, if its content changed, so that cargo rebuilds only what it must.
pub fn write(path: &Path, content: &[u8]) -> Result<(), BuildError> {
    if std::fs::read(path).is_ok_and(|old| old == content) {
        return Ok(());
    }
    let error = |source| BuildError::Write { path: path.to_owned(), source };
    std::fs::create_dir_all(path.parent().unwrap_or(path)).map_err(error)?;
    std::fs::write(path, content).map_err(error)
}

/// The linker's view of the part, for `cortex-m-rt` and `riscv-rt` alike.
fn layout(target: &Target) -> String {
    let aliases = ["TEXT", "RODATA"].map(|region| format!("REGION_ALIAS(\"REGION_{region}\", FLASH);\n")).concat()
        + &["DATA", "BSS", "HEAP", "STACK"].map(|region| format!("REGION_ALIAS(\"REGION_{region}\", RAM);\n")).concat();
    format!(
        "MEMORY\n{{\n  FLASH : ORIGIN = {:#x}, LENGTH = {}K\n  RAM : ORIGIN = {:#x}, LENGTH = {}K\n}}\n{aliases}_kinesic_frames = {:#x};\n",
        target.flash.origin, target.flash.kib, target.ram.origin, target.ram.kib, target.frames
    )
}

/// Builds images of a target and returns their folder.
pub fn images(
    folders: &Folders,
    name: &str,
    target: &Target,
    toolchain: &Toolchain,
    binaries: &[&str],
) -> Result<PathBuf, BuildError> {
    let folder = folders.target(name);
    write(&folder.join("layout/memory.x"), layout(target).as_bytes())?;
    let mut flags = vec![format!("-Ctarget-cpu={}", target.cpu), format!("-Clinker={}", toolchain.linker.display())];
    flags.push("-Clinker-flavor=ld.lld".to_owned());
    if !target.features.is_empty() {
        flags.push(format!("-Ctarget-feature={}", target.features));
    }
    let settings = vec![("KINESIC_LAYOUT", folder.join("layout").into()), ("KINESIC_PACKS", folders.packs().into())];
    let what = format!("the images for {name}");
    let project = home().join("image");
    let programs: Vec<Program> = binaries.iter().map(|binary| Program::Bin(binary)).collect();
    BareMetal { what, project, folder, triple: &target.triple, flags, programs: &programs, settings }.build(toolchain)
}

/// Builds a program of the project that users copy, `docs/board`, and returns the image. Its own files say where memory is.
pub fn board(
    folders: &Folders,
    name: &str,
    target: &Target,
    toolchain: &Toolchain,
    program: Program<'_>,
) -> Result<PathBuf, BuildError> {
    let flags = vec![format!("-Clinker={}", toolchain.linker.display()), "-Clinker-flavor=ld.lld".to_owned()];
    let (what, project) = (format!("docs/board for {name}"), home().join("../docs/board"));
    let (folder, programs) = (folders.target(name).join("board"), &[program][..]);
    let built = BareMetal { what, project, folder, triple: &target.triple, flags, programs, settings: Vec::new() }
        .build(toolchain)?;
    Ok(match program {
        Program::Bin(name) => built.join(name),
        Program::Example(name) => built.join("examples").join(name),
    })
}

/// Builds the static library for C (`c/`) for a target, and returns it.
pub fn c_library(folders: &Folders, name: &str, target: &Target, toolchain: &Toolchain) -> Result<PathBuf, BuildError> {
    let (what, project, folder) =
        (format!("the C library for {name}"), home().join("../c"), folders.target(name).join("c"));
    let flags = vec![format!("-Ctarget-cpu={}", target.cpu)];
    let built = BareMetal { what, project, folder, triple: &target.triple, flags, programs: &[], settings: Vec::new() }
        .build(toolchain)?;
    Ok(built.join("libkinesic_c.a"))
}

/// Builds the core for browsers (`wasm/`), and returns the module.
pub fn wasm(folders: &Folders, toolchain: &Toolchain) -> Result<PathBuf, BuildError> {
    let (what, project, folder) = ("the core for browsers".to_owned(), home().join("../wasm"), folders.target("wasm"));
    let flags = vec![format!("-Clinker={}", toolchain.linker.display()), "-Clinker-flavor=wasm-ld".to_owned()];
    let built = BareMetal { what, project, folder, triple: WASM, flags, programs: &[], settings: Vec::new() }
        .build(toolchain)?;
    Ok(built.join("kinesic_wasm.wasm"))
}

/// Target of the core for browsers.
pub const WASM: &str = "wasm32-unknown-unknown";

/// A program of a crate.
#[derive(Clone, Copy, Debug)]
pub enum Program<'a> {
    /// One of its binaries.
    Bin(&'a str),
    /// One of its examples.
    Example(&'a str),
}

/// Programs, or the library, of a crate without an operating system.
struct BareMetal<'a> {
    what: String,
    project: PathBuf,
    folder: PathBuf,
    triple: &'a str,
    flags: Vec<String>,
    programs: &'a [Program<'a>],
    settings: Vec<(&'static str, OsString)>,
}

impl BareMetal<'_> {
    /// Builds them and returns their folder.
    fn build(mut self, toolchain: &Toolchain) -> Result<PathBuf, BuildError> {
        let mut cargo = Command::new(&toolchain.cargo);
        cargo
            .current_dir(&self.project)
            .args(["build", "--release", "--locked", "--quiet", "--target", self.triple, "--target-dir"])
            .arg(&self.folder)
            .args(self.programs.iter().flat_map(|program| match program {
                Program::Bin(name) => ["--bin", name],
                Program::Example(name) => ["--example", name],
            }))
            .args(toolchain.builds_core.then_some("-Zbuild-std=core"));
        self.settings.push(("RUSTC", toolchain.rustc.clone().into()));
        self.settings.push(("CARGO_ENCODED_RUSTFLAGS", self.flags.join("\x1f").into()));
        if toolchain.builds_core {
            // Building the library from source is unstable for cargo's interface, not for the result: the compiler is a release.
            self.settings.push(("RUSTC_BOOTSTRAP", "1".into()));
        }
        run(cargo, self.settings, &self.what)?;
        Ok(self.folder.join(self.triple).join("release"))
    }
}

/// Builds the plugin for the host and returns the library.
pub fn plugin(folders: &Folders) -> Result<PathBuf, BuildError> {
    let folder = folders.target("plugin");
    let mut cargo = Command::new("cargo");
    cargo
        .current_dir(home().join("plugin"))
        .args(["build", "--release", "--locked", "--quiet", "--target-dir"])
        .arg(&folder);
    run(cargo, Vec::new(), "the emulator's plugin")?;
    Ok(folder.join("release/libkinesic_qemu_plugin.so"))
}

/// What a surrounding `cargo run` or `cargo test` set is about its own build, and would make another one look changed.
fn clean(command: &mut Command) {
    let own = ["CARGO_HOME", "CARGO_HTTP", "CARGO_NET", "CARGO_REGISTR", "CARGO_TERM", "CARGO_SOURCE", "RUSTUP_HOME"];
    for (name, _) in std::env::vars_os() {
        let text = name.to_string_lossy();
        let cargos = ["CARGO", "RUST", "OUT_DIR", "LD_LIBRARY_PATH"].iter().any(|prefix| text.starts_with(prefix));
        if cargos && !own.iter().any(|prefix| text.starts_with(prefix)) {
            command.env_remove(&name);
        }
    }
}

/// A line of a page, as its reader types it, with the compiler that was found instead of rustup's target.
pub fn shell(line: &str, folder: &Path, toolchain: &Toolchain) -> Command {
    let mut command = Command::new("sh");
    clean(&mut command);
    // `exec`, so that the program can be ended.
    command.args(["-c", &format!("exec {line}")]).current_dir(folder).env("RUSTC", &toolchain.rustc);
    if let Some(folder) = toolchain.cargo.parent().filter(|folder| folder.is_absolute()) {
        let path = std::env::var("PATH").unwrap_or_default();
        command.env("PATH", format!("{}:{path}", folder.display()));
    }
    let linker = format!("-Clinker={}\x1f-Clinker-flavor=ld.lld", toolchain.linker.display());
    command.env("CARGO_ENCODED_RUSTFLAGS", linker);
    if toolchain.builds_core {
        command.envs([("CARGO_UNSTABLE_BUILD_STD", "core"), ("RUSTC_BOOTSTRAP", "1")]);
    }
    command
}

fn run(mut command: Command, settings: Vec<(&str, OsString)>, what: &str) -> Result<(), BuildError> {
    clean(&mut command);
    for (name, value) in settings {
        command.env(name, value);
    }
    let program = PathBuf::from(command.get_program());
    let output = command.output().map_err(|source| BuildError::Start { program, source })?;
    if output.status.success() {
        return Ok(());
    }
    Err(BuildError::Failed {
        what: what.to_owned(),
        log: String::from_utf8_lossy(&output.stderr).into_owned(),
        command: format!("{command:?}"),
    })
}
