//! The same with the translator in fixed point.
#![no_std]
#![no_main]

kinesic_image::image!(kinesic_image::workloads::posed::StyledFixed, "styled-i16.kin");
