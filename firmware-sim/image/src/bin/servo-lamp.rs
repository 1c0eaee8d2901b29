//! A frame of the firmware of a servo machine: lamp.
#![no_std]
#![no_main]

kinesic_image::image!(kinesic_image::workloads::machine::Lamp, "servo-lamp.kin");
