//! Why a pack was refused.

use kinesic::LoadError;

/// What a load says.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KinesicStatus {
    /// The model may be stepped for ever.
    Ok = 0,
    /// A pointer is null.
    Null = 1,
    /// Fewer bytes than a header.
    TooShort = 2,
    /// The bytes do not start at an address divisible by 16.
    Misaligned = 3,
    /// No pack at all.
    NotAPack = 4,
    /// A version or a kind of pack that this library does not know.
    Version = 5,
    /// The lengths do not add up, or the checksum does not match: truncated or damaged.
    Damaged = 6,
    /// The contents contradict themselves: a tensor is missing, has another shape, or holds what it must not.
    Invalid = 7,
    /// The pack holds no model of this engine.
    NoModel = 8,
    /// The model is larger than KINESIC_JOINTS, KINESIC_STATES, ... allow.
    Capacity = 9,
}

impl From<LoadError> for KinesicStatus {
    fn from(error: LoadError) -> Self {
        match error {
            LoadError::TooShort { .. } => Self::TooShort,
            LoadError::Misaligned { .. } => Self::Misaligned,
            LoadError::NotAPack { .. } => Self::NotAPack,
            LoadError::Version { .. } | LoadError::Kind { .. } => Self::Version,
            LoadError::Length { .. } | LoadError::Checksum { .. } => Self::Damaged,
            LoadError::NoModel { .. } => Self::NoModel,
            LoadError::Capacity { .. } => Self::Capacity,
            _ => Self::Invalid,
        }
    }
}
