//! Joint limits of a pose, 23 joints of all kinds.
#![no_std]
#![no_main]

kinesic_image::image!(kinesic_image::workloads::posed::Limit, "limit.kin");
