//! Tells the linker where the part has its memory.
use std::env::var;
use std::path::PathBuf;

fn main() {
    let layout = match &*var("TARGET").expect("cargo sets it") {
        "thumbv6m-none-eabi" => "rp2040.x",
        target if target.starts_with("riscv32") => "qemu-virt.x",
        _ => "stm32f405.x",
    };
    let out = PathBuf::from(var("OUT_DIR").expect("cargo sets it"));
    std::fs::copy(layout, out.join("memory.x")).expect("the layout beside build.rs");
    println!("cargo:rustc-link-search={}", out.display());
    println!("cargo:rustc-link-arg=-Tlink.x");
    println!("cargo:rerun-if-changed={layout}");
}
