//! Runs kinesic on simulated microcontrollers and checks that every frame fits.
//!
//! A run goes through the rooms in this order:
//!
//! | room | does |
//! |---|---|
//! | [`data`] | reads `targets.toml`, `cycles.toml` and `budgets.toml` |
//! | [`synthetic`], [`workload`] | makes packs and input frames, runs the same frames on the host |
//! | [`toolchain`] | finds a compiler that builds for the target, or says what to install |
//! | [`build`] | builds the images and the emulator's plugin |
//! | [`elf`] | sizes, symbols and what must not be linked |
//! | [`emulator`] | runs an image in QEMU |
//! | [`profile`] | what the plugin counted |
//! | [`isa`], [`price`] | instructions to modelled cycles |
//! | [`check`], [`report`] | measured against allowed; the table and the JSON |
//! | [`again`] | a sample of an earlier check, measured again |
//! | [`browser`] | runs a page in headless Chromium |
//! | [`same`] | host against targets on recorded clips |
//! | [`soak`] | host against targets over very many frames |

pub mod again;
pub mod browser;
pub mod build;
pub mod check;
pub mod data;
pub mod elf;
pub mod emulator;
pub mod isa;
pub mod price;
pub mod profile;
pub mod report;
pub mod same;
pub mod soak;
pub mod synthetic;
pub mod toolchain;
pub mod workload;
