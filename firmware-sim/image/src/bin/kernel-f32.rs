//! Matrix x vector, 120 x 300, f32.
#![no_std]
#![no_main]

kinesic_image::image!(kinesic_image::workloads::kernel::F32, "kernel-f32.kin");
