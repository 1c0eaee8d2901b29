//! Which loop the target gets. The compiler does not tell a crate about the DSP extension, so it is read from the target.

use std::env::var;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    if var("CARGO_FEATURE_ASM").is_err() {
        return;
    }
    // ARMv8-M has the extension as an option that the assembler must be told about: there the portable loop runs.
    match var("TARGET").unwrap_or_default() {
        target if target.starts_with("thumbv7em") => choose("dsp"),
        target if target.starts_with("thumbv6m") => choose("thumb1"),
        _ => {}
    }
}

/// The name alone too: `cfg(kinesic_tile)` does not hold for a name with a value.
fn choose(tile: &str) {
    println!("cargo::rustc-cfg=kinesic_tile");
    println!("cargo::rustc-cfg=kinesic_tile=\"{tile}\"");
}
