//! Why a pack was refused.

use core::fmt;

use super::TensorType;

/// Why a pack, or a model in it, was refused. Every variant says what was found and what was expected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum LoadError {
    /// Fewer bytes than a header.
    TooShort {
        /// Bytes given.
        found: usize,
        /// Bytes of a header.
        expected: usize,
    },
    /// The bytes do not start at an address divisible by 16.
    Misaligned {
        /// Address modulo 16.
        off_by: usize,
    },
    /// The first four bytes are not `KNSC`.
    NotAPack {
        /// The first four bytes.
        found: [u8; 4],
    },
    /// A version of the format that this crate does not read.
    Version {
        /// Version in the file.
        found: u16,
        /// Version that is read.
        expected: u16,
    },
    /// A kind of pack that this crate does not know.
    Kind {
        /// Kind in the file.
        found: u16,
    },
    /// The lengths in the header do not add up to the file: truncated, or bytes appended.
    Length {
        /// Bytes in the file.
        found: usize,
        /// Bytes of metadata that the header announces.
        metadata: usize,
        /// Bytes of tensors that the header announces.
        payload: usize,
    },
    /// The checksum does not match: the file is damaged.
    Checksum {
        /// CRC-32 of the bytes.
        found: u32,
        /// CRC-32 in the header.
        expected: u32,
    },
    /// The metadata cannot be decoded.
    Metadata,
    /// A number in the metadata is out of its plausible range.
    Range {
        /// Name of the number, and what is expected.
        field: &'static str,
    },
    /// A tensor is misaligned or reaches past the end of the file.
    Bounds {
        /// Index of the tensor in the metadata.
        tensor: usize,
    },
    /// The limits of a pack hold jerk limits, which a [`Limiter`](crate::Limiter) does not keep: a [`SmoothLimiter`](crate::SmoothLimiter) does.
    Jerk,
    /// The translator knows how familiar a frame is, and is loaded into a type for those that do not: see [`Ungated`](super::Ungated).
    Gated,
    /// The file has no such model.
    NoModel {
        /// Name of the engine that was asked for.
        expected: &'static str,
    },
    /// A tensor that the model needs is missing.
    NoTensor {
        /// Name of the tensor.
        tensor: &'static str,
    },
    /// A tensor has another shape or number type than the model needs.
    Shape {
        /// Name of the tensor.
        tensor: &'static str,
        /// Elements in the file.
        found: usize,
        /// Elements that the model needs.
        expected: usize,
    },
    /// A tensor has a number type that the type it is loaded into does not read: see [`Numbers`](super::Numbers).
    NumberType {
        /// Name of the tensor.
        tensor: &'static str,
        /// Number type in the file.
        found: TensorType,
    },
    /// A tensor holds a number that is not finite, or an index that is out of range.
    Value {
        /// Name of the tensor.
        tensor: &'static str,
        /// Index of the element.
        index: usize,
    },
    /// A pole of the model lies on or outside the unit circle.
    Unstable {
        /// Index of the 2 x 2 block.
        block: usize,
    },
    /// The model is larger than the type it is loaded into.
    Capacity {
        /// Name of the const-generic parameter.
        parameter: &'static str,
        /// What the file needs.
        found: usize,
        /// What the type holds.
        capacity: usize,
    },
}

impl fmt::Display for LoadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::TooShort { found, expected } => {
                write!(f, "{found} bytes are too few for a pack: its header has {expected}")
            }
            Self::Misaligned { off_by } => {
                write!(f, "the pack starts {off_by} bytes past a 16-byte boundary: embed it with include_pack!")
            }
            Self::NotAPack { found } => write!(f, "not a pack: it starts with {found:02x?}, expected \"KNSC\""),
            Self::Version { found, expected } => {
                write!(f, "pack format {found}, this build reads {expected}: train again, or use a matching release")
            }
            Self::Kind { found } => write!(f, "unknown kind of pack: {found}"),
            Self::Length { found, metadata, payload } => write!(
                f,
                "the file has {found} bytes, its header announces {metadata} of metadata and {payload} of tensors: truncated?"
            ),
            Self::Checksum { found, expected } => {
                write!(f, "checksum {found:08x}, expected {expected:08x}: the file is damaged")
            }
            Self::Metadata => f.write_str("the metadata cannot be decoded"),
            Self::Range { field } => write!(f, "the metadata is out of range: {field}"),
            Self::Bounds { tensor } => write!(f, "tensor {tensor} is misaligned or reaches past the end of the file"),
            Self::Jerk => f.write_str("the pack has jerk limits: load it as a SmoothLimiter"),
            Self::Gated => f.write_str(
                "the translator has a gate: load it as a type that is not Ungated, or train it with --no-gate",
            ),
            Self::NoModel { expected } => write!(f, "the pack holds no {expected}"),
            Self::NoTensor { tensor } => write!(f, "tensor {tensor} is missing"),
            Self::Shape { tensor, found, expected } => {
                write!(f, "tensor {tensor} has {found} elements, expected {expected}")
            }
            Self::NumberType { tensor, found } => {
                write!(f, "tensor {tensor} is {found:?}, which the type it is loaded into does not read")
            }
            Self::Value { tensor, index } => write!(f, "tensor {tensor}: element {index} is out of range"),
            Self::Unstable { block } => write!(f, "block {block} has a pole on or outside the unit circle"),
            Self::Capacity { parameter, found, capacity } => {
                write!(f, "the model needs {parameter} = {found}, the type has {capacity}")
            }
        }
    }
}

impl core::error::Error for LoadError {}
