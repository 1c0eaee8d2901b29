//! Style translation by one model of order 40 and joint limits, 19 joints, pose in and pose out, then feet that are held.
#![no_std]
#![no_main]

kinesic_image::image!(kinesic_image::workloads::held::StyledFeet, "styled.kin");
