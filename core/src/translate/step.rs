//! One frame of style translation.

use super::gate::Sight;
use super::model::{Linear, filters};
use super::{Timing, Translator, TranslatorState};
use crate::engine::{Engine, FromPack};
use crate::model::{LoadError, Numbers, Pack};
use crate::rig::Frame;

impl<const ROWS: usize, const STATES: usize, N: Numbers> Translator<'_, ROWS, STATES, N> {
    /// Initialises the filters to their steady state for `frame`.
    ///
    /// Without it they start from zero, as if the mean of the training had been held; then the first half second eases in. A frame that
    /// is not sound changes nothing. Cost: as a step, and a division per block.
    pub fn start(&self, state: &mut TranslatorState<ROWS, STATES>, frame: &Frame<ROWS>) {
        state.reset();
        if !frame.is_sound() {
            return;
        }
        let input = self.normalised(&frame.rows);
        match &self.linear {
            Linear::Float(linear) if N::FLOAT => linear.settle(&input, state.parts(filters(&self.meta)).0),
            Linear::Fixed(linear) if N::INTEGER => linear.settle(&input, state.parts(filters(&self.meta)).0),
            _ => {}
        }
    }

    /// Lets the gate see a frame that is not translated: how a clip moves before its first frame, say. After [`start`](Self::start), by which the
    /// body has stood still for ever. A frame that is not sound, or a model without a gate, changes nothing.
    pub fn watch(&self, state: &mut TranslatorState<ROWS, STATES>, frame: &Frame<ROWS>) {
        if let (Some(gate), true) = (&self.gate, N::GATED && frame.is_sound()) {
            let input = self.normalised(&frame.rows);
            let words = state.parts::<f32>(filters(&self.meta)).1;
            let sight = gate.look(input.get(..self.rows).unwrap_or_default(), words);
            state.familiar = sight.familiar;
        }
    }

    /// Translates one frame in place: `x + strength mask (y - x)`, where `y` is what the model makes of `x`. Infallible; every loop has
    /// a length fixed at load time.
    ///
    /// Height and travel of the root are translated, heading and place are the source's. Strength 0 and a mask of 0 leave coordinates
    /// alone, bit for bit. Where the model knows the frame to be unlike the training, `y` fades: see [`TranslatorState::fade`].
    /// A frame that is not sound passes, and the filters do not see it; should the result not be sound, the frame passes too, and the
    /// filters start anew. Cost: [`multiply_adds`](Self::multiply_adds).
    pub fn step(&self, state: &mut TranslatorState<ROWS, STATES>, frame: &mut Frame<ROWS>) -> Timing {
        if !frame.is_sound() {
            return Timing { duration: 1.0 };
        }
        let input = self.normalised(&frame.rows);
        let mut output = [[0.0; 3]; ROWS];
        let count = filters(&self.meta);
        let sight = match &self.gate {
            Some(gate) if N::GATED => {
                gate.look(input.get(..self.rows).unwrap_or_default(), state.parts::<f32>(count).1)
            }
            _ => Sight::EVERYTHING,
        };
        let mut log2 = match &self.linear {
            // Guards are constant: code of number types that N leaves out is not linked.
            Linear::Float(linear) if N::FLOAT => linear.step::<N>(&input, &sight, state.parts(count).0, &mut output),
            Linear::Fixed(linear) if N::INTEGER => linear.step(&input, state.parts(count).0, &mut output),
            _ => 0.0,
        };
        state.familiar = sight.familiar;
        if let (Some(gate), true) = (&self.gate, N::GATED && state.fade) {
            gate.fade(&sight, &frame.rows, &mut output);
            log2 *= sight.familiar;
        }
        if state.controls.apply(&mut output, frame, self.rows) {
            Timing { duration: exp2(log2) }
        } else {
            state.reset();
            Timing { duration: 1.0 }
        }
    }

    fn normalised(&self, rows: &[[f32; 3]; ROWS]) -> [[f32; 3]; ROWS] {
        let mut input = [[0.0; 3]; ROWS];
        for (((input, row), mean), scale) in input.iter_mut().zip(rows).zip(self.mean).zip(self.inverse_deviation) {
            for (((input, x), mean), scale) in input.iter_mut().zip(row).zip(mean).zip(scale) {
                *input = (x - mean) * scale;
            }
        }
        input
    }
}

impl<const ROWS: usize, const STATES: usize, N: Numbers> Engine<ROWS> for Translator<'_, ROWS, STATES, N> {
    type State = TranslatorState<ROWS, STATES>;

    fn start(&self, state: &mut Self::State, frame: &Frame<ROWS>) {
        Translator::start(self, state, frame);
    }

    fn step(&self, state: &mut Self::State, frame: &mut Frame<ROWS>) {
        Translator::step(self, state, frame);
    }
}

impl<'a, const ROWS: usize, const STATES: usize, N: Numbers> FromPack<'a> for Translator<'a, ROWS, STATES, N> {
    fn from_pack(pack: &Pack<'a>) -> Result<Self, LoadError> {
        Self::load_numbers(pack)
    }
}

/// `2^x` for `|x| <= 4`: the Taylor polynomial of degree 6 at `x / 8`, squared three times. Relative error below 2e-6.
fn exp2(x: f32) -> f32 {
    let t = x * (core::f32::consts::LN_2 / 8.0);
    let e = 1.0 + t * (1.0 + t * (0.5 + t * (1.0 / 6.0 + t * (1.0 / 24.0 + t * (1.0 / 120.0 + t * (1.0 / 720.0))))));
    let e2 = e * e;
    let e4 = e2 * e2;
    e4 * e4
}
