//! The desk robot of `docs/robot.md` on two emulated boards: the page's own commands, in a copy of the repository as a reader has it.
//! What the serial ports say, and how long the pulses at the pins are, is compared with the host's servo numbers.

use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::Stdio;

use kinesic::play::Move;
use kinesic::{LimitState, Limiter, Pipeline, PipelineState, Player, Servos, Translator, TranslatorState};
use kinesic_firmware_sim::build::{self, Folders};
use kinesic_firmware_sim::elf::Image;
use kinesic_firmware_sim::toolchain::{self, Toolchain};
use kinesic_host::pack::PackFile;

#[path = "../../docs/board/examples/desk/calm.rs"]
mod calm;
#[path = "../../docs/board/examples/desk/robot.rs"]
#[allow(dead_code, unreachable_pub, missing_docs, reason = "what the board runs; here its mood and its losses")]
mod robot;

/// Twice the move: the mood goes up and down, frames are lost, the move comes again.
const FRAMES: usize = 800;
const PAGE: &str = "docs/robot.md";
const HEADER: &str = "frame,pan,tilt,left_antenna,right_antenna";

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The host's numbers: core through the library, the pack's metadata by the host.
fn expected() -> Vec<String> {
    let desk = repository().join("docs/board/examples/desk");
    let file = PackFile::read(&desk.join("lively.kin")).unwrap();
    let pack = file.pack().unwrap();
    let pipeline = Pipeline::<(Translator<2, 256>, Limiter<2>), 2>::load(&pack).unwrap();
    let servos = Servos::load(&pack).unwrap();
    let mut state = PipelineState::<(TranslatorState<2, 256>, LimitState<2>), 2>::new();
    pipeline.start_coordinates(&mut state, &[0.0; 4]);
    let mut player = Player::<4, 2>::new([0.0; 4]);
    player.start([0.0; 4], 50);
    player.layers[0].play(Move::new(&calm::FRAMES).unwrap().looped(), 50);
    let mut out = [0.0; 4];
    let mut numbers = Vec::new();
    for frame in 0..FRAMES {
        let angles = *player.step();
        state.engine.0.controls.strength = robot::mood(frame as u32);
        let came = (!robot::lost(frame as u32)).then_some(&angles[..]);
        pipeline.step_coordinates(&mut state, came, &mut out);
        let row: Vec<String> = servos.commands(&out).map(|command| command.value.to_string()).collect();
        numbers.push(row.join(","));
    }
    assert!(state.report().faulty > 60 && state.engine.1.report().clamped_frames > 0, "{:?}", state.report());
    numbers
}

/// The page's commands under "On the board", in order.
fn commands() -> Vec<String> {
    let page = std::fs::read_to_string(repository().join(PAGE)).unwrap();
    let (_, section) = page.split_once("\n## On the board\n").expect("the section");
    let section = section.split("\n## ").next().unwrap();
    let blocks = section.split("\n```console\n").skip(1).map(|rest| rest.split("\n```").next().unwrap());
    blocks.flat_map(|block| block.replace("\\\n", " ").lines().map(str::to_owned).collect::<Vec<_>>()).collect()
}

/// A copy of the project beside links to what it needs. It stays in one place, so that what was built stays built.
fn copy() -> PathBuf {
    let folder = Folders::new().target("desk");
    // Where tests/board.rs builds the same crates.
    let built = Folders::new().target("m4f").join("board");
    _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(folder.join("docs")).unwrap();
    std::fs::create_dir_all(&built).unwrap();
    for entry in std::fs::read_dir(repository()).unwrap() {
        let entry = entry.unwrap();
        if !["docs", "target", ".git"].iter().any(|name| entry.file_name() == *name) {
            std::os::unix::fs::symlink(entry.path(), folder.join(entry.file_name())).unwrap();
        }
    }
    files(&repository().join("docs/board"), &folder.join("docs/board"));
    std::os::unix::fs::symlink(built, folder.join("docs/board/target")).unwrap();
    folder
}

fn files(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).unwrap();
    for entry in std::fs::read_dir(from).unwrap().map(Result::unwrap) {
        let to = to.join(entry.file_name());
        match entry.file_type().unwrap().is_dir() {
            true if ["target", "node_modules"].iter().any(|name| entry.file_name() == *name) => {}
            true => files(&entry.path(), &to),
            false => _ = std::fs::copy(entry.path(), to).unwrap(),
        }
    }
}

/// What a command prints, all of it; of an emulator that never ends, so many lines.
fn output(line: &str, folder: &Path, found: &Toolchain) -> Vec<String> {
    let mut child = build::shell(line, folder, found).stdin(Stdio::null()).stdout(Stdio::piped()).spawn().unwrap();
    let lines = BufReader::new(child.stdout.take().unwrap()).lines().map(|line| line.unwrap().trim_end().to_owned());
    if line.starts_with("qemu-") {
        let lines = lines.take(FRAMES + 1).collect();
        child.kill().unwrap();
        child.wait().unwrap();
        return lines;
    }
    let lines = lines.collect();
    let status = child.wait().unwrap();
    assert!(status.success(), "{line}: {status}. What it needs is installed by firmware-sim/setup.sh");
    lines
}

/// All that is expected is there, in order; the first line that is not is named.
fn same(what: &str, found: &[String], expected: &[String]) {
    for (at, expected) in expected.iter().enumerate() {
        assert_eq!(found.get(at), Some(expected), "line {at} of {what}");
    }
}

#[test]
#[ignore = "needs QEMU, Node.js and a compiler for the targets: ./ci.sh firmware runs it"]
fn a_robot_s_servo_numbers_are_the_host_s_on_a_cortex_m0_plus_and_on_a_cortex_m4f() {
    let expected = expected();
    let mut told = vec![HEADER.to_owned()];
    told.extend(expected.iter().enumerate().map(|(frame, row)| format!("{frame},{row}")));
    let mut folder = copy();
    let mut compared = 0;
    for line in commands() {
        // The compiler that is found here is another one; links are no clone.
        if line.starts_with("rustup ") {
            continue;
        }
        if let Some(inner) = line.strip_prefix("cd ") {
            folder = folder.join(inner);
            continue;
        }
        let triple = if line.contains("thumbv6m") { "thumbv6m-none-eabi" } else { "thumbv7em-none-eabihf" };
        let printed = output(&line, &folder, &toolchain::find(triple).unwrap());
        if let Some(program) = line.split(' ').find(|word| word.starts_with("target/")) {
            let image = Image::read(&folder.join(program)).unwrap();
            println!("{triple}: flash {} B with the pack and the move, static RAM {} B", image.flash, image.ram);
        }
        if ["node ", "qemu-"].iter().any(|start| line.starts_with(start)) {
            same(&line, &printed, &told);
            compared += 1;
        }
    }
    assert_eq!(compared, 2, "one RP2040, one STM32F405");
    // Pulses of PWM at the RP2040's pins, measured from edge to edge. The first is that of power-on.
    let pulses = std::fs::read_to_string(folder.join("pulses.csv")).unwrap();
    let widths: Vec<String> = pulses.lines().skip(2).map(|row| row.replace(".000", "")).collect();
    same("pulses at the pins", &widths, &expected);
}
