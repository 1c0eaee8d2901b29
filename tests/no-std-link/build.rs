//! Start-up code and `memcpy` come from the C library; Rust's `std` is not linked.
fn main() {
    println!("cargo:rustc-link-arg-bins=-lc");
}
