//! Builds and runs an image of `firmware-sim/image` that is no workload.
#![allow(dead_code, reason = "each test file uses a part")]

use std::path::PathBuf;

use kinesic_firmware_sim::build::{self, Folders};
use kinesic_firmware_sim::data::{Data, Target};
use kinesic_firmware_sim::elf::Image;
use kinesic_firmware_sim::emulator::{self, Run, RunError};
use kinesic_firmware_sim::toolchain;
use kinesic_firmware_sim::workload::Prepared;
use kinesic_workloads::Frames;

pub struct Bench {
    pub data: Data,
    folders: Folders,
    plugin: PathBuf,
}

impl Bench {
    pub fn new() -> Self {
        let folders = Folders::new();
        build::write(&folders.packs().join("empty.bin"), &[]).unwrap();
        let plugin = build::plugin(&folders).unwrap();
        Self { data: Data::read(None).unwrap(), folders, plugin }
    }

    /// Puts the pack of a workload where its image includes it from.
    pub fn pack(&self, prepared: &Prepared) {
        build::write(&self.folders.packs().join(prepared.pack_name), &prepared.pack).unwrap();
    }

    pub fn target(&self, name: &str) -> &Target {
        &self.data.targets[name]
    }

    pub fn build(&self, target: &str, binary: &str) -> Image {
        let found = toolchain::find(&self.target(target).triple).unwrap();
        let folder = build::images(&self.folders, target, self.target(target), &found, &[binary]).unwrap();
        Image::read(&folder.join(binary)).unwrap()
    }

    /// Runs an image over empty frames.
    pub fn run(&self, target: &str, binary: &str, image: &Image, frames: u32) -> Result<Run, RunError> {
        let mut input: Vec<u8> = Frames::header(frames, 4, 1).iter().flat_map(|word| word.to_le_bytes()).collect();
        input.resize(input.len() + 4 * frames as usize, 0);
        emulator::run(self.target(target), image, Some(&self.plugin), &input, &self.folders.run(target, binary))
    }
}
