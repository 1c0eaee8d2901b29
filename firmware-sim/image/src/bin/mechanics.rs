//! Body mechanics, 31 joints: features, network and decoupling.
#![no_std]
#![no_main]

kinesic_image::image!(
    kinesic_image::workloads::mechanics::Mechanics<kinesic_image::workloads::Floats>,
    "mechanics.kin"
);
