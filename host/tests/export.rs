//! Exports, read back by others than ourselves.

#[path = "../../tests/tests/common/hostile.rs"]
mod hostile;

use std::path::Path;
use std::process::Command;

use hostile::Hostile;
use kinesic_host::clip::{self, Clip};
use kinesic_host::face::synthetic;
use kinesic_host::pack::{PackFile, Provenance};
use kinesic_tests::{data, table};
use nalgebra::{Matrix4, Point3, Quaternion, Translation3, UnitQuaternion, Vector3};
use rand::SeedableRng;
use rand::rngs::ChaCha8Rng;

fn succeed(args: &[&str], folder: &Path) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_kinesic")).args(args).current_dir(folder).output().unwrap();
    assert!(output.status.success(), "{args:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

fn demo() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    succeed(&["demo", "--out", "."], folder.path());
    folder
}

/// World matrices `[frames][nodes]`, computed by walking the document's own tree, and the key times.
struct Played {
    times: Vec<f32>,
    worlds: Vec<Vec<Matrix4<f64>>>,
    document: gltf::Document,
    buffer: Vec<u8>,
}

fn play(gltf: gltf::Gltf, buffer: Option<Vec<u8>>) -> Played {
    let (document, blob) = (gltf.document, gltf.blob);
    let buffer = buffer.or(blob).unwrap();
    let animation = document.animations().next().unwrap();
    let nodes = document.nodes().count();
    let mut times = Vec::new();
    let mut translations = vec![None; nodes];
    let mut rotations = vec![None; nodes];
    for channel in animation.channels() {
        assert_eq!(channel.sampler().interpolation(), gltf::animation::Interpolation::Linear);
        let reader = channel.reader(|_| Some(&buffer));
        times = reader.read_inputs().unwrap().collect();
        let node = channel.target().node().index();
        match reader.read_outputs().unwrap() {
            gltf::animation::util::ReadOutputs::Translations(values) => {
                translations[node] = Some(values.collect::<Vec<_>>());
            }
            gltf::animation::util::ReadOutputs::Rotations(values) => {
                rotations[node] = Some(values.into_f32().collect::<Vec<_>>());
            }
            _ => panic!("neither translation nor rotation is animated"),
        }
    }
    let mut worlds = Vec::new();
    for frame in 0..times.len() {
        let mut world = vec![Matrix4::identity(); nodes];
        let mut open: Vec<_> =
            document.default_scene().unwrap().nodes().map(|node| (node, Matrix4::identity())).collect();
        while let Some((node, parent)) = open.pop() {
            let (mut t, mut r, _) = node.transform().decomposed();
            t = translations[node.index()].as_ref().map_or(t, |of: &Vec<[f32; 3]>| of[frame]);
            r = rotations[node.index()].as_ref().map_or(r, |of: &Vec<[f32; 4]>| of[frame]);
            let q = Quaternion::from(r.map(f64::from));
            assert!((q.norm() - 1.0).abs() < 1e-6);
            let turn = UnitQuaternion::from_quaternion(q).to_homogeneous();
            let local = Translation3::from(t.map(f64::from)).to_homogeneous() * turn;
            world[node.index()] = parent * local;
            open.extend(node.children().map(|child| (child, world[node.index()])));
        }
        worlds.push(world);
    }
    Played { times, worlds, document, buffer }
}

fn place(world: &Matrix4<f64>) -> Vector3<f64> {
    world.transform_point(&Point3::origin()).coords
}

/// Largest distance between the file's joints and ours, m, over the whole clip.
fn farthest(played: &Played, clip: &Clip) -> f64 {
    assert_eq!(played.worlds.len(), clip.frames());
    let frames = played.worlds.iter().enumerate();
    let distance = |(frame, world): (usize, &Vec<Matrix4<f64>>)| {
        clip.positions(frame).iter().zip(world).map(|(p, m)| (place(m) - p).norm()).fold(0.0, f64::max)
    };
    frames.map(distance).fold(0.0, f64::max)
}

