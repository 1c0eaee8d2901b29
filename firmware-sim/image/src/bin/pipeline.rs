//! Body mechanics, translator, components, emotion, mix and limits, 31 joints.
#![no_std]
#![no_main]

kinesic_image::image!(kinesic_image::workloads::posed::Whole, "pipeline.kin");
