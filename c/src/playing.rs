//! What all models have in common: a pipeline of core's, which lies in the caller's memory and keeps bad frames out.

use kinesic::engine::{Controls, Engine, FromPack};
use kinesic::{Pack, Pipeline, PipelineState};

use crate::storage;
use crate::{KINESIC_ROWS, KinesicPose, KinesicStatus};

/// The model.
pub type Playing<E> = Pipeline<'static, E, KINESIC_ROWS>;
/// What it remembers.
pub type State<E> = PipelineState<<E as Engine<KINESIC_ROWS>>::State, KINESIC_ROWS>;

/// Loads the engines `E` of a pack into `model`. `wanted` says whether what was loaded is enough.
///
/// # Safety
/// `pack` is null or valid for `len` bytes for as long as the model is used; `model` is null or valid.
pub unsafe fn load<M, E>(model: *mut M, pack: *const u8, len: usize, wanted: impl Fn(&E) -> bool) -> KinesicStatus
where
    E: Engine<KINESIC_ROWS> + FromPack<'static> + Copy,
{
    // SAFETY: by the caller's promise.
    let Some(bytes) = (unsafe { storage::bytes(pack, len) }) else { return KinesicStatus::Null };
    match Pack::load(bytes).and_then(|pack| Playing::<E>::load(&pack)) {
        Ok(loaded) if !wanted(&loaded.engine) => KinesicStatus::NoModel,
        // SAFETY: by the caller's promise.
        Ok(loaded) if unsafe { storage::put(model, loaded) } => KinesicStatus::Ok,
        Ok(_) => KinesicStatus::Null,
        Err(error) => error.into(),
    }
}

/// Makes a new state.
///
/// # Safety
/// `state` is null or valid.
pub unsafe fn new<S, E>(state: *mut S)
where
    E: Engine<KINESIC_ROWS>,
    E::State: Copy,
{
    // SAFETY: by the caller's promise.
    unsafe { storage::put(state, State::<E>::new()) };
}

/// How far the body may be carried from where the source stands, m.
///
/// # Safety
/// `model` was loaded with `E`, or is null.
pub unsafe fn set_reach<M, E>(model: *mut M, reach: f32)
where
    E: Engine<KINESIC_ROWS> + Copy + 'static,
{
    // SAFETY: by the caller's promise.
    if let Some(model) = unsafe { storage::get_mut::<_, Playing<E>>(model) } {
        model.reach = reach;
    }
}

/// Puts everything where it would be had `source` always been held.
///
/// # Safety
/// `model` was loaded with `E`, `state` was made with `E`, `source` is valid; or null.
pub unsafe fn start<M, S, E>(model: *const M, state: *mut S, source: *const KinesicPose)
where
    E: Engine<KINESIC_ROWS> + Copy + 'static,
    E::State: Copy + 'static,
{
    // SAFETY: by the caller's promise.
    let parts = unsafe {
        (storage::get::<_, Playing<E>>(model), storage::get_mut::<_, State<E>>(state), source.as_ref().copied())
    };
    if let (Some(model), Some(state), Some(source)) = parts {
        model.start(state, &source.to_core());
    }
}

/// One frame; a null `source` is a frame that did not come.
///
/// # Safety
/// `model` was loaded with `E`, `state` was made with `E`, the poses are valid; or null.
pub unsafe fn step<M, S, E>(model: *const M, state: *mut S, source: *const KinesicPose, out: *mut KinesicPose)
where
    E: Engine<KINESIC_ROWS> + Copy + 'static,
    E::State: Copy + 'static,
{
    // SAFETY: by the caller's promise; the source is copied before `out` is borrowed.
    let parts = unsafe {
        let source = source.as_ref().map(|source| source.to_core());
        (storage::get::<_, Playing<E>>(model), storage::get_mut::<_, State<E>>(state), source, out.as_mut())
    };
    if let (Some(model), Some(state), source, Some(out)) = parts {
        let mut pose = out.to_core();
        model.step(state, source.as_ref(), &mut pose);
        out.set(&pose);
    }
}

/// The weight of a joint in controls that `mask` finds in the state.
///
/// # Safety
/// `model` was loaded with `E`, `state` was made with `E`; or null.
pub unsafe fn set_weight<M, S, E>(
    model: *const M,
    state: *mut S,
    joint: usize,
    weight: f32,
    controls: impl Fn(&mut E::State) -> &mut Controls<KINESIC_ROWS>,
) where
    E: Engine<KINESIC_ROWS> + Copy + 'static,
    E::State: Copy + 'static,
{
    // SAFETY: by the caller's promise.
    let parts = unsafe { (storage::get::<_, Playing<E>>(model), storage::get_mut::<_, State<E>>(state)) };
    if let (Some(model), Some(state)) = parts {
        model.rig().weigh(joint, weight, &mut controls(&mut state.engine).mask);
    }
}
