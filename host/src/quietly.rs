//! Readers of other crates that panic on damaged files.

use std::cell::Cell;
use std::panic::{self, AssertUnwindSafe};
use std::sync::Once;

thread_local! {
    static QUIET: Cell<bool> = const { Cell::new(false) };
}

/// What a reader gives; none where it panics, as mesh-loader and gltf do on files whose indices lead nowhere. Nothing is printed then.
pub fn quietly<T>(read: impl FnOnce() -> T) -> Option<T> {
    static HOOK: Once = Once::new();
    HOOK.call_once(|| {
        let before = panic::take_hook();
        panic::set_hook(Box::new(move |info| {
            if !QUIET.get() {
                before(info);
            }
        }));
    });
    QUIET.set(true);
    // Nothing of what was under way is used afterwards.
    let read = panic::catch_unwind(AssertUnwindSafe(read)).ok();
    QUIET.set(false);
    read
}
