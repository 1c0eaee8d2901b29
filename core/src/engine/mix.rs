//! Engines side by side.

use super::Engine;
use crate::pose::is_number;
use crate::rig::Frame;

/// Several engines on the same frame, and the weighted mean of what they make of it, coordinate by coordinate.
///
/// The sum is taken in the order of the engines, so that host and target have the same bits.
#[derive(Clone, Copy, Debug)]
pub struct Mix<T>(
    /// A tuple of two to four engines.
    pub T,
);

/// The states of mixed engines, and how much each counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MixState<S, const COUNT: usize> {
    /// The engines' states, a tuple.
    pub engines: S,
    /// Weight of each engine, 1e-6 to 1e6. One that is less, more or not finite counts as 0.
    pub weights: [f32; COUNT],
    /// Weight of the source frame. If no weight counts, the source passes.
    pub source: f32,
}

impl<S: Default, const COUNT: usize> Default for MixState<S, COUNT> {
    /// Every engine alike, and not the source.
    fn default() -> Self {
        Self { engines: S::default(), weights: [1.0; COUNT], source: 0.0 }
    }
}

struct Sum<const ROWS: usize> {
    rows: [[f32; 3]; ROWS],
    total: f32,
}

impl<const ROWS: usize> Sum<ROWS> {
    fn add(&mut self, frame: &Frame<ROWS>, weight: f32) {
        // Single precision has room for the sum, and for one over it.
        let weight = if (1e-6..1e6).contains(&weight) { weight } else { 0.0 };
        self.total += weight;
        for (sum, x) in self.rows.as_flattened_mut().iter_mut().zip(frame.coordinates()) {
            *sum += weight * x;
        }
    }

    /// Nothing changes where no weight counts, nor where rounding takes the mean beyond what is [sound](Frame::is_sound).
    fn mean(self, frame: &mut Frame<ROWS>) {
        if self.total > 0.0 {
            let share = 1.0 / self.total;
            for (x, sum) in frame.coordinates_mut().iter_mut().zip(self.rows.as_flattened()) {
                let mean = sum * share;
                if is_number(mean) {
                    *x = mean;
                }
            }
        }
    }
}

macro_rules! mix {
    ($count:literal: $($engine:ident . $index:tt),+) => {
        impl<const ROWS: usize, $($engine: Engine<ROWS>),+> Engine<ROWS> for Mix<($($engine,)+)> {
            type State = MixState<($($engine::State,)+), $count>;

            fn start(&self, state: &mut Self::State, frame: &Frame<ROWS>) {
                $(self.0.$index.start(&mut state.engines.$index, frame);)+
            }

            fn step(&self, state: &mut Self::State, frame: &mut Frame<ROWS>) {
                let mut sum = Sum { rows: [[0.0; 3]; ROWS], total: 0.0 };
                sum.add(frame, state.source);
                let mut next = state.weights.iter();
                $(
                    let mut styled = *frame;
                    self.0.$index.step(&mut state.engines.$index, &mut styled);
                    sum.add(&styled, next.next().copied().unwrap_or(0.0));
                )+
                sum.mean(frame);
            }

            fn idle(&self, state: &mut Self::State, frame: &mut Frame<ROWS>) {
                let mut sum = Sum { rows: [[0.0; 3]; ROWS], total: 0.0 };
                sum.add(frame, state.source);
                let mut next = state.weights.iter();
                $(
                    let mut styled = *frame;
                    self.0.$index.idle(&mut state.engines.$index, &mut styled);
                    sum.add(&styled, next.next().copied().unwrap_or(0.0));
                )+
                sum.mean(frame);
            }
        }
    };
}

mix!(2: A.0, B.1);
mix!(3: A.0, B.1, C.2);
mix!(4: A.0, B.1, C.2, D.3);

#[cfg(test)]
mod tests {
    use super::*;

    /// Adds a number to every coordinate, and counts.
    struct Add(f32);

    impl Engine<1> for Add {
        type State = u32;
        fn start(&self, state: &mut u32, _: &Frame<1>) {
            *state = 0;
        }
        fn step(&self, state: &mut u32, frame: &mut Frame<1>) {
            *state += 1;
            frame.coordinates_mut().iter_mut().for_each(|x| *x += self.0);
        }
    }

    #[test]
    fn it_is_the_weighted_mean_and_the_source_where_nothing_counts() {
        let mix = Mix((Add(1.0), Add(4.0)));
        let mut state = MixState { source: 1.0, ..MixState::default() };
        let run = |state: &mut MixState<(u32, u32), 2>| {
            let mut frame = Frame::<1>::from_coordinates(&[1.0, 2.0, 3.0]);
            mix.step(state, &mut frame);
            frame.rows[0]
        };
        state.weights = [2.0, 1.0];
        assert_eq!(run(&mut state), [2.5, 3.5, 4.5]);
        state.weights = [f32::NAN, -1.0];
        assert_eq!(run(&mut state), [1.0, 2.0, 3.0]);
        state.source = 0.0;
        assert_eq!(run(&mut state), [1.0, 2.0, 3.0]);
        assert_eq!(state.engines, (3, 3));
    }

    #[test]
    fn a_chain_is_one_engine_after_the_other() {
        let chain = (Add(1.0), Some(Add(2.0)), None::<Add>);
        let mut state = <(Add, Option<Add>, Option<Add>) as Engine<1>>::State::default();
        let mut frame = Frame::<1>::new();
        chain.step(&mut state, &mut frame);
        assert_eq!((frame.rows[0][0], state), (3.0, (1, 1, 0)));
        chain.idle(&mut state, &mut frame);
        assert_eq!((frame.rows[0][0], state), (3.0, (1, 1, 0)));
    }

    #[test]
    fn a_mean_of_sound_frames_is_sound_whatever_the_weights() {
        let mix = Mix((Add(0.0), Add(0.0)));
        for weight in [1e-45, 1e-40, 1e-38, 1e-7, 1e-6, 0.1, 0.3, 7.0, 999_999.0, 1e6, 3e38, f32::INFINITY] {
            for x in [0.5, -999_999.94, 999_999.94] {
                let mut state =
                    MixState { weights: [weight, 0.3 * weight], source: 1e-3 * weight, ..MixState::default() };
                let mut frame = Frame::<1>::from_coordinates(&[x; 3]);
                mix.step(&mut state, &mut frame);
                assert!(frame.is_sound(), "{weight}, {x}: {:?}", frame.rows);
                assert!((frame.rows[0][0] - x).abs() < 1e-6 * x.abs(), "{weight}, {x}: {:?}", frame.rows);
            }
        }
    }
}
