//! Sizes and symbols of an image, and what must not be linked into it.

use std::path::{Path, PathBuf};

use object::{Object, ObjectSection, ObjectSymbol, SectionFlags, elf};

/// What the host tool needs to know of an image.
#[derive(Clone, Debug)]
pub struct Image {
    /// The file.
    pub path: PathBuf,
    /// Code, constants and initial values, B, the pack left out.
    pub flash: u64,
    /// The pack in flash, B.
    pub pack: u64,
    /// Static RAM: initialised, zeroed and uninitialised data, B.
    pub ram: u64,
    symbols: Vec<Symbol>,
}

#[derive(Clone, Debug)]
struct Symbol {
    name: String,
    address: u64,
    size: u64,
    in_flash: bool,
}

/// An image cannot be read or lacks something.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum ElfError {
    /// No such file.
    #[error("cannot read the image {}: {source}", path.display())]
    #[diagnostic(help(
        "the build said it succeeded: delete the folder `firmware` in cargo's target folder and run again"
    ))]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// Not an ELF file.
    #[error("{} is not an ELF image: {source}", path.display())]
    Parse {
        /// The file.
        path: PathBuf,
        /// Why.
        source: object::Error,
    },
    /// A symbol is missing.
    #[error("the image {} has no symbol {name}", path.display())]
    #[diagnostic(help("images are made with the macro `kinesic_image::image!`, and must not be stripped"))]
    NoSymbol {
        /// The file.
        path: PathBuf,
        /// Which.
        name: String,
    },
}

/// Parts of (mangled) names that only panic or formatting machinery has.
const PANIC: [&str; 5] = ["kinesic_panicked", "4core9panicking", "4core3fmt", "rust_begin_unwind", "panic_impl"];
/// The same for a heap.
const HEAP: [&str; 6] = ["__rust_alloc", "__rust_realloc", "__rg_alloc", "__rdl_alloc", "5alloc5alloc", "malloc"];

impl Image {
    /// Reads an image.
    pub fn read(path: &Path) -> Result<Self, ElfError> {
        let bytes = std::fs::read(path).map_err(|source| ElfError::Read { path: path.to_owned(), source })?;
        let parse = |source| ElfError::Parse { path: path.to_owned(), source };
        let file = object::File::parse(bytes.as_slice()).map_err(parse)?;
        let (mut stored, mut ram) = (0, 0);
        for section in file.sections() {
            let SectionFlags::Elf { sh_flags } = section.flags() else { continue };
            if sh_flags & u64::from(elf::SHF_ALLOC) == 0 || is_bookkeeping(section.name().unwrap_or("")) {
                continue;
            }
            let in_file = section.kind() != object::SectionKind::UninitializedData;
            stored += if in_file { section.size() } else { 0 };
            ram += if sh_flags & u64::from(elf::SHF_WRITE) != 0 { section.size() } else { 0 };
        }
        let symbols = file
            .symbols()
            .filter_map(|symbol| {
                let name = symbol.name().ok()?.to_owned();
                // Thumb function symbols carry the instruction set in bit 0.
                let text = symbol.kind() == object::SymbolKind::Text;
                let address = if text { symbol.address() & !1 } else { symbol.address() };
                let section = symbol.section_index().and_then(|index| file.section_by_index(index).ok());
                let in_flash = section.is_some_and(|section| {
                    matches!(section.kind(), object::SectionKind::Text | object::SectionKind::ReadOnlyData)
                });
                Some(Symbol { name, address, size: symbol.size(), in_flash })
            })
            .collect();
        let mut image = Self { path: path.to_owned(), flash: 0, pack: 0, ram, symbols };
        image.pack = image.symbol("KINESIC_PACK").map_or(0, |symbol| symbol.size);
        image.flash = stored - image.pack;
        Ok(image)
    }

    fn symbol(&self, name: &str) -> Result<&Symbol, ElfError> {
        self.symbols
            .iter()
            .find(|symbol| symbol.name == name)
            .ok_or_else(|| ElfError::NoSymbol { path: self.path.clone(), name: name.to_owned() })
    }

    /// Address of a symbol.
    pub fn address(&self, name: &str) -> Result<u64, ElfError> {
        Ok(self.symbol(name)?.address)
    }

    /// Addresses of a function.
    pub fn range(&self, name: &str) -> Result<std::ops::Range<u64>, ElfError> {
        let symbol = self.symbol(name)?;
        Ok(symbol.address..symbol.address + symbol.size)
    }

    /// The function that an address belongs to, readable.
    pub fn function(&self, address: u64) -> String {
        let inside = |symbol: &&Symbol| (symbol.address..symbol.address + symbol.size).contains(&address);
        self.symbols.iter().find(inside).map_or_else(|| format!("{address:#x}"), |symbol| readable(&symbol.name))
    }

    /// Functions and constants in flash by size, largest first, the pack left out.
    pub fn largest(&self) -> Vec<(String, u64)> {
        let in_flash = |symbol: &&Symbol| symbol.in_flash && symbol.name != "KINESIC_PACK";
        let mut all: Vec<(String, u64)> =
            self.symbols.iter().filter(in_flash).map(|symbol| (readable(&symbol.name), symbol.size)).collect();
        all.sort_by_key(|one| std::cmp::Reverse(one.1));
        all
    }

    /// Symbols of panic, formatting or heap machinery: empty in the image of a workload.
    pub fn forbidden(&self) -> Vec<String> {
        let banned = |name: &str| PANIC.iter().chain(&HEAP).any(|part| name.contains(part));
        self.symbols.iter().filter(|symbol| banned(&symbol.name)).map(|symbol| readable(&symbol.name)).collect()
    }
}

fn readable(name: &str) -> String {
    format!("{:#}", rustc_demangle::demangle(name))
}

/// Sections of the runtime crates that reserve the rest of RAM for heap and stack.
fn is_bookkeeping(name: &str) -> bool {
    matches!(name, ".stack" | ".heap")
}
