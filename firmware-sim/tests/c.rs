//! The C interface: its header is that of the crate, and its example computes the bits that Rust computes.

use std::path::{Path, PathBuf};
use std::process::Command;

use kinesic::nalgebra::{Quaternion, UnitQuaternion, Vector3};
use kinesic::{Pipeline, PipelineState, Pose, Translator, TranslatorState};
use kinesic_firmware_sim::build::{self, Folders};
use kinesic_firmware_sim::data::Data;
use kinesic_firmware_sim::toolchain;
use kinesic_host::pack::PackFile;

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// `KINESIC_HEADER=write` writes it: `./ci.sh header`.
#[test]
fn the_header_is_that_of_the_crate() {
    let folder = repository().join("c");
    let path = folder.join("include/kinesic.h");
    let config = cbindgen::Config::from_file(folder.join("cbindgen.toml")).unwrap();
    let mut made = Vec::new();
    cbindgen::Builder::new().with_config(config).with_crate(&folder).generate().unwrap().write(&mut made);
    let made = String::from_utf8(made).unwrap();
    if std::env::var("KINESIC_HEADER").as_deref() == Ok("write") {
        std::fs::write(&path, &made).unwrap();
    }
    let kept = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(kept == made, "{} is not what c/src says: run ./ci.sh header", path.display());
}

/// The example's pose of a frame, operation for operation.
fn read_pose(frame: u32) -> Pose<32> {
    let phase = (frame % 60) as f32 / 60.0;
    let swing = if phase < 0.5 { 4.0 * phase - 1.0 } else { 3.0 - 4.0 * phase };
    let mut pose = Pose::identity();
    pose.root = Vector3::new(0.0, 0.95, frame as f32 / 60.0);
    for (joint, size) in [(1, -0.2), (5, 0.2), (13, 0.2), (16, -0.2)] {
        let half: f32 = size * swing;
        pose.rotations[joint] =
            UnitQuaternion::new_unchecked(Quaternion::new((1.0 - half * half).sqrt(), half, 0.0, 0.0));
    }
    pose
}

/// What the example must print: the same frames through core on this machine.
fn expected() -> String {
    let file = PackFile::read(&repository().join("models/weary.kin")).unwrap();
    let pack = file.pack().unwrap();
    let pipeline = Pipeline::<Translator<33, 1280>, 33>::load(&pack).unwrap();
    let mut state = PipelineState::<TranslatorState<33, 1280>, 33>::new();
    let controls = &mut state.engine.controls;
    controls.strength = 0.8;
    pipeline.rig().weigh(12, 0.5, &mut controls.mask);
    let controls = *controls;
    pipeline.start(&mut state, &read_pose(0));
    assert_eq!(state.engine.controls, controls);
    let mut styled = Pose::identity();
    let mut lines = String::new();
    for frame in 0..180 {
        let mut source = read_pose(frame);
        if frame == 89 {
            source.rotations[5] = UnitQuaternion::new_unchecked(Quaternion::new(f32::NAN, 0.0, 0.0, 0.0));
        }
        let came = (!(118..122).contains(&frame)).then_some(&source);
        pipeline.step(&mut state, came, &mut styled);
        if frame % 30 == 29 {
            let rotations = styled.rotations.iter().take(19).flat_map(|q| q.coords.iter());
            let words = styled.root.iter().chain(rotations).map(|x| x.to_bits());
            let hash = words.fold(2_166_136_261u32, |hash, word| (hash ^ word).wrapping_mul(16_777_619));
            lines += &format!("frame {frame:03}: {hash:08x}\n");
        }
    }
    assert_eq!(state.report().faulty, 5);
    lines
}

#[test]
#[ignore = "needs QEMU and compilers for the targets: ./ci.sh firmware runs it"]
fn the_c_example_computes_what_rust_computes() {
    let target = &Data::read(None).unwrap().targets["m4f"];
    let folders = Folders::new();
    let library = build::c_library(&folders, "m4f", target, &toolchain::find(&target.triple).unwrap())
        .unwrap_or_else(|error| panic!("{error}"));
    let example = repository().join("c/example");
    let image = folders.target("m4f").join("c/example.elf");
    let pack = repository().join("models/weary.kin").canonicalize().unwrap();
    let compiled = Command::new("arm-none-eabi-gcc")
        .args("-O2 -Wall -Wextra -Werror -ffreestanding -nostdlib -ffp-contract=off -fno-math-errno".split(' '))
        // Hashing the words of a pose reads floats as integers.
        .args("-fno-strict-aliasing -mcpu=cortex-m4 -mthumb -mfpu=fpv4-sp-d16 -mfloat-abi=hard".split(' '))
        .arg(format!("-DPACK=\"{}\"", pack.display()))
        .arg("-I")
        .arg(repository().join("c/include"))
        .args(["main.c", "startup.c", "pack.S"].map(|file| example.join(file)))
        .arg("-T")
        .arg(example.join("m4f.ld"))
        .arg(&library)
        .arg("-lgcc")
        .arg("-o")
        .arg(&image)
        .output()
        .expect("arm-none-eabi-gcc: firmware-sim/setup.sh installs it");
    assert!(compiled.status.success(), "{}", String::from_utf8_lossy(&compiled.stderr));
    let run = Command::new("qemu-system-arm")
        .args(["-machine", "mps2-an386", "-nographic", "-monitor", "none", "-serial", "none"])
        .args(["-semihosting-config", "enable=on,target=native", "-kernel"])
        .arg(&image)
        .output()
        .unwrap();
    let printed = String::from_utf8_lossy(&run.stdout).into_owned() + &String::from_utf8_lossy(&run.stderr);
    assert_eq!(printed, expected());
    assert!(run.status.success(), "{}", run.status);
}
