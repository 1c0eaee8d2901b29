//! Style translation.

use core::mem::MaybeUninit;

use kinesic::{Pack, Pose, Translator, TranslatorState};

use crate::storage;
use crate::{KINESIC_JOINTS, KINESIC_STATES, KinesicPose, KinesicStatus};

type Model = Translator<'static, KINESIC_JOINTS, KINESIC_STATES>;
type State = TranslatorState<KINESIC_JOINTS, KINESIC_STATES>;

/// A loaded translator. It borrows the pack.
#[repr(C)]
pub struct KinesicTranslator {
    words: [MaybeUninit<usize>; 96],
}

/// What a running translator remembers: all the RAM that there is.
#[repr(C)]
pub struct KinesicTranslatorState {
    words: [MaybeUninit<usize>; 1344],
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
    let Some(bytes) = (unsafe { storage::bytes(pack, len) }) else { return KinesicStatus::Null };
    match Pack::load(bytes).and_then(|pack| Model::load(&pack)) {
        // SAFETY: by the caller's promise.
        Ok(loaded) if unsafe { storage::put(model, loaded) } => KinesicStatus::Ok,
        Ok(_) => KinesicStatus::Null,
        Err(error) => error.into(),
    }
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
    unsafe { storage::put(state, State::new()) };
}

/// Puts the filters where holding this pose for ever would have brought them, so that the first half second does not ease in.
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
    let parts = unsafe { (storage::get::<_, Model>(model), storage::get_mut::<_, State>(state), source.as_ref()) };
    if let (Some(model), Some(state), Some(source)) = parts {
        model.start(state, &source.to_core());
    }
}

/// Translates one frame: `source` in, `styled` out; they may be the same pose.
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
    // SAFETY: by the caller's promise; the source is copied before the result is written.
    let parts =
        unsafe { (storage::get::<_, Model>(model), storage::get_mut::<_, State>(state), source.as_ref().copied()) };
    if let (Some(model), Some(state), Some(source)) = parts {
        let mut out = Pose::identity();
        model.step(state, &source.to_core(), &mut out);
        // SAFETY: by the caller's promise.
        if let Some(styled) = unsafe { styled.as_mut() } {
            styled.set(&out);
        }
    }
}

/// Strength from now on: 0 = the source, 1 = as learned, beyond = exaggerated.
///
/// # Safety
/// `state` was made, or is null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinesic_translator_set_strength(state: *mut KinesicTranslatorState, strength: f32) {
    // SAFETY: by the caller's promise.
    if let Some(state) = unsafe { storage::get_mut::<_, State>(state) } {
        state.controls.strength = strength;
    }
}

/// Weight of a joint from now on: 0 = untouched, 1 = translated. A joint past the capacity is ignored.
///
/// # Safety
/// `state` was made, or is null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinesic_translator_set_weight(state: *mut KinesicTranslatorState, joint: usize, weight: f32) {
    // SAFETY: by the caller's promise.
    let state = unsafe { storage::get_mut::<_, State>(state) };
    if let Some(mask) = state.and_then(|state| state.controls.mask.get_mut(joint)) {
        *mask = weight;
    }
}
