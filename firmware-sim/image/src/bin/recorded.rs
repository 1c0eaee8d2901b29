//! Style translation, 31 joints, trained on recorded clips, one model per joint.
#![no_std]
#![no_main]

kinesic_image::image!(kinesic_image::workloads::posed::Recorded, "recorded.kin");
