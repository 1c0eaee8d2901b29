//! Features and network 23-100-300-120 in f32.
#![no_std]
#![no_main]

kinesic_image::image!(kinesic_image::workloads::mechanics::Network<kinesic_image::workloads::Floats>, "network.kin");
