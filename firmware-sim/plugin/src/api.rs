//! The dozen entry points of QEMU's plugin API 1, declared here so that no QEMU header is needed, behind safe calls.
//! The ABI is that of `qemu-plugin.h` of QEMU 7.2; a block or instruction handle is valid during its translation callback.

use std::cell::UnsafeCell;
use std::ffi::{c_int, c_uint, c_void};

/// QEMU's name for a loaded plugin.
pub type PluginId = u64;
type VcpuCallback = extern "C" fn(c_uint, *mut c_void);
type PluginCallback = extern "C" fn(PluginId, *mut c_void);

/// The callback touches no guest register (`QEMU_PLUGIN_CB_NO_REGS`).
const NO_REGISTERS: c_int = 0;
/// `QEMU_PLUGIN_INLINE_ADD_U64`.
const INLINE_ADD: c_int = 0;

unsafe extern "C" {
    fn qemu_plugin_register_vcpu_tb_trans_cb(id: PluginId, call: PluginCallback);
    fn qemu_plugin_register_vcpu_tb_exec_cb(block: *mut c_void, call: VcpuCallback, flags: c_int, data: *mut c_void);
    fn qemu_plugin_register_vcpu_insn_exec_cb(insn: *mut c_void, call: VcpuCallback, flags: c_int, data: *mut c_void);
    fn qemu_plugin_register_vcpu_insn_exec_inline(insn: *mut c_void, operation: c_int, word: *mut c_void, add: u64);
    fn qemu_plugin_register_atexit_cb(id: PluginId, call: PluginCallback, data: *mut c_void);
    fn qemu_plugin_tb_n_insns(block: *const c_void) -> usize;
    fn qemu_plugin_tb_get_insn(block: *const c_void, index: usize) -> *mut c_void;
    fn qemu_plugin_insn_vaddr(insn: *const c_void) -> u64;
    fn qemu_plugin_insn_size(insn: *const c_void) -> usize;
    fn qemu_plugin_insn_data(insn: *const c_void) -> *const u8;
}

/// A 64-bit word that emitted code adds to.
#[derive(Default)]
pub struct Counter(UnsafeCell<u64>);

// SAFETY: every machine simulated here has one core, QEMU runs its code and all callbacks on that core's thread, and the
// exit callback runs after that thread stopped.
unsafe impl Sync for Counter {}

impl Counter {
    /// What was counted so far.
    pub fn get(&self) -> u64 {
        // SAFETY: see `Sync`: emitted code does not run during a callback.
        unsafe { self.0.get().read() }
    }
}

/// One instruction of a block that is being translated.
pub struct Instruction(*mut c_void);

/// The instructions of a block in order.
pub fn instructions(block: *mut c_void) -> impl Iterator<Item = Instruction> {
    // SAFETY: the handle comes from the running translation callback; so do the calls below.
    let count = unsafe { qemu_plugin_tb_n_insns(block) };
    (0..count).map(move |index| Instruction(unsafe { qemu_plugin_tb_get_insn(block, index) }))
}

impl Instruction {
    /// Where it is.
    pub fn address(&self) -> u64 {
        // SAFETY: valid during the translation callback, for this and the next functions.
        unsafe { qemu_plugin_insn_vaddr(self.0) }
    }

    /// 2 or 4 bytes.
    pub fn size(&self) -> usize {
        unsafe { qemu_plugin_insn_size(self.0) }
    }

    /// Its bytes in memory order.
    pub fn bytes(&self) -> &[u8] {
        unsafe { std::slice::from_raw_parts(qemu_plugin_insn_data(self.0), self.size()) }
    }

    /// Adds one to `counter` at every execution.
    pub fn count(&self, counter: &'static Counter) {
        unsafe { qemu_plugin_register_vcpu_insn_exec_inline(self.0, INLINE_ADD, counter.0.get().cast(), 1) }
    }

    /// Calls `call` before every execution.
    pub fn call(&self, call: VcpuCallback) {
        unsafe { qemu_plugin_register_vcpu_insn_exec_cb(self.0, call, NO_REGISTERS, std::ptr::null_mut()) }
    }
}

/// Calls `call` with `data` whenever the block starts.
pub fn on_block_start<T>(block: *mut c_void, call: VcpuCallback, data: &'static T) {
    // SAFETY: during the translation callback; `data` lives for ever.
    unsafe {
        qemu_plugin_register_vcpu_tb_exec_cb(block, call, NO_REGISTERS, std::ptr::from_ref(data).cast_mut().cast())
    }
}

/// Calls `call` for every block that QEMU translates.
pub fn on_translation(id: PluginId, call: PluginCallback) {
    // SAFETY: called from `qemu_plugin_install`.
    unsafe { qemu_plugin_register_vcpu_tb_trans_cb(id, call) }
}

/// Calls `call` when QEMU ends.
pub fn on_exit(id: PluginId, call: PluginCallback) {
    // SAFETY: called from `qemu_plugin_install`.
    unsafe { qemu_plugin_register_atexit_cb(id, call, std::ptr::null_mut()) }
}
