//! Style translation.

use core::mem::MaybeUninit;

use kinesic::{Pack, Translator};

use crate::playing::{self, State};
use crate::storage;
use crate::{KINESIC_ROWS, KINESIC_STATES, KinesicPose, KinesicStatus};

type Engine = Translator<'static, KINESIC_ROWS, KINESIC_STATES>;

/// A loaded translator. It borrows the pack.
#[repr(C)]
pub struct KinesicTranslator {
    words: [MaybeUninit<usize>; 96],
}

/// What a running translator remembers: all the RAM that there is.
#[repr(C)]
pub struct KinesicTranslatorState {
    words: [MaybeUninit<usize>; 1616],
}

/// Loads the translator of a pack, with every check that makes stepping infallible.
///
/// # Safety
/// `pack` is null or valid for `len` bytes for as long as the model is used; `model` is null or valid.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinesic_translator_load(
    model: *mut KinesicTranslator,
    pack: *const u8,
    len: usize,
) -> KinesicStatus {
    // SAFETY: by the caller's promise.
    unsafe { playing::load::<_, Engine>(model, pack, len, |_| true) }
}

/// Frames per second at which the pack must be stepped; 0 for bytes that are no pack.
///
/// # Safety
/// `pack` is null or valid for `len` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinesic_frame_rate(pack: *const u8, len: usize) -> f32 {
    // SAFETY: by the caller's promise.
    let bytes = unsafe { storage::bytes(pack, len) };
    bytes.and_then(|bytes| Pack::load(bytes).ok()).map_or(0.0, |pack| pack.metadata().frame_rate)
}

/// Makes a new state: zero filters, strength 1, all joints.
///
/// # Safety
/// `state` is null or valid.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinesic_translator_state(state: *mut KinesicTranslatorState) {
    // SAFETY: by the caller's promise.
    unsafe { playing::new::<_, Engine>(state) };
}

/// Initialises the filters to their steady state for this pose, so that the first half second does not ease in.
///
/// # Safety
/// `model` was loaded, `state` was made, `source` is valid; or null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinesic_translator_start(
    model: *const KinesicTranslator,
    state: *mut KinesicTranslatorState,
    source: *const KinesicPose,
) {
    // SAFETY: by the caller's promise.
    unsafe { playing::start::<_, _, Engine>(model, state, source) };
}

/// Translates one frame: `source` in, `styled` out. A null or garbled `source` is a frame that did not come: the last one is held.
/// `styled` is a pose of its own that keeps what went out before; `kinesic_pose_rest` makes the first.
///
/// # Safety
/// `model` was loaded, `state` was made, the poses are valid; or null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinesic_translator_step(
    model: *const KinesicTranslator,
    state: *mut KinesicTranslatorState,
    source: *const KinesicPose,
    styled: *mut KinesicPose,
) {
    // SAFETY: by the caller's promise.
    unsafe { playing::step::<_, _, Engine>(model, state, source, styled) };
}

/// How far the body may be carried over the ground from where the source stands, m: changed steps make another way, which counts in full up to
/// half the reach and then ever less. A loaded model has 4; infinity is as far as it gets.
///
/// # Safety
/// `model` was loaded, or is null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinesic_translator_set_reach(model: *mut KinesicTranslator, reach: f32) {
    // SAFETY: by the caller's promise.
    unsafe { playing::set_reach::<_, Engine>(model, reach) };
}

/// Strength from now on: 0 = the source, 1 = as learned, beyond = exaggerated.
///
/// # Safety
/// `state` was made, or is null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinesic_translator_set_strength(state: *mut KinesicTranslatorState, strength: f32) {
    // SAFETY: by the caller's promise.
    if let Some(state) = unsafe { storage::get_mut::<_, State<Engine>>(state) } {
        state.engine.controls.strength = strength;
    }
}

/// Weight of a joint from now on: 0 = untouched, 1 = translated. A joint that the pack does not have is ignored.
///
/// # Safety
/// `model` was loaded, `state` was made; or null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinesic_translator_set_weight(
    model: *const KinesicTranslator,
    state: *mut KinesicTranslatorState,
    joint: usize,
    weight: f32,
) {
    // SAFETY: by the caller's promise.
    unsafe { playing::set_weight::<_, _, Engine>(model, state, joint, weight, |state| &mut state.controls) };
}
