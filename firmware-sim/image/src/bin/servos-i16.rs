//! The same with the translator in fixed point.
#![no_std]
#![no_main]

kinesic_image::image!(kinesic_image::workloads::servos::ServosFixed, "servos-i16.kin");
