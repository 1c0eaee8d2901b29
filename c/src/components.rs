//! Style components.

use core::mem::MaybeUninit;

use kinesic::rig::Drift;
use kinesic::{Components, Frame};

use crate::playing::{self, Playing, State};
use crate::storage;
use crate::{KINESIC_COMPONENTS, KINESIC_ROWS, KinesicPose, KinesicStatus};

type Engine = Components<'static, KINESIC_ROWS, KINESIC_COMPONENTS>;

/// Loaded style components. They borrow the pack.
#[repr(C)]
pub struct KinesicComponents {
    words: [MaybeUninit<usize>; 64],
}

/// What running components remember.
#[repr(C)]
pub struct KinesicComponentsState {
    words: [MaybeUninit<usize>; 344],
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
    unsafe { playing::load::<_, Engine>(model, pack, len, |_| true) }
}

/// Makes a new state: at the origin, facing +Z, strength 1, all joints.
///
/// # Safety
/// `state` is null or valid.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinesic_components_state(state: *mut KinesicComponentsState) {
    // SAFETY: by the caller's promise.
    unsafe { playing::new::<_, Engine>(state) };
}

/// Restyles one live frame: `source` in, `styled` out. A null or garbled `source` is a frame that did not come: the last one is held.
/// `styled` is a pose of its own that keeps what went out before; `kinesic_pose_rest` makes the first.
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
    // SAFETY: by the caller's promise.
    unsafe { playing::step::<_, _, Engine>(model, state, source, styled) };
}

/// Plays the next frame of the stored motion; after the last frame the first.
///
/// # Safety
/// `model` was loaded, `state` was made, the pose is valid; or null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinesic_components_step_stored(
    model: *const KinesicComponents,
    state: *mut KinesicComponentsState,
    styled: *mut KinesicPose,
) {
    // SAFETY: by the caller's promise.
    let parts = unsafe {
        (storage::get::<_, Playing<Engine>>(model), storage::get_mut::<_, State<Engine>>(state), styled.as_mut())
    };
    if let (Some(model), Some(state), Some(styled)) = parts {
        let (mut frame, mut pose) = (Frame::new(), model.rig().rest());
        model.engine.step_stored(&mut state.engine, &mut frame);
        model.rig().show(&frame, &frame, &mut Drift::new(), &mut pose);
        styled.set(&pose);
    }
}

/// Strength from now on: 0 = the source, 1 = as learned, beyond = exaggerated.
///
/// # Safety
/// `state` was made, or is null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinesic_components_set_strength(state: *mut KinesicComponentsState, strength: f32) {
    // SAFETY: by the caller's promise.
    if let Some(state) = unsafe { storage::get_mut::<_, State<Engine>>(state) } {
        state.engine.controls.strength = strength;
    }
}

/// Weight of a joint from now on: 0 = untouched, 1 = restyled. A joint that the pack does not have is ignored.
///
/// # Safety
/// `model` was loaded, `state` was made; or null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinesic_components_set_weight(
    model: *const KinesicComponents,
    state: *mut KinesicComponentsState,
    joint: usize,
    weight: f32,
) {
    // SAFETY: by the caller's promise.
    unsafe { playing::set_weight::<_, _, Engine>(model, state, joint, weight, |state| &mut state.controls) };
}
