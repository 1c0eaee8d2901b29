//! A frame of the firmware of a servo machine: head.
#![no_std]
#![no_main]

kinesic_image::image!(kinesic_image::workloads::machine::Head, "servo-head.kin");
