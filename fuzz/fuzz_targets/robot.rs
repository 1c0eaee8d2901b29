//! Runs `kinesic_fuzz::robot` on whatever libFuzzer comes up with.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| kinesic_fuzz::robot(data));
