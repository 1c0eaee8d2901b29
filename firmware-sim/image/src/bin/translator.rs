//! Style translation, 25 joints, one model of order 40 per joint.
#![no_std]
#![no_main]

kinesic_image::image!(kinesic_image::workloads::posed::PerJoint, "translator.kin");
