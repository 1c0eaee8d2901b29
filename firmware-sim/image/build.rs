//! Hands the linker the runtime crate's script; the layout (`memory.x`) is in the folder that the host tool names.
use std::env::var;

fn main() {
    println!("cargo:rerun-if-env-changed=KINESIC_LAYOUT");
    println!("cargo:rerun-if-env-changed=KINESIC_PACKS");
    let layout =
        var("KINESIC_LAYOUT").expect("KINESIC_LAYOUT: build images with `kinesic-firmware-sim check`, which sets it");
    println!("cargo:rustc-link-search={layout}");
    println!("cargo:rerun-if-changed={layout}/memory.x");
    println!("cargo:rustc-link-arg-bins=-Tlink.x");
}
