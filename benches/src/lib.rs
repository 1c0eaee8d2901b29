//! Host benches of the device's engines; see `benches/`.
