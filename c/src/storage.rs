//! Rust values in the caller's memory.

use core::mem::{align_of, size_of};

/// Puts `value` into storage of the caller's.
///
/// # Safety
/// `storage` is null, or valid for writes and aligned as its type.
pub unsafe fn put<S, T: Copy>(storage: *mut S, value: T) -> bool {
    const { assert!(size_of::<T>() <= size_of::<S>() && align_of::<T>() <= align_of::<S>(), "the storage is too small") };
    if storage.is_null() {
        return false;
    }
    // SAFETY: by the caller's promise and the assertion above.
    unsafe { storage.cast::<T>().write(value) };
    true
}

/// The value that [`put`] left there.
///
/// # Safety
/// `storage` is null, or [`put`] succeeded on it with the same type.
pub unsafe fn get<'s, S, T: Copy>(storage: *const S) -> Option<&'s T> {
    // SAFETY: by the caller's promise.
    unsafe { storage.cast::<T>().as_ref() }
}

/// The value that [`put`] left there, to be changed.
///
/// # Safety
/// As [`get`], and nothing else refers to the storage.
pub unsafe fn get_mut<'s, S, T: Copy>(storage: *mut S) -> Option<&'s mut T> {
    // SAFETY: by the caller's promise.
    unsafe { storage.cast::<T>().as_mut() }
}

/// The pack's bytes, if there are any.
///
/// # Safety
/// `bytes` is null, or valid for reads of `len` bytes for as long as the model lives.
pub unsafe fn bytes<'s>(bytes: *const u8, len: usize) -> Option<&'s [u8]> {
    // SAFETY: by the caller's promise; a slice must not reach half the address space.
    (!bytes.is_null() && len <= isize::MAX as usize).then(|| unsafe { core::slice::from_raw_parts(bytes, len) })
}
