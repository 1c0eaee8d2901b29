//! Layers on top of each other.

use super::blend::take;
use super::layer::Layer;

/// Plays moves in layers: `N` coordinates, `LAYERS` layers, the first one at the bottom.
///
/// All of it is state, owned by the caller; it can stand in a `static`. See [`play`](super) for an example.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Player<'a, const N: usize, const LAYERS: usize> {
    /// The layers. The first one has the weight 1 from the beginning, the others 0.
    pub layers: [Layer<'a, N>; LAYERS],
    rest: [f32; N],
    shown: [f32; N],
}

impl<'a, const N: usize, const LAYERS: usize> Player<'a, N, LAYERS> {
    /// All layers at rest, which are these coordinates, finite, rad or m.
    pub const fn new(rest: [f32; N]) -> Self {
        let mut layers = [Layer::new(rest, 0.0); LAYERS];
        if let Some((base, _)) = layers.split_first_mut() {
            *base = Layer::new(rest, 1.0);
        }
        Self { layers, rest, shown: rest }
    }

    /// Puts it where the robot stands. The first layer goes from there to what it plays in `frames` frames, with weight, strength and mask
    /// 1 again, and the others are not seen.
    /// Numbers that are not finite are ignored.
    pub fn start(&mut self, coordinates: [f32; N], frames: u16) {
        take(&mut self.shown, &coordinates);
        let mut layers = self.layers.iter_mut();
        layers.next().into_iter().for_each(|base| base.stand(&self.shown, frames));
        layers.for_each(Layer::hide);
    }

    /// The first layer goes to rest, and the others fade, in `frames` frames.
    pub fn rest(&mut self, frames: u16) {
        let mut layers = self.layers.iter_mut();
        layers.next().into_iter().for_each(|base| base.rest(frames));
        layers.for_each(|layer| layer.leave(frames));
    }

    /// The coordinates of the last step.
    pub fn shown(&self) -> &[f32; N] {
        &self.shown
    }

    /// One frame: the coordinates to show, for [`Pipeline::step_coordinates`](crate::Pipeline::step_coordinates). Infallible. Cost: about 25
    /// multiply-adds per coordinate and layer.
    pub fn step(&mut self) -> &[f32; N] {
        let mut x = self.rest;
        for layer in &mut self.layers {
            layer.step(&self.rest, &mut x);
        }
        self.shown = x;
        &self.shown
    }
}
