//! Style translation, 31 joints, trained on recorded clips, one model for the whole body.
#![no_std]
#![no_main]

kinesic_image::image!(kinesic_image::workloads::posed::Recorded, "recorded-body.kin");
