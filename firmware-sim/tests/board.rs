//! The project that users copy (`docs/board`) builds and runs as it stands.

use std::path::Path;
use std::process::Command;

use kinesic::{Pipeline, PipelineState, Pose, Translator, TranslatorState};
use kinesic_firmware_sim::build::{self, Folders, Program};
use kinesic_firmware_sim::data::Data;
use kinesic_firmware_sim::toolchain;
use kinesic_host::pack::PackFile;

#[path = "../../docs/board/src/motion.rs"]
mod motion;

/// What the board must print: the same frames through core on this machine.
fn expected() -> String {
    let file = PackFile::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../models/weary.kin")).unwrap();
    let pack = file.pack().unwrap();
    let pipeline = Pipeline::<Translator<20, 60>, 20>::load(&pack).unwrap();
    let mut state = PipelineState::<TranslatorState<20, 60>, 20>::new();
    state.engine.controls.strength = 0.8;
    let mut styled = Pose::identity();
    let mut lines = String::new();
    for frame in 0..motion::FRAMES {
        pipeline.step(&mut state, motion::read_pose(frame).as_ref(), &mut styled);
        if frame % 25 == 24 {
            lines += &format!("frame {frame}: the left arm is turned by {} milliradians\n", motion::arm(&styled));
        }
    }
    lines += &format!("{} of {} frames were held\n", state.report().faulty, state.report().frames);
    lines
}

#[test]
#[ignore = "needs QEMU and a compiler for the targets: ./ci.sh firmware runs it"]
fn the_board_prints_what_the_host_computes() {
    let data = Data::read(None).unwrap();
    let expected = expected();
    assert_eq!(expected.lines().count(), 8, "{expected}");
    assert!(expected.ends_with("4 of 180 frames were held\n"), "{expected}");
    // Where the layouts of the project have their memory: QEMU's only STM32F405 and its generic RISC-V board.
    for (name, machine) in [("m4f", "netduinoplus2"), ("rv32imc", "virt")] {
        let target = &data.targets[name];
        let found = toolchain::find(&target.triple).unwrap();
        let image = build::board(&Folders::new(), name, target, &found, Program::Bin("kinesic-board"))
            .unwrap_or_else(|error| panic!("{error}"));
        let run = Command::new(&target.emulator)
            .args(["-machine", machine, "-nographic", "-monitor", "none", "-serial", "none", "-bios", "none"])
            .args(["-semihosting-config", "enable=on,target=native", "-kernel"])
            .arg(&image)
            .output()
            .unwrap();
        let printed = String::from_utf8_lossy(&run.stdout);
        assert_eq!(printed, expected, "{name}: {}", String::from_utf8_lossy(&run.stderr));
        assert!(run.status.success(), "{name}: {}", run.status);
    }
}
