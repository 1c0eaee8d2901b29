//! Body mechanics, translator, components, emotion, mix and limits, 31 joints, in integers where there is a choice.
#![no_std]
#![no_main]

kinesic_image::image!(kinesic_image::workloads::posed::Whole, "pipeline-int.kin");
