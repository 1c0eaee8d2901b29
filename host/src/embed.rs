//! A pack as Rust source: bytes that are aligned, and the capacities that they need as constants. A robot's move as an array.

use std::fmt::Write;

use kinesic::model::{LoadError, ModelMeta};

use crate::clip::Clip;
use crate::engines::{Source, known};
use crate::pack::PackFile;
use crate::robot::Machine;

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

/// A module with the constant `FRAME_RATE` and the static `FRAMES`: a machine's motion as `kinesic::play::Move` takes it, one row per frame, rad and
/// m in the order of the coordinates.
pub fn rust_move(clip: &Clip, machine: &Machine, origin: &str) -> String {
    let names: Vec<&str> = machine.servos.iter().map(|servo| servo.name.as_str()).collect();
    let mut out = String::new();
    // Writing to a String cannot fail.
    let _ = writeln!(
        out,
        "//! A move of {:?}, made by `kinesic export --rust` from {origin:?}. Made again, not edited.",
        machine.name
    );
    let _ = writeln!(out, "//!\n//! Coordinates, rad and m: {names:?}.");
    let _ = writeln!(
        out,
        "\n/// Frames per second.\n#[allow(dead_code)]\npub const FRAME_RATE: f32 = {:?};",
        clip.fps() as f32
    );
    let _ = writeln!(
        out,
        "\n/// One row per frame, for `kinesic::play::Move::new`.\n#[rustfmt::skip]\npub static FRAMES: [[f32; {}]; {}] = [",
        names.len(),
        clip.frames()
    );
    for row in (0..clip.frames()).filter_map(|frame| clip.coordinates(frame)) {
        let row: Vec<f32> = row.iter().take(names.len()).map(|x| *x as f32).collect();
        let _ = writeln!(out, "    {row:?},");
    }
    out.push_str("];\n");
    out
}
