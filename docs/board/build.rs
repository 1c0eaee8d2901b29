//! Tells the linker where the part has its memory.
use std::env::var;
use std::path::PathBuf;

fn main() {
    let architecture = var("CARGO_CFG_TARGET_ARCH").expect("cargo sets it");
    let layout = if architecture == "arm" { "stm32f405.x" } else { "qemu-virt.x" };
    let out = PathBuf::from(var("OUT_DIR").expect("cargo sets it"));
    std::fs::copy(layout, out.join("memory.x")).expect("the layout beside build.rs");
    println!("cargo:rustc-link-search={}", out.display());
    println!("cargo:rustc-link-arg-bins=-Tlink.x");
    println!("cargo:rerun-if-changed={layout}");
}
