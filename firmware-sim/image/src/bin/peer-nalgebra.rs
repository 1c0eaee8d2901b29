//! A peer: the dense step of a model of order 40 with nalgebra.
#![no_std]
#![no_main]

kinesic_image::image!(kinesic_image::workloads::modal::Nalgebra, "modal.kin");
