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
    // SAFETY: by the caller's promise.
    unsafe { slice(bytes, len) }
}

/// An array of the caller's, if there is one.
///
/// # Safety
/// `array` is null, or valid for reads of `len` elements for as long as the slice lives.
pub unsafe fn slice<'s, T>(array: *const T, len: usize) -> Option<&'s [T]> {
    // SAFETY: by the caller's promise; a slice must not reach half the address space.
    (!array.is_null() && fits::<T>(len)).then(|| unsafe { core::slice::from_raw_parts(array, len) })
}

/// An array of the caller's to write to, if there is one.
///
/// # Safety
/// As [`slice`], for writes, and nothing else refers to it.
pub unsafe fn slice_mut<'s, T>(array: *mut T, len: usize) -> Option<&'s mut [T]> {
    // SAFETY: as above.
    (!array.is_null() && fits::<T>(len)).then(|| unsafe { core::slice::from_raw_parts_mut(array, len) })
}

fn fits<T>(len: usize) -> bool {
    len.checked_mul(size_of::<T>()).is_some_and(|bytes| bytes <= isize::MAX as usize)
}