#[test]
fn another_reader_finds_the_same_joints_in_gltf() {
    let folder = demo();
    let at = folder.path();
    let apply = |out: &str| succeed(&["apply", "weary.kin", "unseen.bvh", "--out", out], at);
    for out in ["o.bvh", "o.glb", "o.gltf", "o.csv"] {
        apply(out);
    }
    let clip = clip::read(at.join("o.bvh")).unwrap();
    let binary = play(gltf::Gltf::open(at.join("o.glb")).unwrap(), None);
    assert!(farthest(&binary, &clip) < 1e-4, "{} m", farthest(&binary, &clip));
    // Rate, duration, names, root motion.
    let last = f64::from(*binary.times.last().unwrap());
    assert!((last - clip.duration()).abs() < 1e-4 && binary.times[0] == 0.0);
    let names: Vec<_> = binary.document.nodes().filter_map(|node| node.name().map(str::to_owned)).collect();
    assert!(clip.skeleton.joints.iter().zip(&names).all(|(joint, name)| joint.name == *name));
    let raw = binary.document.as_json().asset.extras.as_ref().unwrap().get();
    let extras: serde_json::Value = serde_json::from_str(raw).unwrap();
    assert_eq!(extras["frames"], 360);
    assert!((extras["frame_rate"].as_f64().unwrap() - 60.0).abs() < 1e-6);
    let travelled = |a: Vector3<f64>, b: Vector3<f64>| (b - a).xz().norm();
    let walked = travelled(place(&binary.worlds[0][0]), place(&binary.worlds[359][0]));
    assert!(walked > 2.0 && (walked - travelled(clip.root[0], clip.root[359])).abs() < 1e-4);
    // The text form holds the same.
    let text: serde_json::Value = serde_json::from_slice(&std::fs::read(at.join("o.gltf")).unwrap()).unwrap();
    let uri = text["buffers"][0]["uri"].as_str().unwrap();
    let encoded = uri.strip_prefix("data:application/octet-stream;base64,").unwrap();
    let bytes = base64::Engine::decode(&base64::prelude::BASE64_STANDARD, encoded).unwrap();
    let same = play(gltf::Gltf::open(at.join("o.gltf")).unwrap(), Some(bytes));
    assert!(same.worlds == binary.worlds && same.times == binary.times);
}

#[test]
fn the_body_in_gltf_follows_the_joints() {
    let folder = demo();
    let at = folder.path();
    succeed(&["export", "weary.bvh", "--out", "w.glb"], at);
    let played = play(gltf::Gltf::open(at.join("w.glb")).unwrap(), None);
    let skin = played.document.skins().next().unwrap();
    let unbind: Vec<_> =
        skin.reader(|_| Some(&played.buffer)).read_inverse_bind_matrices().unwrap().map(Matrix4::from).collect();
    let mesh = played.document.meshes().next().unwrap();
    let primitive = mesh.primitives().next().unwrap();
    let reader = primitive.reader(|_| Some(&played.buffer));
    let positions: Vec<_> = reader.read_positions().unwrap().collect();
    let joints: Vec<_> = reader.read_joints(0).unwrap().into_u16().collect();
    assert!(reader.read_indices().unwrap().into_u32().all(|vertex| (vertex as usize) < positions.len()));
    // The first corner of each bone is its joint, in every frame; the last is a child's or the tip.
    for world in &played.worlds {
        for (corner, [joint, ..]) in positions.iter().zip(&joints).step_by(6) {
            let node = skin.joints().nth(usize::from(*joint)).unwrap().index();
            let bound = world[node] * unbind[usize::from(*joint)].cast::<f64>();
            let drawn = bound.transform_point(&Point3::from(corner.map(f64::from)));
            assert!((drawn.coords - place(&world[node])).norm() < 1e-5);
        }
    }
}

#[test]
fn gltf_of_real_clips_has_the_same_joints() {
    let Some(folder) = data("gltf_of_real_clips_has_the_same_joints") else { return };
    let out = tempfile::tempdir().unwrap();
    // Every two hundredth clip of the manifest: all formats and skeletons are among them.
    for row in table(&folder.join("manifest.tsv")).iter().step_by(200) {
        let clip = clip::read(folder.join(&row["file"])).unwrap();
        let path = out.path().join("clip.glb");
        clip.write(&path).unwrap();
        let played = play(gltf::Gltf::open(&path).unwrap(), None);
        assert!(farthest(&played, &clip) < 1e-4, "{}: {} m", row["file"], farthest(&played, &clip));
    }
}

