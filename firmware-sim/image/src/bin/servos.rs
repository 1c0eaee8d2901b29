//! Style translation and limits of eight servos, angles in and angles out.
#![no_std]
#![no_main]

kinesic_image::image!(kinesic_image::workloads::servos::ServosFloat, "servos.kin");
