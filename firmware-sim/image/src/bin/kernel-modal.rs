//! One model of order 40, modal, f32.
#![no_std]
#![no_main]

kinesic_image::image!(kinesic_image::workloads::modal::Modal, "modal.kin");