#[test]
fn the_table_of_angles_gives_the_motion_back() {
    let folder = demo();
    let at = folder.path();
    succeed(&["export", "weary.bvh", "--out", "w.csv"], at);
    let clip = clip::read(at.join("weary.bvh")).unwrap();
    let mut reader = csv::Reader::from_path(at.join("w.csv")).unwrap();
    let headers: Vec<String> = reader.headers().unwrap().iter().map(str::to_owned).collect();
    assert_eq!(headers[..6], ["frame", "time_s", "Hips_x_m", "Hips_y_m", "Hips_z_m", "Hips_z_deg"]);
    assert_eq!(headers.len(), 5 + 3 * clip.skeleton.len());
    let mut frames = 0;
    for (frame, row) in reader.records().enumerate() {
        let row = row.unwrap();
        let number = |column: usize| row[column].parse::<f64>().unwrap();
        assert!((number(1) - frame as f64 * clip.frame_time).abs() < 1e-5);
        let about = |axis: Vector3<f64>, column| UnitQuaternion::new(axis * number(column).to_radians());
        let rotation = |joint: usize| {
            let first = 5 + 3 * joint;
            about(Vector3::z(), first) * about(Vector3::x(), first + 1) * about(Vector3::y(), first + 2)
        };
        let rotations: Vec<_> = (0..clip.skeleton.len()).map(rotation).collect();
        let read = clip.skeleton.pose_positions(&Vector3::new(number(2), number(3), number(4)), &rotations);
        let worst = read.iter().zip(clip.positions(frame)).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
        assert!(worst < 1e-5, "frame {frame}: {worst} m");
        frames += 1;
    }
    assert_eq!(frames, clip.frames());
}

/// The program that a user would write around the module; it prints the constants.
fn program(pack: &str, constants: &[&str]) -> String {
    let printed: Vec<String> = constants.iter().map(|name| format!("println!(\"{{}}\", pack::{name});")).collect();
    format!(
        "mod pack;\nfn main() {{\n\
             assert_eq!(pack::PACK.as_ptr() as usize % 16, 0, \"misaligned\");\n\
             assert_eq!(pack::PACK, include_bytes!({pack:?}), \"other bytes\");\n\
             {}\n}}\n",
        printed.join("\n")
    )
}

#[test]
fn a_pack_as_rust_source_compiles_to_the_same_bytes() {
    let folder = demo();
    let at = folder.path();
    let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models");
    std::fs::copy(models.join("mechanics.kin"), at.join("mechanics.kin")).unwrap();
    let train = ["train", "components", "--content", "neutral.bvh", "--style", "weary.bvh", "-k", "8"];
    succeed(&[&train[..], &["--no-report", "--out", "components.kin"]].concat(), at);
    // Two translators, and two engines that have units.
    let pack = |name: &str| PackFile::read(&at.join(name)).unwrap();
    let mut two = Hostile::of(&pack("weary.kin"));
    two.models.push(two.models[0]);
    std::fs::write(at.join("two.kin"), two.bytes()).unwrap();
    let mut mixed = Hostile::of(&pack("mechanics.kin"));
    let faces = synthetic::model(2, 3, &mut ChaCha8Rng::seed_from_u64(3)).pack(&Provenance::default());
    mixed.add(&PackFile::from_bytes(&faces));
    std::fs::write(at.join("mixed.kin"), mixed.bytes()).unwrap();
    let cases: [(&str, &[&str]); 5] = [
        ("two.kin", &["JOINTS", "STATES", "ROWS"]),
        ("mixed.kin", &["JOINTS", "UNITS", "WINDOW", "FACE_UNITS"]),
        ("weary.kin", &["JOINTS", "STATES", "ROWS"]),
        ("mechanics.kin", &["JOINTS", "UNITS", "WINDOW"]),
        ("components.kin", &["JOINTS", "COMPONENTS"]),
    ];
    for (name, constants) in cases {
        succeed(&["export", "--rust", name, "--out", "pack.rs"], at);
        std::fs::write(at.join("main.rs"), program(name, constants)).unwrap();
        let rustc = std::env::var("RUSTC").unwrap_or_else(|_| "rustc".into());
        let built = Command::new(rustc)
            .args(["--edition", "2024", "-D", "warnings", "-o", "program", "main.rs"])
            .current_dir(at)
            .output()
            .unwrap();
        assert!(built.status.success(), "{name}: {}", String::from_utf8_lossy(&built.stderr));
        let ran = Command::new(at.join("program")).output().unwrap();
        assert!(ran.status.success(), "{name}: {}", String::from_utf8_lossy(&ran.stderr));
        let printed = String::from_utf8(ran.stdout).unwrap();
        let json: serde_json::Value = serde_json::from_str(&succeed(&["inspect", name, "--json"], at)).unwrap();
        let joints = json["joints"].as_array().unwrap().len();
        let numbers: Vec<usize> = printed.split_whitespace().map(|n| n.parse().unwrap()).collect();
        assert_eq!(numbers[0], joints, "{name}");
        let model = &json["models"][0];
        match name {
            "weary.kin" | "two.kin" => {
                assert_eq!(model["capacity"], format!("Translator::<{}, {}>", numbers[2], numbers[1]))
            }
            "mechanics.kin" | "mixed.kin" => {
                let units = |layer: &str| model[layer].as_u64().unwrap().next_multiple_of(4) as usize;
                assert_eq!(numbers[1], units("hidden") + units("code"));
                assert_eq!(numbers[2], 20);
            }
            _ => assert_eq!(numbers[1], model["components"].as_u64().unwrap() as usize),
        }
    }
}

