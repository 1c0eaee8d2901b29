//! Style components.

use core::mem::MaybeUninit;

use kinesic::{Components, ComponentsState, Pack, Pose};

use crate::storage;
use crate::{KINESIC_COMPONENTS, KINESIC_JOINTS, KinesicPose, KinesicStatus};

type Model = Components<'static, KINESIC_JOINTS, KINESIC_COMPONENTS>;
type State = ComponentsState<KINESIC_JOINTS>;

/// Loaded style components. They borrow the pack.
#[repr(C)]
pub struct KinesicComponents {
    words: [MaybeUninit<usize>; 64],
}

/// What running components remember.
#[repr(C)]
pub struct KinesicComponentsState {
    words: [MaybeUninit<usize>; 48],
}

/// Loads the style components of a pack, with every check that makes stepping infallible.
///
/// # Safety
/// `pack` is null or valid for `len` bytes for as long as the model is used; `model` is null or valid.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinesic_components_load(
    model: *mut KinesicComponents,
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

/// Makes a new state: at the origin, facing +Z, strength 1, all joints.
///
/// # Safety
/// `state` is null or valid.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinesic_components_state(state: *mut KinesicComponentsState) {
    // SAFETY: by the caller's promise.
    unsafe { storage::put(state, State::new()) };
}

/// Restyles one live frame, `source` in, `styled` out; with a null `source`, plays the next frame of the stored motion.
///
/// # Safety
/// `model` was loaded, `state` was made, the poses are valid; or null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinesic_components_step(
    model: *const KinesicComponents,
    state: *mut KinesicComponentsState,
    source: *const KinesicPose,
    styled: *mut KinesicPose,
) {
    // SAFETY: by the caller's promise; the source is copied before the result is written.
    let parts =
        unsafe { (storage::get::<_, Model>(model), storage::get_mut::<_, State>(state), source.as_ref().copied()) };
    if let (Some(model), Some(state), source) = parts {
        let mut out = Pose::identity();
        match source {
            Some(source) => model.step(state, &source.to_core(), &mut out),
            None => model.step_stored(state, &mut out),
        }
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
pub unsafe extern "C" fn kinesic_components_set_strength(state: *mut KinesicComponentsState, strength: f32) {
    // SAFETY: by the caller's promise.
    if let Some(state) = unsafe { storage::get_mut::<_, State>(state) } {
        state.controls.strength = strength;
    }
}
