//! Which loops the target gets. The compiler does not tell a crate about the DSP extension and Helium, so they are read from
//! the target and from `-C target-cpu`.

use std::env::var;

/// ARMv8-M cores with the DSP extension.
const DSP: [&str; 5] = ["cortex-m33", "cortex-m35p", "cortex-m52", "cortex-m55", "cortex-m85"];

/// Cores with Helium. The compiler makes vectors of the portable f32 loop itself.
const HELIUM: [&str; 3] = ["cortex-m52", "cortex-m55", "cortex-m85"];

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-env-changed=CARGO_ENCODED_RUSTFLAGS");
    let target = var("TARGET").unwrap_or_default();
    if target.starts_with("thumbv6m") {
        println!("cargo::rustc-cfg=kinesic_narrow_multiply");
    }
    soft_float(&target);
    if var("CARGO_FEATURE_ASM").is_err() {
        return;
    }
    let flags = var("CARGO_ENCODED_RUSTFLAGS").unwrap_or_default();
    let cpu =
        flags.split('\x1f').filter_map(|flag| flag.split_once("target-cpu=")).next_back().map_or("", |(_, cpu)| cpu);
    let mainline = target.starts_with("thumbv8m.main");
    let (helium, dsp) =
        (HELIUM.contains(&cpu) && !flags.contains("-mve"), DSP.contains(&cpu) && !flags.contains("-dsp"));
    if mainline && helium && dsp {
        choose("kinesic_tile", "helium");
    } else if target.starts_with("thumbv7em") || mainline && dsp {
        choose("kinesic_tile", "dsp");
    } else if target.starts_with("thumbv6m") {
        choose("kinesic_tile", "thumb1");
    }
    if mainline {
        println!("cargo::rustc-cfg=kinesic_mainline");
    }
    if target.ends_with("eabihf") && (target.starts_with("thumbv7em") || mainline) {
        println!("cargo::rustc-cfg=kinesic_root");
        if !HELIUM.contains(&cpu) {
            println!("cargo::rustc-cfg=kinesic_column_tile");
        }
    }
}

/// Which sums and products stand for the compiler's: none where there is an FPU.
fn soft_float(target: &str) {
    if var("CARGO_FEATURE_SOFT_FLOAT").is_err() {
        return;
    }
    let features = var("CARGO_CFG_TARGET_FEATURE").unwrap_or_default();
    if target.starts_with("thumbv6m") {
        println!("cargo::rustc-cfg=kinesic_soft_float=\"thumb1\"");
    } else if target.starts_with("riscv32") && !features.split(',').any(|feature| feature == "f") {
        println!("cargo::rustc-cfg=kinesic_soft_float=\"riscv\"");
    }
}

/// The name alone too: `cfg(kinesic_tile)` does not hold for a name with a value.
fn choose(name: &str, value: &str) {
    println!("cargo::rustc-cfg={name}");
    println!("cargo::rustc-cfg={name}=\"{value}\"");
}
