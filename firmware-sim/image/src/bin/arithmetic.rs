//! Sums, differences, products and quotients that are hard to round.
#![no_std]
#![no_main]

kinesic_image::image!(kinesic_image::workloads::arithmetic::Arithmetic, "modal.kin");
