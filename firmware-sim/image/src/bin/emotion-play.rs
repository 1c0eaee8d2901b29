//! One frame of playback: 19 joints, 13 keyframes.
#![no_std]
#![no_main]

kinesic_image::image!(kinesic_image::workloads::emotion::Play, "emotion.kin");
