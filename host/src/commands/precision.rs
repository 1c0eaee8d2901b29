//! Number types of packs, as options name them.

use kinesic_host::pack::{PackFile, Provenance};
use kinesic_host::quantise::{QuantiseError, to_int8, to_int16};
use miette::miette;

/// Number type of a model's coefficients.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Precision {
    /// Single precision
    F32,
    /// int16 coefficients and int32 states: translators
    I16,
    /// int8 weights with a scale a row: body mechanics
    I8,
}

impl Precision {
    /// The type's name in words.
    pub fn name(self) -> &'static str {
        match self {
            Self::F32 => "f32",
            Self::I16 => "int16",
            Self::I8 => "int8",
        }
    }

    /// The pack in this number type, from one in f32.
    pub fn of(self, bytes: Vec<u8>, provenance: &Provenance) -> Result<Vec<u8>, QuantiseError> {
        match self {
            Self::F32 => Ok(bytes),
            Self::I16 => to_int16(&PackFile::from_bytes(&bytes), provenance),
            Self::I8 => to_int8(&PackFile::from_bytes(&bytes), provenance),
        }
    }

    /// Before a training: refuses what `engine` has no form in. `smaller` is the one that it has beside f32, if any.
    pub fn check(self, engine: &str, smaller: Option<Self>) -> miette::Result<()> {
        if self == Self::F32 || Some(self) == smaller {
            return Ok(());
        }
        let flag = |precision: Self| match precision {
            Self::F32 => "f32",
            Self::I16 => "i16",
            Self::I8 => "i8",
        };
        let known = smaller.map_or("f32".to_owned(), |smaller| format!("f32 or {}", flag(smaller)));
        Err(miette!(
            help = "docs/precision.md says what each number type costs and loses",
            "--precision {}: {engine} have no such form, expected {known}",
            flag(self)
        ))
    }
}
