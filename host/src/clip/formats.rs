//! The readers: one table of what can be read.

use std::path::Path;

use super::error::ReadError;
use super::read::ReadOptions;
use super::{Clip, bvh, fbx, gltf, kinect};

/// One kind of file.
pub struct Reader {
    /// Name for messages.
    pub name: &'static str,
    /// File name extensions, lower case.
    pub extensions: &'static [&'static str],
    /// Whether the first bytes of a file are of this kind, whatever its name.
    sniff: fn(&[u8]) -> bool,
    /// Reads the whole file; the path is for messages, and for files beside it.
    pub(super) parse: fn(&[u8], &Path, &ReadOptions) -> Result<Clip, ReadError>,
}

/// All of them.
pub static READERS: [Reader; 4] = [
    Reader {
        name: "BVH",
        extensions: &["bvh"],
        sniff: is_bvh,
        parse: |bytes, path, options| bvh::parse(bytes, options).map_err(|error| error.at(path)),
    },
    Reader { name: "table of joint positions (Kinect)", extensions: &["csv"], sniff: is_kinect, parse: kinect::read },
    Reader { name: "glTF", extensions: &["glb", "gltf"], sniff: is_gltf, parse: gltf::read },
    Reader { name: "FBX", extensions: &["fbx"], sniff: is_fbx, parse: fbx::read },
];

/// The reader that knows the first bytes of a file.
pub(super) fn sniffed(head: &[u8]) -> Option<&'static Reader> {
    READERS.iter().find(|reader| (reader.sniff)(head))
}

/// The reader of a file: by content first, because a wrong extension is common, then by extension.
pub(super) fn reader_of(path: &Path, head: &[u8]) -> Option<&'static Reader> {
    sniffed(head).or_else(|| {
        let name = path.file_name()?.to_str()?.to_ascii_lowercase();
        let extension = name.strip_suffix(".gz").unwrap_or(&name).rsplit('.').next()?.to_owned();
        READERS.iter().find(|reader| reader.extensions.contains(&extension.as_str()))
    })
}

fn lower(head: &[u8]) -> String {
    // UTF-16 of these words is their letters with zeros between.
    let letters: Vec<u8> = head.iter().copied().filter(|b| *b != 0 && b.is_ascii()).collect();
    String::from_utf8_lossy(&letters).trim_start().to_ascii_lowercase()
}

pub(super) fn is_bvh(head: &[u8]) -> bool {
    lower(head).starts_with("hierarchy")
}

fn is_kinect(head: &[u8]) -> bool {
    let head = lower(head);
    kinect::is_header(head.lines().next().unwrap_or(""))
}

fn is_gltf(head: &[u8]) -> bool {
    head.starts_with(b"glTF") || (lower(head).starts_with('{') && lower(head).contains("\"asset\""))
}

fn is_fbx(head: &[u8]) -> bool {
    head.starts_with(b"Kaydara FBX Binary") || head.starts_with(b"; FBX")
}
