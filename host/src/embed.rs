//! A pack as Rust source: bytes that are aligned, and the capacities that they need as constants.

use std::fmt::Write;

use kinesic::model::{LoadError, ModelMeta};

use crate::engines::{Source, known};
use crate::pack::PackFile;

/// Bytes on a line of the source.
const LINE: usize = 30;

/// A module with the constants `JOINTS`, `FRAME_RATE`, those of each engine that the pack holds, and `PACK`: the bytes, aligned as
/// the device wants them. It needs nothing, not even `std`. Of several models of one engine, the device loads the first.
pub fn rust_module(file: &PackFile, origin: &str) -> Result<String, LoadError> {
    let pack = file.pack()?;
    let metadata = pack.metadata();
    let bytes = file.bytes();
    let mut out = String::new();
    // Writing to a String cannot fail.
    let _ = writeln!(
        out,
        "//! Pack {:?}, made by `kinesic export --rust` from {origin:?}. Made again, not edited.",
        metadata.name
    );
    let mut models: Vec<ModelMeta> = Vec::new();
    for meta in metadata.models.iter() {
        if models.iter().all(|known| std::mem::discriminant(known) != std::mem::discriminant(&meta)) {
            models.push(meta);
        }
    }
    let sources = models.iter().map(|meta| known(meta).source(&pack)).collect::<Result<Vec<_>, _>>()?;
    for Source { model, state, .. } in &sources {
        out.push_str("//!\n//! ```text\n");
        let _ = writeln!(
            out,
            "//! let pack = kinesic::Pack::load(PACK)?;\n//! let model = kinesic::{model}::load(&pack)?;"
        );
        let _ = writeln!(out, "//! let mut state = kinesic::{state}::new();\n//! ```");
    }
    let mut constant = |doc: &str, name: &str, value: &dyn std::fmt::Display, kind: &str| {
        let _ = write!(out, "\n/// {doc}.\n#[allow(dead_code)]\npub const {name}: {kind} = {value};\n");
    };
    constant("Joints of a pose", "JOINTS", &metadata.joints.iter().count(), "usize");
    constant("Rows of coordinates of a frame", "ROWS", &kinesic::Rig::load(&pack)?.rows(), "usize");
    constant(
        "Frames per second at which the pack is stepped",
        "FRAME_RATE",
        &format!("{:?}", metadata.frame_rate),
        "f32",
    );
    for (doc, name, value) in sources.iter().flat_map(|source| &source.constants) {
        constant(doc, name, value, "usize");
    }
    let _ = write!(
        out,
        "\n/// Bytes at an address that packs want.\n#[repr(C, align({}))]\nstruct Aligned([u8; {}]);\n",
        kinesic::model::ALIGNMENT,
        bytes.len()
    );
    let _ = write!(
        out,
        "\n/// The pack, {} bytes, used where it lies.\npub static PACK: &[u8] = &ALIGNED.0;\n",
        bytes.len()
    );
    out.push_str("\n#[rustfmt::skip]\nstatic ALIGNED: Aligned = Aligned(*b\"\\\n");
    for line in bytes.chunks(LINE) {
        for byte in line {
            let _ = write!(out, "\\x{byte:02x}");
        }
        out.push_str("\\\n");
    }
    out.push_str("\");\n");
    Ok(out)
}
