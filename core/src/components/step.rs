//! One frame of style components.

use nalgebra::Vector3;

use super::{Components, ComponentsState};
use crate::engine::{Engine, FromPack};
use crate::model::{LoadError, Pack};
use crate::rig::Frame;

impl<const ROWS: usize, const COUNT: usize> Components<'_, ROWS, COUNT> {
    /// Restyles one frame in place. Infallible; every loop has a length fixed at load time.
    ///
    /// `w = (x - mean) C_C^+`, then `x + strength (w (C_X - C_C) + shift)`: what the components do not explain of the frame
    /// stays. Strength 0 and a mask of 0 leave coordinates alone, bit for bit. Phong 2018, eq. 2. A frame that is not sound passes; so does one
    /// of which the result would not be sound. Cost: [`multiply_adds`](Self::multiply_adds).
    pub fn step(&self, state: &mut ComponentsState<ROWS>, frame: &mut Frame<ROWS>) {
        if !frame.is_sound() {
            return;
        }
        let mut from_mean = frame.rows;
        for (row, mean) in from_mean.iter_mut().zip(self.mean) {
            row.iter_mut().zip(mean).for_each(|(x, mean)| *x -= mean);
        }
        let mut weights = [0.0; COUNT];
        self.project.multiply_add(from_mean.as_flattened(), &mut weights);
        self.restyle(state, &weights, frame);
    }

    /// Plays the next frame of the stored stream, `M_X = W C_X`, into `frame`; after the last frame the first, from where the last ended.
    /// The stored path is followed by a rig that travels alone.
    ///
    /// Strength 0 gives the content, 1 the learned motion. Without a stored stream `frame` is the mean. Cost: as
    /// [`step`](Self::step).
    pub fn step_stored(&self, state: &mut ComponentsState<ROWS>, frame: &mut Frame<ROWS>) {
        let row = state.frame.saturating_mul(self.compose.columns());
        let stored = self.weights.get(row..).unwrap_or(&[]).iter().take(self.compose.columns());
        let mut weights = [0.0; COUNT];
        for (weight, stored) in weights.iter_mut().zip(stored) {
            *weight = *stored;
        }
        *frame = Frame::new();
        frame.rows.iter_mut().zip(self.mean).for_each(|(row, mean)| *row = *mean);
        self.compose.multiply_add(&weights, frame.rows.as_flattened_mut());
        let track = self.track.get(state.frame).filter(|_| self.travels);
        if let Some([x, z, sin, cos]) = track.copied() {
            state.heading = state.heading.turned(sin, cos);
            let way = state.heading.to_world(Vector3::new(x, 0.0, z));
            let [at_x, at_z] = state.ground;
            state.ground = [at_x + way.x, at_z + way.z];
            if let Some([to_x, _, to_z]) = frame.rows.first_mut() {
                (*to_x, *to_z) = (x, z);
            }
        }
        (frame.heading, frame.ground) = (state.heading, state.ground);
        state.frame = if state.frame + 1 < self.track.len() { state.frame + 1 } else { 0 };
        self.restyle(state, &weights, frame);
    }

    /// Moves a frame by what the style makes of the weights.
    fn restyle(&self, state: &ComponentsState<ROWS>, weights: &[f32; COUNT], frame: &mut Frame<ROWS>) {
        let mut styled = frame.rows;
        self.change.multiply_add(weights, styled.as_flattened_mut());
        for (row, shift) in styled.iter_mut().zip(self.shift) {
            row.iter_mut().zip(shift).for_each(|(x, shift)| *x += shift);
        }
        state.controls.apply(&mut styled, frame, self.rows);
    }
}

impl<const ROWS: usize, const COUNT: usize> Engine<ROWS> for Components<'_, ROWS, COUNT> {
    type State = ComponentsState<ROWS>;

    fn start(&self, state: &mut Self::State, _: &Frame<ROWS>) {
        state.reset();
    }

    fn step(&self, state: &mut Self::State, frame: &mut Frame<ROWS>) {
        Components::step(self, state, frame);
    }
}

impl<'a, const ROWS: usize, const COUNT: usize> FromPack<'a> for Components<'a, ROWS, COUNT> {
    fn from_pack(pack: &Pack<'a>) -> Result<Self, LoadError> {
        Self::load(pack)
    }
}
