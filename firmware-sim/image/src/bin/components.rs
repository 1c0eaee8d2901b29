//! Style components of a live pose, 23 joints, 30 components.
#![no_std]
#![no_main]

kinesic_image::image!(kinesic_image::workloads::posed::Restyle, "components.kin");