#[test]
fn completions_know_the_commands() {
    let folder = tempfile::tempdir().unwrap();
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = succeed(&["completions", shell], folder.path());
        assert!(script.contains("modulate") && script.contains("completions"), "{shell}");
    }
    let bash = succeed(&["completions", "bash"], folder.path());
    std::fs::write(folder.path().join("kinesic.bash"), bash).unwrap();
    // What a shell would offer after `kinesic mod`.
    let script = "source kinesic.bash; COMP_WORDS=(kinesic mod); COMP_CWORD=1; _kinesic kinesic mod kinesic; echo \"${COMPREPLY[@]}\"";
    let output = Command::new("bash").args(["-c", script]).current_dir(folder.path()).output().unwrap();
    assert_eq!(String::from_utf8_lossy(&output.stdout).trim(), "modulate");
}

/// The numbers of a Rust array, as the compiler reads them.
fn numbers(text: &str) -> Vec<f32> {
    let rows = text.split_once("= [").unwrap().1.split(['[', ']', ',', ';']);
    rows.map(str::trim).filter(|cell| !cell.is_empty()).map(|cell| cell.parse().unwrap()).collect()
}

#[test]
fn a_robot_s_move_becomes_an_array_at_the_robot_s_rate() {
    let folder = tempfile::tempdir().unwrap();
    let table = "name = \"head\"\n[[servo]]\nname = \"pan\"\nunit = \"deg\"\nzero = 90\nmin = 0\nmax = 180\n\
                 [[servo]]\nname = \"tilt\"\nunit = \"ticks\"\nper_turn = 4096\nsign = -1\nmin = -900\nmax = 900\n";
    std::fs::write(folder.path().join("head.toml"), table).unwrap();
    let rows: String = (0..11).map(|at| format!("{},{},{}\n", f64::from(at) * 0.04, 90 + at, at * 10)).collect();
    std::fs::write(folder.path().join("nod.csv"), format!("time,pan,tilt\n{rows}")).unwrap();
    succeed(&["robot", "import", "head.toml", "--out", "head.kin", "--fps", "50"], folder.path());
    succeed(&["export", "--rust", "nod.csv", "--robot", "head.kin", "--out", "nod.rs"], folder.path());
    let text = std::fs::read_to_string(folder.path().join("nod.rs")).unwrap();
    assert!(text.contains("pub static FRAMES: [[f32; 2]; 21]") && text.contains("FRAME_RATE: f32 = 50.0;"), "{text}");
    for (frame, row) in numbers(text.split_once("FRAMES").unwrap().1).chunks(2).enumerate() {
        let time = frame as f32 / 2.0;
        let expected = [time.to_radians(), -time * 10.0 / 4096.0 * std::f32::consts::TAU];
        assert!(row.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6), "{frame}: {row:?} {expected:?}");
    }
    // A clip of a body is no move, and nothing is written.
    succeed(&["demo", "--out", "."], folder.path());
    let clip = std::fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().path());
    let clip = clip.into_iter().find(|path| path.extension().is_some_and(|end| end == "bvh")).unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_kinesic"))
        .args(["export", "--rust", "--out", "none.rs"])
        .arg(clip)
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert!(!output.status.success() && String::from_utf8_lossy(&output.stderr).contains("--robot"));
    assert!(!folder.path().join("none.rs").exists());
}
