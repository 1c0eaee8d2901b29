//! Style translation by one model of order 40 and joint limits, 19 joints, pose in and pose out.
#![no_std]
#![no_main]

kinesic_image::image!(kinesic_image::workloads::posed::Styled, "styled.kin");
