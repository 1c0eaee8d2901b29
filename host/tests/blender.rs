//! FBX that Blender has made of one of our clips: read as it is, and by way of BVH with the very line of docs/your-clips.md.

use std::path::Path;
use std::process::Command;

use kinesic_host::clip::{self, ReadOptions, WriteOptions};
use kinesic_host::gait::{Manner, walk};

/// Makes `in.fbx` of `made.bvh`. Debian's Blender 3.4 opens BVH in a way that Python 3.11 no longer has; others do not mind.
const MAKE: &str = "
import builtins
plain = builtins.open
builtins.open = lambda name, mode='r', *rest, **named: plain(name, mode.replace('U', ''), *rest, **named)
import bpy
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.import_anim.bvh(filepath='made.bvh', global_scale=0.01, update_scene_fps=True, update_scene_duration=True)
bpy.ops.export_scene.fbx(filepath='in.fbx', add_leaf_bones=False, bake_anim_simplify_factor=0.0)
";

/// Runs a command in a folder; what it printed, if it fails.
fn run(command: &mut Command, folder: &Path) {
    let output = command.current_dir(folder).output().expect("it starts");
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{command:?}: {text}\n{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn an_fbx_of_blender_is_read_and_so_is_what_the_line_of_the_docs_makes_of_it() {
    if Command::new("blender").arg("--version").output().is_err() {
        kinesic_tests::skipped(
            "an_fbx_of_blender_is_read_and_so_is_what_the_line_of_the_docs_makes_of_it: there is no blender (apt-get install blender)",
        );
        return;
    }
    let docs = include_str!("../../docs/your-clips.md");
    let line = docs.lines().find(|line| line.starts_with("blender --background")).expect("the docs have the line");
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    let made = walk(&Manner::WEARY, 2.0, 60.0, 0.0, 3);
    std::fs::write(folder.join("made.bvh"), made.to_bvh(&WriteOptions::default()).expect("text")).expect("written");
    run(Command::new("blender").args(["--background", "--python-exit-code", "1", "--python-expr", MAKE]), folder);
    assert!(folder.join("in.fbx").is_file(), "Blender makes an FBX");
    run(Command::new("sh").args(["-c", line]), folder);
    for name in ["in.fbx", "out.bvh"] {
        let found = clip::read_with(folder.join(name), &ReadOptions::default()).expect("it is read");
        assert_eq!(found.frames(), made.frames(), "{name}");
        // Blender writes the frame time of BVH with six digits.
        assert!((found.fps() - 60.0).abs() < 0.01, "{name}: {}", found.fps());
        let mut worst = 0.0f64;
        for frame in 0..made.frames() {
            let (is, should) = (found.positions(frame), made.positions(frame));
            for (joint, should) in made.skeleton.joints.iter().zip(should) {
                let at = found.skeleton.find(&joint.name).unwrap_or_else(|| panic!("{} is lost", joint.name));
                worst = worst.max((is[at] - should).norm());
            }
        }
        println!("{name}: largest distance {worst:.2e} m");
        assert!(worst < 1e-4, "{name}: {worst} m");
    }
}
