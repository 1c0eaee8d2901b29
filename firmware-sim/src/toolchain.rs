//! Finds a compiler for the targets: a rustup target where it is installed, else a compiler that comes with the sources of
//! its library (Debian's `rustc-web`, `cargo-web`, `rust-web-src`), else a message that says what to install.

use std::path::{Path, PathBuf};
use std::process::Command;

/// How images are built for a target.
#[derive(Clone, Debug)]
pub struct Toolchain {
    /// The cargo to call.
    pub cargo: PathBuf,
    /// The rustc it shall call.
    pub rustc: PathBuf,
    /// The linker.
    pub linker: PathBuf,
    /// True if the target's `core` is built from source.
    pub builds_core: bool,
    /// rustc's own words about its version.
    pub version: String,
}

/// No compiler builds for the target.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum ToolchainError {
    /// Neither a ready library nor its sources.
    #[error("no installed Rust compiler builds for {triple}")]
    #[diagnostic(help(
        "run firmware-sim/setup.sh as root (Debian: installs rustc-web, cargo-web, rust-web-src and QEMU), \
         or `rustup target add {triple}`, or `rustup component add rust-src`"
    ))]
    NoCompiler {
        /// The target.
        triple: String,
    },
    /// A compiler without a linker.
    #[error("{} builds for {triple}, but no linker for ELF was found", rustc.display())]
    #[diagnostic(help("install lld (Debian: `apt-get install lld`), or a rustup toolchain, which brings rust-lld"))]
    NoLinker {
        /// The target.
        triple: String,
        /// The compiler.
        rustc: PathBuf,
    },
}

struct Compiler {
    cargo: PathBuf,
    rustc: PathBuf,
    sysroot: PathBuf,
    host: String,
    version: String,
}

fn output(program: &Path, arguments: &[&str]) -> Option<String> {
    let output = Command::new(program).args(arguments).output().ok()?;
    output.status.success().then(|| String::from_utf8_lossy(&output.stdout).trim().to_owned())
}

impl Compiler {
    fn new(cargo: PathBuf, rustc: PathBuf) -> Option<Self> {
        let verbose = output(&rustc, &["-vV"])?;
        output(&cargo, &["--version"])?;
        let host = verbose.lines().find_map(|line| line.strip_prefix("host: "))?.to_owned();
        let version = verbose.lines().next()?.to_owned();
        let sysroot = PathBuf::from(output(&rustc, &["--print", "sysroot"])?);
        Some(Self { cargo, rustc, sysroot, host, version })
    }

    fn has_target(&self, triple: &str) -> bool {
        self.sysroot.join("lib/rustlib").join(triple).join("lib").is_dir()
    }

    fn has_sources(&self) -> bool {
        self.sysroot.join("lib/rustlib/src/rust/library/Cargo.lock").is_file()
    }

    fn rust_lld(&self) -> Option<PathBuf> {
        let path = self.sysroot.join("lib/rustlib").join(&self.host).join("bin/rust-lld");
        path.is_file().then_some(path)
    }
}

/// The compilers worth asking: the one on the path, and the distribution's behind it.
fn compilers() -> Vec<Compiler> {
    let pairs = [("cargo", "rustc"), ("/usr/bin/cargo", "/usr/bin/rustc")];
    pairs.iter().filter_map(|(cargo, rustc)| Compiler::new(cargo.into(), rustc.into())).collect()
}

/// A linker beside the compilers': lld as the distribution names it.
fn distribution_lld() -> Option<PathBuf> {
    let versions = (14..=30).rev().map(|version| format!("ld.lld-{version}"));
    std::iter::once("ld.lld".to_owned())
        .chain(versions)
        .map(PathBuf::from)
        .find(|program| output(program, &["--version"]).is_some())
}

/// The compiler for a target.
pub fn find(triple: &str) -> Result<Toolchain, ToolchainError> {
    let compilers = compilers();
    let make = |compiler: &Compiler, linker, builds_core| Toolchain {
        cargo: compiler.cargo.clone(),
        rustc: compiler.rustc.clone(),
        linker,
        builds_core,
        version: compiler.version.clone(),
    };
    let any_lld = || compilers.iter().find_map(Compiler::rust_lld).or_else(distribution_lld);
    let no_linker =
        |compiler: &Compiler| ToolchainError::NoLinker { triple: triple.to_owned(), rustc: compiler.rustc.clone() };
    if let Some(compiler) = compilers.iter().find(|compiler| compiler.has_target(triple)) {
        let linker = compiler.rust_lld().or_else(any_lld).ok_or_else(|| no_linker(compiler))?;
        return Ok(make(compiler, linker, false));
    }
    let compiler = compilers
        .iter()
        .find(|compiler| compiler.has_sources())
        .ok_or_else(|| ToolchainError::NoCompiler { triple: triple.to_owned() })?;
    let linker = any_lld().ok_or_else(|| no_linker(compiler))?;
    Ok(make(compiler, linker, true))
}
