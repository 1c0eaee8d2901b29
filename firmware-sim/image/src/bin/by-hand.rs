//! What `styled` does, without `Pipeline`: for the comparison of sizes.
#![no_std]
#![no_main]

kinesic_image::image!(kinesic_image::workloads::by_hand::ByHand, "styled.kin");
