//! One model of order 40, modal, fixed point.
#![no_std]
#![no_main]

kinesic_image::image!(kinesic_image::workloads::modal::ModalFixed, "modal.kin");
