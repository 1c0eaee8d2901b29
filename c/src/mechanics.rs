//! Body mechanics and expressiveness.

use core::mem::MaybeUninit;

use kinesic::mechanics::{Decoupled, Modulation, modulate};
use kinesic::{BodyMechanics, MechanicsState, Pack, Pose};

use crate::storage;
use crate::{KINESIC_JOINTS, KINESIC_UNITS, KINESIC_WINDOW, KinesicPose, KinesicStatus};

type Model = BodyMechanics<'static, KINESIC_JOINTS, KINESIC_UNITS, KINESIC_WINDOW>;
type State = MechanicsState<KINESIC_JOINTS, KINESIC_WINDOW>;

/// Loaded body mechanics. They borrow the pack.
#[repr(C)]
pub struct KinesicMechanics {
    words: [MaybeUninit<usize>; 96],
}

/// What running body mechanics remember.
#[repr(C)]
pub struct KinesicMechanicsState {
    words: [MaybeUninit<usize>; 288],
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
    let Some(bytes) = (unsafe { storage::bytes(pack, len) }) else { return KinesicStatus::Null };
    match Pack::load(bytes).and_then(|pack| Model::load(&pack)) {
        // SAFETY: by the caller's promise.
        Ok(loaded) if unsafe { storage::put(model, loaded) } => KinesicStatus::Ok,
        Ok(_) => KinesicStatus::Null,
        Err(error) => error.into(),
    }
}

/// Makes a new state: nothing seen yet.
///
/// # Safety
/// `state` is null or valid.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinesic_mechanics_state(state: *mut KinesicMechanicsState) {
    // SAFETY: by the caller's promise.
    unsafe { storage::put(state, State::new()) };
}

/// One frame with more or less expression: `amount` 0 = none, 1 = as observed, 2 = twice.
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
    // SAFETY: by the caller's promise; the source is copied before the result is written.
    let parts =
        unsafe { (storage::get::<_, Model>(model), storage::get_mut::<_, State>(state), source.as_ref().copied()) };
    if let (Some(model), Some(state), Some(source)) = parts {
        let mut parts = Decoupled::identity();
        model.step(state, &source.to_core(), &mut parts);
        let mut modulated = Pose::identity();
        modulate(state.pose(), &parts, &Modulation { amount, ..Modulation::default() }, &mut modulated);
        // SAFETY: by the caller's promise.
        if let Some(out) = unsafe { out.as_mut() } {
            out.set(&modulated);
        }
    }
}
