//! The pack: a model file that is checked once and then used in place.
//!
//! [`Pack::load`] checks length, alignment, magic, version, kind, checksum, metadata, the ranges of its numbers and the bounds of
//! every tensor, in this order, and copies nothing. Any byte string that loads can be used for ever without a panic; any truncated file and
//! any flipped bit is refused with the reason. The format is written down in `docs/pack.md`.

mod error;
mod meta;
mod numbers;
mod ranges;
mod tensor;

pub use error::LoadError;
pub use meta::*;
pub use numbers::{AnyNumbers, Floats, Integers, Numbers, Ungated};
pub use tensor::Element;
use tensor::payload_in_bounds;

/// First four bytes of every pack.
pub const MAGIC: [u8; 4] = *b"KNSC";
/// Format version that this crate reads and the host writes.
pub const VERSION: u16 = 2;
/// Bytes before the metadata.
pub const HEADER_LEN: usize = 20;
/// Alignment of the pack and of every tensor in it, bytes.
pub const ALIGNMENT: usize = 16;

/// CRC-32 (ISO-HDLC, as in zip) of a pack's bytes, leaving out the four that hold it.
///
/// It covers the header too, so that a flipped bit in the kind or in a length is refused like any other.
pub fn checksum(header: &[u8; 16], body: &[u8]) -> u32 {
    const CRC: crc::Crc<u32> = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC);
    let mut digest = CRC.digest();
    digest.update(header);
    digest.update(body);
    digest.finalize()
}

/// A checked view of a model file. It borrows the bytes: keep them in flash.
#[derive(Clone, Copy, Debug)]
pub struct Pack<'a> {
    kind: Kind,
    metadata: Metadata<'a>,
    payload: &'a [u8],
}

impl<'a> Pack<'a> {
    /// Checks `bytes` and returns a view of them. Cost: one pass over the file, no copy.
    ///
    /// `bytes` must start at an address divisible by [`ALIGNMENT`]; [`include_pack!`](crate::include_pack) sees to that.
    pub fn load(bytes: &'a [u8]) -> Result<Self, LoadError> {
        let (header, body) = bytes
            .split_first_chunk::<HEADER_LEN>()
            .ok_or(LoadError::TooShort { found: bytes.len(), expected: HEADER_LEN })?;
        let misaligned = bytes.as_ptr().addr() % ALIGNMENT;
        if misaligned != 0 {
            return Err(LoadError::Misaligned { off_by: misaligned });
        }
        let [m0, m1, m2, m3, v0, v1, k0, k1, a0, a1, a2, a3, b0, b1, b2, b3, c0, c1, c2, c3] = *header;
        let magic = [m0, m1, m2, m3];
        if magic != MAGIC {
            return Err(LoadError::NotAPack { found: magic });
        }
        let version = u16::from_le_bytes([v0, v1]);
        if version != VERSION {
            return Err(LoadError::Version { found: version, expected: VERSION });
        }
        let kind = u16::from_le_bytes([k0, k1]);
        let kind = Kind::from_code(kind).ok_or(LoadError::Kind { found: kind })?;
        let metadata_len = u32::from_le_bytes([a0, a1, a2, a3]) as usize;
        let payload_len = u32::from_le_bytes([b0, b1, b2, b3]) as usize;
        let (metadata, payload) = split(body, metadata_len, payload_len).ok_or(LoadError::Length {
            found: bytes.len(),
            metadata: metadata_len,
            payload: payload_len,
        })?;
        let stored = u32::from_le_bytes([c0, c1, c2, c3]);
        let fields = [m0, m1, m2, m3, v0, v1, k0, k1, a0, a1, a2, a3, b0, b1, b2, b3];
        let computed = checksum(&fields, body);
        if stored != computed {
            return Err(LoadError::Checksum { found: computed, expected: stored });
        }
        let (metadata, rest) = postcard::take_from_bytes::<Metadata>(metadata).map_err(|_| LoadError::Metadata)?;
        let lists_decode = metadata.joints.decodes() && metadata.models.decodes() && metadata.tensors.decodes();
        if !(rest.is_empty() && lists_decode) {
            return Err(LoadError::Metadata);
        }
        ranges::check(&metadata)?;
        payload_in_bounds(&metadata, payload)?;
        let pack = Self { kind, metadata, payload };
        ranges::check_tensors(&pack)?;
        Ok(pack)
    }

    /// What the file says it holds.
    pub fn kind(&self) -> Kind {
        self.kind
    }

    /// Names, shapes and origin of everything in the file.
    pub fn metadata(&self) -> &Metadata<'a> {
        &self.metadata
    }

    /// Bytes of all tensors together.
    pub fn payload_len(&self) -> usize {
        self.payload.len()
    }
}

/// Metadata and payload, if the lengths account for every byte after the header.
fn split(body: &[u8], metadata_len: usize, payload_len: usize) -> Option<(&[u8], &[u8])> {
    let payload_start = HEADER_LEN.checked_add(metadata_len)?.checked_next_multiple_of(ALIGNMENT)?;
    let (before, payload) = body.split_at_checked(payload_start.checked_sub(HEADER_LEN)?)?;
    let metadata = before.get(..metadata_len)?;
    (payload.len() == payload_len).then_some((metadata, payload))
}

/// Bytes at an address divisible by [`ALIGNMENT`]. Used by [`include_pack!`](crate::include_pack).
#[derive(Clone, Copy, Debug)]
#[repr(C, align(16))]
pub struct Aligned<T: ?Sized>(pub T);

/// A model file as an aligned `&'static [u8]` in flash: `let bytes = kinesic::include_pack!("walk.kin");`
#[macro_export]
macro_rules! include_pack {
    ($path:expr) => {{
        static PACK: &$crate::model::Aligned<[u8]> = &$crate::model::Aligned(*include_bytes!($path));
        &PACK.0
    }};
}
