//! Matrix x vector, 120 x 300, int8 weights.
#![no_std]
#![no_main]

kinesic_image::image!(kinesic_image::workloads::kernel::I8, "kernel-i8.kin");
