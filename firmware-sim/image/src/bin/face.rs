//! One update of a face: 12 clusters of head pose, 10 hidden units.
#![no_std]
#![no_main]

kinesic_image::image!(kinesic_image::workloads::face::Face, "face.kin");
