//! Core links into a program that has neither `std` nor a heap.

use std::path::{Path, PathBuf};
use std::process::Command;

#[test]
fn core_links_without_std() {
    let here = Path::new(env!("CARGO_MANIFEST_DIR")).join("no-std-link");
    let target = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("no-std-link");
    let cargo = std::env::var("CARGO").unwrap_or_else(|_| "cargo".into());
    let built = Command::new(cargo)
        .args(["build", "--release", "--locked", "--manifest-path"])
        .arg(here.join("Cargo.toml"))
        .arg("--target-dir")
        .arg(&target)
        .env_remove("RUSTFLAGS")
        .output()
        .unwrap();
    assert!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));
    let program = target.join("release/no-std-link");
    let bytes = std::fs::read(&program).unwrap();
    for symbol in ["__rust_alloc", "__rust_dealloc", "_ZN3std", "std::io"] {
        let found = bytes.windows(symbol.len()).any(|window| window == symbol.as_bytes());
        assert!(!found, "the program holds {symbol}");
    }
    let ran = Command::new(&program).status().unwrap();
    assert_eq!(ran.code(), Some(0));
}
