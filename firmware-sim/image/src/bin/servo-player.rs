//! A frame of the firmware of a servo machine with a player and jerk limits.
#![no_std]
#![no_main]

kinesic_image::image!(kinesic_image::workloads::player::Layers, "servo-player.kin");
