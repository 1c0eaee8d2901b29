//! Which loop the target gets. The compiler does not tell a crate about the DSP extension, so it is read from the target.

use std::env::var;

/// ARMv8-M cores that always have the DSP extension, or have it in every part that a user can buy.
const WITH_DSP: [&str; 4] = ["cortex-m33", "cortex-m35p", "cortex-m55", "cortex-m85"];

fn main() {
    println!("cargo::rerun-if-env-changed=CARGO_ENCODED_RUSTFLAGS");
    if var("CARGO_FEATURE_ASM").is_err() {
        return;
    }
    let target = var("TARGET").unwrap_or_default();
    let flags = var("CARGO_ENCODED_RUSTFLAGS").unwrap_or_default();
    let cpu = |name: &&str| {
        flags.contains(&format!("target-cpu={name}")) && !flags.contains("nodsp") && !flags.contains("-dsp")
    };
    if target.starts_with("thumbv7em")
<<<<<<< HEAD
        || (target.starts_with("thumbv8m.main") && WITH_DSP.iter().any(cpu))
=======
        || (target.starts_with("thumbv8m.main") && WITH_DSP.iter().any(|name| cpu(&name)))
>>>>>>> 1faec6909a5f937f1beef925f946774fda6a3194
    {
        choose("dsp");
    } else if target.starts_with("thumbv6m") {
        choose("thumb1");
    }
}

/// The name alone too: `cfg(kinesic_tile)` does not hold for a name with a value.
fn choose(tile: &str) {
    println!("cargo::rustc-cfg=kinesic_tile");
    println!("cargo::rustc-cfg=kinesic_tile=\"{tile}\"");
}
