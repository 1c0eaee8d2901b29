//! A frame of the firmware of a servo machine: antennas.
#![no_std]
#![no_main]

kinesic_image::image!(kinesic_image::workloads::machine::Antennas, "servo-antennas.kin");
