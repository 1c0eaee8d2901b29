//! Features and network 23-100-300-120 with int8 weights.
#![no_std]
#![no_main]

kinesic_image::image!(
    kinesic_image::workloads::mechanics::Network<kinesic_image::workloads::Integers>,
    "network-i8.kin"
);
