//! A peer: the network 23-100-300-120 with embedded-nn.
#![no_std]
#![no_main]

kinesic_image::image!(kinesic_image::workloads::peer::EmbeddedNn, "peer-embedded-nn.kin");
