//! The three layers of the network, in f32 or with int8 weights: the pack's tensors decide.

use nalgebra::{Quaternion, UnitQuaternion};

use super::features::{FEATURES, fits};
use crate::kernel::{Activations, LARGEST_ACTIVATION, Quantised, ROWS, TILE, Tiled, tanh};
use crate::model::{LoadError, Numbers, Pack, TensorType};
use crate::pose::unit;

/// Features this many deviations away from the mean are cut: further away the network knows nothing.
pub const FARTHEST: f32 = 6.0;

/// Fraction bits of the integer output: a quaternion's component, before it is brought to length 1.
pub const OUTPUT_BITS: u32 = 14;

/// Activations of the first integer layer a deviation of a feature: [`FARTHEST`] deviations are the largest activation.
pub const INPUT_SCALE: f32 = LARGEST_ACTIVATION as f32 / FARTHEST;

/// Features rounded up to whole groups of the integer kernel.
const PADDED_FEATURES: usize = FEATURES.next_multiple_of(TILE);

/// Number type of a network's weights.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Precision {
    /// Single precision.
    F32,
    /// int8 weights with a scale a row, int16 activations, int32 sums.
    I8,
}

#[derive(Clone, Copy, Debug)]
pub enum Layers<'a> {
    Float([Layer<'a>; 3]),
    Integer([Quantised<'a>; 3]),
}

/// `W x + b`.
#[derive(Clone, Copy, Debug)]
pub struct Layer<'a> {
    weights: Tiled<'a>,
    bias: &'a [f32],
}

impl<'a> Layers<'a> {
    /// Layers of `hidden`, `code` and `outputs` rows; `units` is the capacity for the units of the first two.
    pub fn load<N: Numbers>(
        pack: &Pack<'a>,
        [hidden, code, outputs]: [usize; 3],
        units: usize,
    ) -> Result<Self, LoadError> {
        let float = |names, rows, columns| Layer::load(pack, names, rows, columns);
        let integer = |names, rows, columns| Quantised::load(pack, names, rows, columns);
        let found = pack.number("mechanics/hidden")?;
        if !matches!((found, N::FLOAT, N::INTEGER), (TensorType::F32, true, _) | (TensorType::I8, _, true)) {
            return Err(LoadError::NumberType { tensor: "mechanics/hidden", found });
        }
        if N::INTEGER && (found == TensorType::I8 || !N::FLOAT) {
            // The integer kernel reads whole groups of activations.
            let groups = hidden.div_ceil(TILE).saturating_add(code.div_ceil(TILE));
            fits("UNITS", groups.saturating_mul(TILE), units)?;
            let names = [
                ["mechanics/hidden", "mechanics/hidden_scale", "mechanics/hidden_bias"],
                ["mechanics/code", "mechanics/code_scale", "mechanics/code_bias"],
                ["mechanics/decoder", "mechanics/decoder_scale", "mechanics/decoder_bias"],
            ];
            let [first, second, third] = names;
            return Ok(Self::Integer([
                integer(first, hidden, FEATURES)?,
                integer(second, code, hidden)?,
                integer(third, outputs, code)?,
            ]));
        }
        fits("UNITS", hidden.saturating_add(code), units)?;
        Ok(Self::Float([
            float(["mechanics/hidden", "mechanics/hidden_bias"], hidden, FEATURES)?,
            float(["mechanics/code", "mechanics/code_bias"], code, hidden)?,
            float(["mechanics/decoder", "mechanics/decoder_bias"], outputs, code)?,
        ]))
    }

    pub fn precision(&self) -> Precision {
        match self {
            Self::Float(_) => Precision::F32,
            Self::Integer(_) => Precision::I8,
        }
    }

    pub fn multiply_adds(&self) -> usize {
        match self {
            Self::Float(layers) => {
                layers.iter().map(|l| l.bias.len().next_multiple_of(ROWS) * l.weights.columns()).sum()
            }
            Self::Integer(layers) => layers.iter().map(Quantised::multiply_adds).sum(),
        }
    }

    /// From features, normalised and cut at [`FARTHEST`], to rotations, one for every four outputs.
    pub fn apply<'r, const UNITS: usize, N: Numbers>(
        &self,
        input: &[f32; FEATURES],
        rotations: impl Iterator<Item = &'r mut UnitQuaternion<f32>>,
    ) {
        match self {
            // Guards are constant: code of number types that N leaves out is not linked.
            Self::Float(layers) if N::FLOAT => float::<UNITS>(layers, input, rotations),
            Self::Integer(layers) if N::INTEGER => integer::<UNITS>(layers, input, rotations),
            _ => {}
        }
    }
}

// Two functions, so that the stack holds one precision's activations.
#[inline(never)]
fn float<'r, const UNITS: usize>(
    [hidden, code, decoder]: &[Layer<'_>; 3],
    input: &[f32; FEATURES],
    rotations: impl Iterator<Item = &'r mut UnitQuaternion<f32>>,
) {
    let mut units = [0.0; UNITS];
    let Some((first, rest)) = units.split_at_mut_checked(hidden.bias.len()) else { return };
    let Some(second) = rest.get_mut(..code.bias.len()) else { return };
    hidden.apply_tanh(input, first);
    code.apply_tanh(first, second);
    let (biases, _) = decoder.bias.as_chunks::<4>();
    let mut joints = rotations.zip(biases);
    for tile in decoder.weights.sums(second) {
        for ([x, y, z, w], (rotation, [bias_x, bias_y, bias_z, bias_w])) in
            tile.as_chunks::<4>().0.iter().zip(&mut joints)
        {
            *rotation = unit(Quaternion::new(bias_w + w, bias_x + x, bias_y + y, bias_z + z));
        }
    }
}

#[inline(never)]
fn integer<'r, const UNITS: usize>(
    [hidden, code, decoder]: &[Quantised<'_>; 3],
    input: &[f32; FEATURES],
    rotations: impl Iterator<Item = &'r mut UnitQuaternion<f32>>,
) {
    let mut features = Activations::<PADDED_FEATURES>::zero();
    for (out, x) in features.values().iter_mut().zip(input) {
        // Half is added away from zero, and the cast cuts: to nearest, with nothing but exact operations.
        *out = (x * INPUT_SCALE + if *x < 0.0 { -0.5 } else { 0.5 }) as i16;
    }
    let mut units = Activations::<UNITS>::zero();
    let Some([first, second]) = units.split(hidden.rows(), code.rows()) else { return };
    hidden.apply_tanh(features.values(), first);
    code.apply_tanh(first, second);
    for (rotation, outputs) in rotations.zip(decoder.tiles(second)) {
        let [x, y, z, w] = outputs.map(|z| z as f32 * (1.0 / (1u32 << OUTPUT_BITS) as f32));
        *rotation = unit(Quaternion::new(w, x, y, z));
    }
}

impl<'a> Layer<'a> {
    fn load(
        pack: &Pack<'a>,
        [weights, bias]: [&'static str; 2],
        rows: usize,
        columns: usize,
    ) -> Result<Self, LoadError> {
        let expected = rows.div_ceil(ROWS).saturating_mul(columns);
        let tiles = pack.slice(weights, expected)?;
        let shape = LoadError::Shape { tensor: weights, found: tiles.len(), expected };
        Ok(Self { weights: Tiled::new(rows, columns, tiles).ok_or(shape)?, bias: pack.slice(bias, rows)? })
    }

    /// `tanh(W x + b)`: `out` gets one value a row; what lies behind is left alone.
    fn apply_tanh(&self, x: &[f32], out: &mut [f32]) {
        let Some(out) = out.get_mut(..self.bias.len()) else { return };
        for ((sums, bias), out) in self.weights.sums(x).zip(self.bias.chunks(ROWS)).zip(out.chunks_mut(ROWS)) {
            for ((out, bias), sum) in out.iter_mut().zip(bias).zip(sums) {
                *out = bias + sum;
            }
        }
        for out in out {
            *out = tanh(*out);
        }
    }
}
