//! The translator: a checked, immutable view of a pack.

use super::fixed::Fixed;
use super::float::Float;
use super::gate::{self, Gate};
use core::marker::PhantomData;

use crate::model::{AnyNumbers, LoadError, ModelMeta, Numbers, Pack, TensorType, TranslatorMeta};
use crate::rig::Rig;

/// A style translator for up to `ROWS` rows of coordinates and `STATES` filter states, borrowed from a pack.
///
/// Coefficients are f32, or int16 with int32 states (`kinesic quantize --precision i16`): the pack decides. `STATES` counts two for every 2 x 2 block, in the whole-body form one for every principal coordinate, and with a gate two and three for each of its features: `kinesic inspect` prints the sum.
#[derive(Clone, Copy, Debug)]
pub struct Translator<'a, const ROWS: usize, const STATES: usize, N = AnyNumbers> {
    pub(super) meta: TranslatorMeta<'a>,
    pub(super) rows: usize,
    /// Input: mean, rad or m, and 1 / deviation.
    pub(super) mean: &'a [[f32; 3]],
    pub(super) inverse_deviation: &'a [[f32; 3]],
    pub(super) linear: Linear<'a>,
    pub(super) gate: Option<Gate<'a>>,
    numbers: PhantomData<N>,
}

/// Everything between the normalised input and the output, in the pack's number type.
#[derive(Clone, Copy, Debug)]
pub(super) enum Linear<'a> {
    Float(Float<'a>),
    Fixed(Fixed<'a>),
}

impl<'a, const ROWS: usize, const STATES: usize> Translator<'a, ROWS, STATES> {
    /// The translator of a pack in any number type, after every check that makes [`step`](Self::step) infallible.
    pub fn load(pack: &Pack<'a>) -> Result<Self, LoadError> {
        Self::load_numbers(pack)
    }
}

impl<'a, const ROWS: usize, const STATES: usize, N: Numbers> Translator<'a, ROWS, STATES, N> {
    /// [`load`](Translator::load) for the number types `N`: `Translator::<J, S, Integers>::load_numbers(&pack)` links no f32 bank.
    pub fn load_numbers(pack: &Pack<'a>) -> Result<Self, LoadError> {
        let meta = pack
            .metadata()
            .models
            .iter()
            .find_map(ModelMeta::translator)
            .ok_or(LoadError::NoModel { expected: "translator" })?;
        let rows = Rig::load(pack)?.rows();
        fits("ROWS", rows, ROWS)?;
        let gate = match pack.rows(gate::PRESENT) {
            Ok(_) if !N::GATED => return Err(LoadError::Gated),
            Ok(features) if N::GATED => Some(Gate::load(pack, features, rows)?),
            _ => None,
        };
        fits("STATES", filters(&meta).saturating_add(gate.as_ref().map_or(0, Gate::words)), STATES)?;
        let linear = match pack.number("translate/direct")? {
            TensorType::F32 if N::FLOAT => Linear::Float(Float::load::<N>(pack, &meta, gate.as_ref(), rows)?),
            TensorType::I16 if N::INTEGER => Linear::Fixed(Fixed::load(pack, &meta, rows)?),
            found => return Err(LoadError::NumberType { tensor: "translate/direct", found }),
        };
        Ok(Self {
            meta,
            rows,
            mean: pack.slice("translate/mean", rows)?,
            inverse_deviation: pack.slice("translate/inverse_deviation", rows)?,
            linear,
            gate,
            numbers: PhantomData,
        })
    }

    /// Name of the style, form, shape and plausible strengths.
    pub fn meta(&self) -> &TranslatorMeta<'a> {
        &self.meta
    }

    /// Rows of coordinates.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Words of a state that this model uses: the least `STATES`.
    pub fn states(&self) -> usize {
        filters(&self.meta) + self.gate.as_ref().map_or(0, Gate::words)
    }

    /// Whether it knows how familiar a frame is: see [`TranslatorState::familiar`](super::TranslatorState::familiar).
    pub fn is_gated(&self) -> bool {
        self.gate.is_some()
    }

    /// Output stages for several actions; 0 in a model of one.
    pub fn experts(&self) -> usize {
        match &self.linear {
            Linear::Float(linear) if linear.is_expert() => self.gate.as_ref().map_or(0, Gate::count),
            _ => 0,
        }
    }

    /// Multiply-adds of one frame.
    pub fn multiply_adds(&self) -> usize {
        let recursion = match &self.linear {
            Linear::Float(linear) => linear.multiply_adds(self.rows),
            Linear::Fixed(linear) => linear.multiply_adds(self.rows),
        };
        9 * self.rows + recursion + self.gate.as_ref().map_or(0, Gate::multiply_adds)
    }

    /// Number type of the coefficients: f32, or i16 with int32 states and sums.
    pub fn number(&self) -> TensorType {
        match self.linear {
            Linear::Float(_) => TensorType::F32,
            Linear::Fixed(_) => TensorType::I16,
        }
    }
}

/// Words of the filters: states, then principal coordinates.
pub(super) fn filters(meta: &TranslatorMeta) -> usize {
    (2 * meta.blocks as usize).saturating_add(meta.drives as usize)
}

fn fits(parameter: &'static str, found: usize, capacity: usize) -> Result<(), LoadError> {
    if found > capacity { Err(LoadError::Capacity { parameter, found, capacity }) } else { Ok(()) }
}
