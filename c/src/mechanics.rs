//! Body mechanics and expressiveness.

use core::mem::MaybeUninit;

use kinesic::mechanics::Expression;

use crate::playing::{self, State};
use crate::storage;
use crate::{KINESIC_JOINTS, KINESIC_UNITS, KINESIC_WINDOW, KinesicPose, KinesicStatus};

type Engine = Expression<'static, KINESIC_JOINTS, KINESIC_UNITS, KINESIC_WINDOW>;

/// Loaded body mechanics. They borrow the pack.
#[repr(C)]
pub struct KinesicMechanics {
    words: [MaybeUninit<usize>; 96],
}

/// What running body mechanics remember.
#[repr(C)]
pub struct KinesicMechanicsState {
    words: [MaybeUninit<usize>; 560],
}

/// Loads the body mechanics of a pack, with every check that makes stepping infallible.
///
/// # Safety
/// `pack` is null or valid for `len` bytes for as long as the model is used; `model` is null or valid.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinesic_mechanics_load(
    model: *mut KinesicMechanics,
    pack: *const u8,
    len: usize,
) -> KinesicStatus {
    // SAFETY: by the caller's promise.
    unsafe { playing::load::<_, Engine>(model, pack, len, |_| true) }
}

/// Makes a new state: nothing seen yet.
///
/// # Safety
/// `state` is null or valid.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinesic_mechanics_state(state: *mut KinesicMechanicsState) {
    // SAFETY: by the caller's promise.
    unsafe { playing::new::<_, Engine>(state) };
}

/// One frame with more or less expression: `amount` 0 = none, 1 = as observed, 2 = twice. A null or garbled `source` is a frame that
/// did not come: the last one is held. `out` is a pose of its own that keeps what went out before; `kinesic_pose_rest` makes the first.
///
/// # Safety
/// `model` was loaded, `state` was made, the poses are valid; or null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinesic_mechanics_modulate(
    model: *const KinesicMechanics,
    state: *mut KinesicMechanicsState,
    source: *const KinesicPose,
    amount: f32,
    out: *mut KinesicPose,
) {
    // SAFETY: by the caller's promise; the first borrow ends before the second begins.
    unsafe {
        if let Some(state) = storage::get_mut::<_, State<Engine>>(state) {
            state.engine.modulation.amount = amount;
        }
        playing::step::<_, _, Engine>(model, state, source, out);
    }
}

/// Weight of a joint from now on: 0 = as observed, 1 = the whole amount. A joint past the capacity is ignored.
///
/// # Safety
/// `state` was made, or is null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinesic_mechanics_set_weight(state: *mut KinesicMechanicsState, joint: usize, weight: f32) {
    // SAFETY: by the caller's promise.
    let state = unsafe { storage::get_mut::<_, State<Engine>>(state) };
    if let Some(to) = state.and_then(|state| state.engine.modulation.mask.get_mut(joint)) {
        *to = weight;
    }
}
