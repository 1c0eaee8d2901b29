//! The linear part of a translator in f32.

use super::bank::Bank;
use super::experts::Experts;
use super::gate::{Gate, Sight};
use crate::kernel;
use crate::model::{Form, LoadError, Numbers, Pack, TranslatorMeta};

/// From the normalised input to styled coordinates and the clock.
#[derive(Clone, Copy, Debug)]
pub(super) struct Float<'a> {
    /// Output at zero input and state, rad or m.
    bias: &'a [[f32; 3]],
    /// Direct term from a row of coordinates to itself, row-major 3 x 3, rad or m.
    direct: &'a [[f32; 9]],
    timing: TimingHead<'a>,
    bank: Bank<'a>,
    experts: Option<Experts<'a>>,
}

/// log2 of the duration, as a linear function of the normalised input (and, whole body, of the states).
#[derive(Clone, Copy, Debug)]
struct TimingHead<'a> {
    bias: f32,
    /// Lowest and highest log2 that was seen in training.
    range: [f32; 2],
    input: &'a [f32],
    states: &'a [f32],
}

impl<'a> Float<'a> {
    pub fn load<N: Numbers>(
        pack: &Pack<'a>,
        meta: &TranslatorMeta,
        gate: Option<&Gate>,
        rows: usize,
    ) -> Result<Self, LoadError> {
        let bank = Bank::load(pack, meta, rows)?;
        let timing_states = match meta.form {
            Form::WholeBody => 2 * meta.blocks as usize + meta.drives as usize,
            Form::PerJoint => 0,
        };
        let [bias, low, high] = timing(pack)?;
        Ok(Self {
            bias: pack.slice("translate/bias", rows)?,
            direct: pack.slice("translate/direct", rows)?,
            timing: TimingHead {
                bias,
                range: [low, high],
                input: pack.slice("translate/timing_input", 3 * rows)?,
                states: pack.slice("translate/timing_states", timing_states)?,
            },
            bank,
            experts: if N::GATED { Experts::load(pack, meta, gate, rows)? } else { None },
        })
    }

    pub fn multiply_adds(&self, rows: usize) -> usize {
        self.bank.multiply_adds(rows) + self.experts.map_or(0, |experts| experts.multiply_adds(rows))
    }

    /// Whether it has output stages for several actions.
    pub fn is_expert(&self) -> bool {
        self.experts.is_some()
    }

    /// See [`Bank::settle`].
    pub fn settle(&self, input: &[[f32; 3]], filters: &mut [f32]) {
        self.bank.settle(input, filters);
    }

    /// One frame: `output` in rad or m; log2 of the duration.
    pub fn step<N: Numbers>(
        &self,
        input: &[[f32; 3]],
        sight: &Sight,
        filters: &mut [f32],
        output: &mut [[f32; 3]],
    ) -> f32 {
        self.apply_direct(input, output);
        // Timing reads the states that the output reads, before they move on.
        self.bank.project(input, filters);
        let log2 = self.timing.evaluate(input.as_flattened(), filters);
        if let (Some(experts), true) = (&self.experts, N::GATED) {
            experts.add(sight, filters, output);
        }
        self.bank.advance(input, filters, output);
        log2
    }

    /// `y = bias + D_joint u`.
    fn apply_direct(&self, input: &[[f32; 3]], output: &mut [[f32; 3]]) {
        for (((output, bias), direct), [u0, u1, u2]) in output.iter_mut().zip(self.bias).zip(self.direct).zip(input) {
            let [a, b, c, d, e, f, g, h, i] = *direct;
            let [x, y, z] = *bias;
            *output = [x + a * u0 + b * u1 + c * u2, y + d * u0 + e * u1 + f * u2, z + g * u0 + h * u1 + i * u2];
        }
    }
}

impl TimingHead<'_> {
    fn evaluate(&self, input: &[f32], states: &[f32]) -> f32 {
        let [low, high] = self.range;
        let log2 = self.bias + kernel::dot(self.input, input) + kernel::dot(self.states, states);
        log2.max(low).min(high)
    }
}

/// `[bias, low, high]` of the clock's log2.
pub(super) fn timing(pack: &Pack) -> Result<[f32; 3], LoadError> {
    Ok(match pack.slice::<[f32; 3]>("translate/timing", 1)? {
        [timing] => *timing,
        _ => [0.0; 3],
    })
}
