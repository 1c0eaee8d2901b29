//! A plugin for QEMU's system emulation (plugin API 1: QEMU 6.0 to 8.2) that counts, between two addresses, what a frame
//! executes: every instruction by its address, every taken branch, and the sum of each frame.
//!
//! Arguments: `out=FILE,begin=ADDRESS,end=ADDRESS,code=thumb|riscv`. The instruction at `begin` opens a frame, the one at `end` closes it;
//! neither is counted. Output, all numbers decimal unless said:
//! ```text
//! frames 3
//! 1107 1107 1107
//! instructions address(hex) bytes(hex) executed taken executed-in-longest-frame taken-in-longest-frame
//! 8000420 b510 3 0 1 0
//! ```
//! "Longest" is the first frame with the most instructions.
//!
//! Counting itself is done by code that QEMU emits inline (`INLINE_ADD_U64`), so it costs almost nothing.

mod api;
mod code;
mod counts;

use std::ffi::{CStr, c_char, c_int, c_uint, c_void};
use std::sync::OnceLock;

use code::Code;
use counts::{Block, Counts};

/// The plugin API that these declarations follow; QEMU refuses to load the plugin if it no longer speaks it.
#[unsafe(no_mangle)]
pub static qemu_plugin_version: c_int = 1;

static COUNTS: OnceLock<Counts> = OnceLock::new();

/// The counters, which exist before any callback is registered.
fn counts() -> &'static Counts {
    COUNTS.get().expect("installed before any callback")
}

extern "C" fn on_begin(_: c_uint, _: *mut c_void) {
    counts().begin();
}

extern "C" fn on_end(_: c_uint, _: *mut c_void) {
    counts().end();
}

extern "C" fn on_block(_: c_uint, block: *mut c_void) {
    // SAFETY: registered below with a leaked `Block`.
    counts().enter(unsafe { &*block.cast_const().cast::<Block>() });
}

extern "C" fn on_exit(_: api::PluginId, _: *mut c_void) {
    if let Err(error) = counts().write() {
        eprintln!("kinesic-qemu-plugin: {error}");
    }
}

extern "C" fn on_translate(_: api::PluginId, block: *mut c_void) {
    let counts = counts();
    let mut whole: Option<Block> = None;
    for instruction in api::instructions(block) {
        let address = instruction.address();
        let bytes = counts.code.trim(instruction.bytes());
        let record = counts.record(address, bytes);
        if address == counts.begin {
            instruction.call(on_begin);
        } else if address == counts.end {
            instruction.call(on_end);
        } else {
            instruction.count(&record.executed);
            instruction.count(&counts.total);
        }
        let start = whole.map_or(address, |block| block.start);
        whole = Some(Block { start, next: address + bytes.len() as u64, last: record });
    }
    if let Some(whole) = whole {
        // Leaked: QEMU keeps the pointer for as long as the translation lives, and never says when it dies.
        api::on_block_start(block, on_block, Box::leak(Box::new(whole)));
    }
}

fn option(text: &str, name: &str) -> Option<String> {
    text.strip_prefix(name)?.strip_prefix('=').map(str::to_owned)
}

fn address(text: &str) -> Option<u64> {
    u64::from_str_radix(text.trim_start_matches("0x"), 16).ok()
}

/// QEMU's entry point.
///
/// # Safety
/// Called by QEMU alone, with `argc` C strings at `argv`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn qemu_plugin_install(
    id: api::PluginId,
    _info: *const c_void,
    argc: c_int,
    argv: *const *const c_char,
) -> c_int {
    let (mut out, mut begin, mut end, mut code) = (None, None, None, None);
    for index in 0..usize::try_from(argc).unwrap_or(0) {
        // SAFETY: QEMU passes `argc` NUL-terminated strings.
        let text = unsafe { CStr::from_ptr(*argv.add(index)) }.to_string_lossy();
        out = out.or_else(|| option(&text, "out"));
        begin = begin.or_else(|| option(&text, "begin").as_deref().and_then(address));
        end = end.or_else(|| option(&text, "end").as_deref().and_then(address));
        code = code.or_else(|| option(&text, "code").as_deref().and_then(Code::named));
    }
    let (Some(out), Some(begin), Some(end), Some(code)) = (out, begin, end, code) else {
        eprintln!("kinesic-qemu-plugin: needs out=FILE,begin=HEX,end=HEX,code=thumb|riscv");
        return 1;
    };
    if COUNTS.set(Counts::new(out, begin, end, code)).is_err() {
        return 1;
    }
    api::on_translation(id, on_translate);
    api::on_exit(id, on_exit);
    0
}
