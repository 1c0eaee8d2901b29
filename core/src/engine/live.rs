//! Whatever a pack has for live frames, for callers that do not name engines: C, a page, a test.

use super::{Controls, Engine};
use crate::components::{Components, ComponentsState};
use crate::limit::{SmoothLimitState, SmoothLimiter};
use crate::rig::Frame;
use crate::translate::{Translator, TranslatorState};

/// Engines that restyle a frame, then limits: those that the pack has, one after the other. `STATES` is the translator's capacity, `COUNT`
/// the components'. It stores and links all of them: a program that knows its pack names its engines.
pub type Live<'a, const ROWS: usize, const STATES: usize, const COUNT: usize> =
    (Option<Translator<'a, ROWS, STATES>>, Option<Components<'a, ROWS, COUNT>>, Option<SmoothLimiter<'a, ROWS>>);

/// What they remember.
pub type LiveState<const ROWS: usize, const STATES: usize> =
    (TranslatorState<ROWS, STATES>, ComponentsState<ROWS>, SmoothLimitState<ROWS>);

/// True if the pack has any of them.
pub fn is_any<const ROWS: usize, const STATES: usize, const COUNT: usize>(
    (translator, components, limiter): &Live<ROWS, STATES, COUNT>,
) -> bool {
    translator.is_some() || components.is_some() || limiter.is_some()
}

/// Leaves only the first of those that restyle, and no limits. False if there is none.
pub fn keep_first<const ROWS: usize, const STATES: usize, const COUNT: usize>(
    (translator, components, limiter): &mut Live<ROWS, STATES, COUNT>,
) -> bool {
    *limiter = None;
    let found = translator.is_some();
    if found {
        *components = None;
    }
    found || components.is_some()
}

/// Starts each of them from the same frame. For one that was [kept alone](keep_first): in series they start by
/// [`Engine::start`], each from what those before make of the frame.
pub fn start_each<const ROWS: usize, const STATES: usize, const COUNT: usize>(
    (translator, components, limiter): &Live<ROWS, STATES, COUNT>,
    state: &mut LiveState<ROWS, STATES>,
    frame: &Frame<ROWS>,
) {
    Engine::start(translator, &mut state.0, frame);
    Engine::start(components, &mut state.1, frame);
    Engine::start(limiter, &mut state.2, frame);
}

/// Strength and mask of each of those that restyle.
pub fn controls<const ROWS: usize, const STATES: usize>(
    (translator, components, _): &mut LiveState<ROWS, STATES>,
) -> impl Iterator<Item = &mut Controls<ROWS>> {
    [&mut translator.controls, &mut components.controls].into_iter()
}

/// The state is that of the composition.
const _: fn() = || {
    fn same<const ROWS: usize, S, E: Engine<ROWS, State = S>>() {}
    same::<1, LiveState<1, 1>, Live<1, 1, 1>>();
};
