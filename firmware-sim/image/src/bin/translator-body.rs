//! Style translation, 25 joints, one model of order 40 for the whole body.
#![no_std]
#![no_main]

kinesic_image::image!(kinesic_image::workloads::posed::WholeBody, "translator-body.kin");
