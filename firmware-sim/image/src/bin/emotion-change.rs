//! A change of strength: 19 joints, 13 keyframes, 40 components, 10 hidden units.
#![no_std]
#![no_main]

kinesic_image::image!(kinesic_image::workloads::emotion::Change, "emotion.kin");
