//! Runs `kinesic_fuzz::fbx` on whatever libFuzzer comes up with.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| kinesic_fuzz::fbx(data));
