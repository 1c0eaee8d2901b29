//! All that a pack says of live frames: translator, style components, joint limits, one after the other, those that it has.

use core::mem::MaybeUninit;

use kinesic::engine::live::{self, Live};

use crate::playing::{self, Playing, State};
use crate::storage;
use crate::{KINESIC_COMPONENTS, KINESIC_ROWS, KINESIC_STATES, KinesicPose, KinesicStatus};

type Engine = Live<'static, KINESIC_ROWS, KINESIC_STATES, KINESIC_COMPONENTS>;

/// The loaded engines of a pack: translator, style components and joint limits, in this order. They borrow the pack.
#[repr(C)]
pub struct KinesicPipeline {
    words: [MaybeUninit<usize>; 192],
}

/// What a running pipeline remembers.
#[repr(C)]
pub struct KinesicPipelineState {
    words: [MaybeUninit<usize>; 3200],
}

/// Loads the engines of a pack, with every check that makes stepping infallible. A pack needs one of the three.
///
/// # Safety
/// `pack` is null or valid for `len` bytes for as long as the model is used; `model` is null or valid.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinesic_pipeline_load(
    model: *mut KinesicPipeline,
    pack: *const u8,
    len: usize,
) -> KinesicStatus {
    // SAFETY: by the caller's promise.
    unsafe { playing::load(model, pack, len, |engine: &Engine| live::is_any(engine)) }
}

/// Makes a new state: nothing seen yet, strengths 1, all joints; limits begin at rest.
///
/// # Safety
/// `state` is null or valid.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinesic_pipeline_state(state: *mut KinesicPipelineState) {
    // SAFETY: by the caller's promise.
    unsafe { playing::new::<_, Engine>(state) };
}

/// Puts everything where it would be had this pose always been held.
///
/// # Safety
/// `model` was loaded, `state` was made, `source` is valid; or null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinesic_pipeline_start(
    model: *const KinesicPipeline,
    state: *mut KinesicPipelineState,
    source: *const KinesicPose,
) {
    // SAFETY: by the caller's promise.
    unsafe { playing::start::<_, _, Engine>(model, state, source) };
}

/// One frame: `source` in, `out` out. A null or garbled `source` is a frame that did not come: limits brake, hold and go to rest,
/// everything else is held. `out` is a pose of its own that keeps what went out before; `kinesic_pose_rest` makes the first.
///
/// # Safety
/// `model` was loaded, `state` was made, the poses are valid; or null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinesic_pipeline_step(
    model: *const KinesicPipeline,
    state: *mut KinesicPipelineState,
    source: *const KinesicPose,
    out: *mut KinesicPose,
) {
    // SAFETY: by the caller's promise.
    unsafe { playing::step::<_, _, Engine>(model, state, source, out) };
}

/// One frame of coordinates in order, rad or m: servo positions in and out, without any rotation. A null or garbled `source` is a
/// frame that did not come. `kinesic_pipeline_coordinates` says how many there are; those past the end of an array are left out.
///
/// # Safety
/// `model` was loaded, `state` was made, `source` and `out` are valid for `len` floats; or null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinesic_pipeline_step_coordinates(
    model: *const KinesicPipeline,
    state: *mut KinesicPipelineState,
    source: *const f32,
    out: *mut f32,
    len: usize,
) {
    let mut copy = [0.0; 3 * KINESIC_ROWS];
    let len = len.min(copy.len());
    // SAFETY: by the caller's promise; the source is copied before `out` is borrowed.
    let parts = unsafe {
        let source = storage::slice(source, len).map(|source| {
            copy.iter_mut().zip(source).for_each(|(to, from)| *to = *from);
            copy.get(..len).unwrap_or(&[])
        });
        let state = storage::get_mut::<_, State<Engine>>(state);
        (storage::get::<_, Playing<Engine>>(model), state, source, storage::slice_mut(out, len))
    };
    if let (Some(model), Some(state), source, Some(out)) = parts {
        model.step_coordinates(state, source, out);
    }
}

/// Coordinates of a loaded pack, what rows leave free included; 0 for a null model.
///
/// # Safety
/// `model` was loaded, or is null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinesic_pipeline_coordinates(model: *const KinesicPipeline) -> usize {
    // SAFETY: by the caller's promise.
    unsafe { storage::get::<_, Playing<Engine>>(model) }.map_or(0, |model| model.rig().coordinates())
}

/// How far the body may be carried over the ground from where the source stands, m: changed steps make another way, which counts in full up to
/// half the reach and then ever less. A loaded model has 4; infinity is as far as it gets.
///
/// # Safety
/// `model` was loaded, or is null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinesic_pipeline_set_reach(model: *mut KinesicPipeline, reach: f32) {
    // SAFETY: by the caller's promise.
    unsafe { playing::set_reach::<_, Engine>(model, reach) };
}

/// Strength of translator and components from now on: 0 = the source, 1 = as learned, beyond = exaggerated.
///
/// # Safety
/// `state` was made, or is null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinesic_pipeline_set_strength(state: *mut KinesicPipelineState, strength: f32) {
    // SAFETY: by the caller's promise.
    if let Some(state) = unsafe { storage::get_mut::<_, State<Engine>>(state) } {
        live::controls(&mut state.engine).for_each(|controls| controls.strength = strength);
    }
}

/// Frames that did not come or were garbled since the last sound one; 0 for a null state.
///
/// # Safety
/// `state` was made, or is null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinesic_pipeline_gap(state: *const KinesicPipelineState) -> u32 {
    // SAFETY: by the caller's promise.
    unsafe { storage::get::<_, State<Engine>>(state) }.map_or(0, |state| state.report().gap)
}
