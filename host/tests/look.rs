//! How robots look: links where the robot's are, solids, meshes that are there and those that are not.

use std::path::Path;

use kinesic::pose::{World, forward};
use kinesic_host::robot::look::{Drives, Link, Look, TRIANGLES};
use kinesic_host::robot::{Defaults, Form, Machine, Robot, ServoTable};
use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use rand::rngs::SmallRng;
use rand::{RngExt, SeedableRng};

/// A mast that slides, a canted arm, two fingers of which one follows the other, a lamp that does not move.
const CRANE: &str = r#"<robot name="crane">
  <material name="steel"><color rgba="0.2 0.4 0.6 1"/></material>
  <link name="base"><visual><origin xyz="0 0 0.05"/><geometry><box size="0.3 0.2 0.1"/></geometry><material name="steel"/></visual></link>
  <link name="mast"><visual><geometry><cylinder radius="0.02" length="0.5"/></geometry></visual></link>
  <link name="arm"><visual><geometry><sphere radius="0.05"/></geometry><material name="own"><color rgba="1 0 0 1"/></material></visual></link>
  <link name="left"/><link name="right"/>
  <link name="lamp"><visual><geometry><mesh filename="package://crane/lamp.stl" scale="0.001 0.001 0.001"/></geometry></visual></link>
  <joint name="lift" type="prismatic"><parent link="base"/><child link="mast"/><origin xyz="0.1 0 0.2"/><axis xyz="0 0 1"/>
    <limit lower="0" upper="0.4" velocity="1" effort="1"/></joint>
  <joint name="shoulder" type="revolute"><parent link="mast"/><child link="arm"/><origin xyz="0 0 0.3" rpy="0.4 0.2 -0.3"/><axis xyz="0.6 0 0.8"/>
    <limit lower="-2" upper="2" velocity="3" effort="1"/></joint>
  <joint name="finger" type="revolute"><parent link="arm"/><child link="left"/><origin xyz="0.3 0.02 0"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" velocity="3" effort="1"/></joint>
  <joint name="other_finger" type="revolute"><parent link="arm"/><child link="right"/><origin xyz="0.3 -0.02 0"/><axis xyz="0 0 1"/>
    <limit lower="-2" upper="2" velocity="3" effort="1"/><mimic joint="finger" multiplier="-1.5" offset="0.1"/></joint>
  <joint name="bracket" type="fixed"><parent link="right"/><child link="lamp"/><origin xyz="0.05 0 0"/></joint>
</robot>"#;

fn crane() -> (Robot, Machine) {
    let robot = Robot::parse(CRANE).unwrap();
    let machine = Machine::of_robot(&robot, &ServoTable::default(), 50.0, Defaults::default()).unwrap();
    (robot, machine)
}

fn apart(a: &Isometry3<f64>, b: &Isometry3<f64>) -> f64 {
    (a.translation.vector - b.translation.vector).norm().max(a.rotation.angle_to(&b.rotation))
}

#[test]
fn links_are_where_the_description_s_kinematics_put_them_followers_and_sliders_too() {
    let (robot, machine) = crane();
    let look = Look::of_robot(&machine, &robot, Path::new("."), &[]).unwrap();
    let base = look.placed(&[])[0];
    let order = robot.depth_first();
    let mut random = SmallRng::seed_from_u64(1);
    let mut moved = 0.0f64;
    for _ in 0..100 {
        let values = [random.random_range(0.0..0.4), random.random_range(-2.0..2.0), random.random_range(-1.0..1.0)];
        let own = ["lift", "shoulder", "finger"].map(|name| robot.find(name).unwrap());
        let mut all = vec![0.0; robot.joints.len()];
        own.iter().zip(values).for_each(|(at, value)| all[*at] = value);
        let all = robot.followed(&all);
        let expected = robot.placed(&|at| all[at]);
        let frames = look.placed(&values);
        for (joint, frame) in order.iter().zip(&frames[1..]) {
            assert!(apart(&(base * expected[*joint]), frame) < 1e-9, "{}", robot.joints[*joint].name);
        }
        let lamp = frames.len() - 1;
        moved = moved.max(apart(&look.placed(&[])[lamp], &frames[lamp]));
        // The joints of the pack are those links.
        for (joint, link) in machine.rig.skeleton.joints.iter().zip(&look.joints).skip(1) {
            let at = robot.find(&joint.name).unwrap();
            assert!(apart(&(base * expected[at]), &frames[*link]) < 1e-9);
        }
    }
    assert!(moved > 0.5, "the lamp hangs on a follower: {moved}");
    // It stands on the ground and faces +Z: its X.
    assert!(look.extent(&[])[0].y.abs() < 1e-9);
    assert!((base * Vector3::x() - Vector3::z()).norm() < 1e-6);
}

#[test]
fn the_bones_of_a_pack_are_where_the_device_puts_its_joints_and_slide_besides() {
    let (_, machine) = crane();
    let look = Look::of_machine(&machine);
    // The device's kinematics, of rotations alone, beside those of the look without the slider.
    let (rig, mut world) = (machine.rig.frames(), World::<128>::identity());
    let base = look.placed(&[])[0];
    let upright = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), -std::f64::consts::FRAC_PI_2);
    let to = base * Isometry3::from_parts(Vector3::zeros().into(), upright).inverse();
    let frame = kinesic::Frame::<129>::from_coordinates(&[0.0, 0.7, -0.4]);
    let mut pose = machine.rig.zero_pose();
    rig.show(&frame, &frame, &mut kinesic::rig::Drift::new(), &mut pose);
    forward(&machine.rig.device(), &pose, &mut world);
    let frames = look.placed(&[0.0, 0.7, -0.4]);
    for (at, frame) in frames.iter().enumerate() {
        let device = to * nalgebra::Point3::from(world.positions[at].cast::<f64>());
        assert!((device.coords - frame.translation.vector).norm() < 1e-5, "{at}");
    }
    let slid = look.placed(&[0.3, 0.7, -0.4]);
    for (at, (before, after)) in frames.iter().zip(&slid).enumerate().skip(1) {
        let way = after.translation.vector - before.translation.vector;
        assert!((way - Vector3::y() * 0.3).norm() < 1e-6, "{at}: {way}");
    }
    assert!(look.links.iter().all(|link| !link.solids.is_empty()));
}

#[test]
fn a_pose_moves_the_link_that_is_named_about_its_origin() {
    let robot = Robot::parse(CRANE).unwrap();
    let table = "[[pose]]\nname = \"gaze\"\nmin = [-0.1, -0.1, -0.1, -1, -1, -1]\nmax = [0.1, 0.1, 0.1, 1, 1, 1]\nspeed = 1\nacceleration = 9\n";
    let machine = Machine::of_robot(&robot, &ServoTable::parse(table).unwrap(), 50.0, Defaults::default()).unwrap();
    let drives = |name: &str, what: &str| vec![Drives { name: name.to_owned(), what: what.to_owned() }];
    let look = Look::of_robot(&machine, &robot, Path::new("."), &drives("gaze", "lamp")).unwrap();
    let coordinate = |name: &str| machine.servos.iter().position(|servo| servo.name == name).unwrap();
    let mut values = vec![0.0; machine.servos.len()];
    let link = look.links.len() - 1;
    let zero = look.placed(&values)[link];
    values[coordinate("gaze_yaw")] = 0.5;
    let turned = look.placed(&values)[link];
    assert!((turned.translation.vector - zero.translation.vector).norm() < 1e-9);
    let up = turned.rotation * zero.rotation.inverse() * UnitQuaternion::from_axis_angle(&Vector3::y_axis(), -0.5);
    assert!(up.angle() < 1e-6);
    values[coordinate("gaze_z")] = 0.1;
    assert!(
        (look.placed(&values)[link].translation.vector - zero.translation.vector - Vector3::y() * 0.1).norm() < 1e-9
    );
    // The arm does not carry it any more.
    values[coordinate("shoulder")] = 1.0;
    assert!(
        (look.placed(&values)[link].translation.vector - zero.translation.vector - Vector3::y() * 0.1).norm() < 1e-9
    );
    // Without a link it is a box, and that is said.
    let look = Look::of_robot(&machine, &robot, Path::new("."), &[]).unwrap();
    assert!(look.notes.iter().any(|note| note.contains("--drives gaze=LINK")), "{:?}", look.notes);
    for (drives, expected) in [
        (drives("gaze", "lmap"), "gaze=lmap: 'lmap' is no link that a joint carries; did you mean 'lamp'?"),
        (drives("gazes", "lamp"), "gazes=lamp: 'gazes' is no pose or joint of the pack; did you mean 'gaze'?"),
        (drives("finger", "fingr"), "finger=fingr: 'fingr' is no joint of the description; did you mean 'finger'?"),
    ] {
        let error = Look::of_robot(&machine, &robot, Path::new("."), &drives).unwrap_err();
        assert_eq!(error.to_string(), expected);
    }
    let twice = [drives("gaze", "lamp"), drives("gaze", "arm")].concat();
    assert!(
        Look::of_robot(&machine, &robot, Path::new("."), &twice).unwrap_err().to_string().ends_with("is given twice")
    );
}

#[test]
fn a_description_of_another_robot_with_the_same_names_is_refused() {
    let (_, machine) = crane();
    let axis = r#"<axis xyz="0.6 0 0.8"/>"#;
    for (text, found) in [
        (CRANE.replace("\"shoulder\" type=\"revolute\"", "\"shoulder\" type=\"prismatic\""), "prismatic"),
        (CRANE.replace("\"shoulder\" type=\"revolute\"", "\"shoulder\" type=\"fixed\""), "fixed"),
        (CRANE.replace(axis, &format!("{axis}<mimic joint=\"finger\"/>")), "follower"),
    ] {
        let error = Look::of_robot(&machine, &Robot::parse(&text).unwrap(), Path::new("."), &[]).unwrap_err();
        let expected = format!("found a joint of type {found}, expected a hinge that moves by itself, as in the pack");
        assert!(error.to_string().starts_with("line ") && error.to_string().ends_with(&expected), "{error}");
    }
}

#[test]
fn a_joint_may_have_another_name_in_the_description() {
    let (_, machine) = crane();
    let robot = Robot::parse(&CRANE.replace("\"shoulder\"", "\"joint_2\"")).unwrap();
    let error = Look::of_robot(&machine, &robot, Path::new("."), &[]).unwrap_err();
    assert_eq!(error.to_string(), "robot 'crane': it has no joint shoulder, expected all joints of the robot's pack");
    assert!(
        error.help.starts_with("where it calls them otherwise, say so: --drives shoulder=ITS-NAME"),
        "{}",
        error.help
    );
    let drives = [Drives { name: "shoulder".to_owned(), what: "joint_2".to_owned() }];
    let look = Look::of_robot(&machine, &robot, Path::new("."), &drives).unwrap();
    assert!(apart(&look.placed(&[])[3], &look.placed(&[0.0, 1.0])[3]) > 0.1);
}

/// A sheet of so many triangles, an STL in mm.
fn stl(triangles: usize) -> Vec<u8> {
    let mut bytes = vec![0; 80];
    bytes.extend((triangles as u32).to_le_bytes());
    let side = (triangles as f64).sqrt().ceil() as usize;
    for at in 0..triangles {
        let (x, y) = ((at % side) as f32, (at / side) as f32);
        let corners = [[0.0; 3], [x, y, 0.0], [x + 1.0, y, 0.1 * x], [x, y + 1.0, 0.0]];
        bytes.extend(corners.as_flattened().iter().flat_map(|x: &f32| x.to_le_bytes()));
        bytes.extend([0; 2]);
    }
    bytes
}

#[test]
fn meshes_are_drawn_with_few_triangles_and_those_that_are_not_there_are_said() {
    let (robot, machine) = crane();
    let folder = tempfile::tempdir().unwrap();
    let look = || Look::of_robot(&machine, &robot, folder.path(), &[]).unwrap();
    let solids = |look: &Look| look.links.iter().map(|link: &Link| link.solids.len()).collect::<Vec<_>>();
    let without = look();
    assert_eq!(
        without.notes.last().unwrap(),
        "1 mesh is not drawn, bones stand in: 'package://crane/lamp.stl' is no file there"
    );
    assert_eq!(solids(&without), [1, 1, 1, 0, 0, 0]);
    assert_eq!(without.links[0].solids[0].colour, Some([0.2, 0.4, 0.6]));
    assert_eq!((without.links[1].solids[0].colour, without.links[2].solids[0].colour), (None, Some([1.0, 0.0, 0.0])));
    std::fs::write(folder.path().join("lamp.stl"), "version https://git-lfs.github.com/spec/v1\noid sha256:0\n")
        .unwrap();
    assert!(look().notes.last().unwrap().ends_with("is a pointer of Git LFS, not the mesh: run `git lfs pull` there"));
    std::fs::write(folder.path().join("lamp.stl"), stl(50_000)).unwrap();
    let with = look();
    assert_eq!(with.notes, ["drawn with at most 4500 of its 50260 triangles: small parts lose their shape"]);
    let count: usize = with.links.iter().flat_map(|link| &link.solids).map(|solid| solid.triangles.len()).sum();
    assert!((TRIANGLES / 4..=TRIANGLES).contains(&count), "{count}");
    let lamp = &with.links[5].solids[0];
    assert!(lamp.vertices.iter().all(|vertex| vertex.amax() < 0.25), "millimetres");
}

#[test]
fn damaged_meshes_are_refused_without_a_panic() {
    let (_, machine) = crane();
    let folder = tempfile::tempdir().unwrap();
    let cube = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\nvt 0 0\nusemtl a\nf 1/1/1 2/1/1 3/1/1 4/1/1\n"
        .as_bytes()
        .to_vec();
    let dae = br##"<COLLADA version="1.4.1"><asset><unit meter="1"/></asset><library_geometries><geometry id="g"><mesh><source id="p">
        <float_array id="pa" count="9">0 0 0 1 0 0 0 2 0</float_array><technique_common><accessor source="#pa" count="3" stride="3"><param name="X" type="float"/>
        <param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source><vertices id="v"><input semantic="POSITION" source="#p"/>
        </vertices><triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles></mesh></geometry></library_geometries>
        <library_visual_scenes><visual_scene id="s"><node><matrix>1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1</matrix><instance_geometry url="#g"/></node></visual_scene>
        </library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>"##
        .to_vec();
    let text = b"solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid a\n".to_vec();
    let mut random = SmallRng::seed_from_u64(2);
    for (name, sound) in [("lamp.stl", stl(4)), ("lamp.stl", text), ("lamp.obj", cube), ("lamp.dae", dae)] {
        let robot = Robot::parse(&CRANE.replace("lamp.stl", name)).unwrap();
        std::fs::write(folder.path().join(name), &sound).unwrap();
        let look = Look::of_robot(&machine, &robot, folder.path(), &[]).unwrap();
        assert!(!look.links[5].solids.is_empty(), "{name}: {:?}", look.notes);
        for _ in 0..1000 {
            let mut bytes = sound.clone();
            for _ in 0..random.random_range(1..6) {
                let at = random.random_range(0..bytes.len());
                match random.random_range(0..4) {
                    0 => bytes[at] = random.random(),
                    1 => bytes[at] = b"0123456789-eE #/\n<>"[random.random_range(0..19)],
                    2 => bytes.truncate(at.max(1)),
                    _ => {
                        let end = (at + random.random_range(1..40)).min(bytes.len());
                        let part = bytes[at..end].to_vec();
                        bytes.splice(at..at, part);
                    }
                }
            }
            std::fs::write(folder.path().join(name), &bytes).unwrap();
            let look = Look::of_robot(&machine, &robot, folder.path(), &[]).unwrap();
            assert!(look.links.iter().flat_map(|link| &link.solids).all(|solid| {
                solid.triangles.as_flattened().iter().all(|at| *at < solid.vertices.len())
                    && solid.vertices.iter().all(|vertex| vertex.iter().all(|x| x.is_finite()))
            }));
        }
    }
}

#[test]
fn geoms_of_an_mjcf_are_those_that_its_viewer_shows() {
    let robot = Robot::parse(
        r#"<mujoco model="arm"><compiler meshdir="parts" angle="radian"/>
        <default><geom group="3"/><default class="seen"><geom group="2" material="grey"/></default><mesh scale="0.001 0.001 0.001"/></default>
        <asset><material name="grey" rgba="0.5 0.5 0.5 1"/><mesh file="hand.stl"/></asset>
        <worldbody><geom type="plane" size="1 1 1" group="0"/><body name="base"><geom class="seen" type="box" size="0.1 0.2 0.3" pos="0 0 1"/>
        <geom type="sphere" size="0.5"/>
        <body name="arm"><joint name="a" axis="0 0 1"/><geom class="seen" type="capsule" size="0.05" fromto="0 0 0 0 0.4 0" rgba="1 0 0 1"/>
        <geom class="seen" mesh="hand" type="mesh"/><geom class="seen" type="cylinder" size="0.1 0.2"/><geom class="seen" type="cylinder"/></body></body></worldbody></mujoco>"#,
    )
    .unwrap();
    let found: Vec<(&str, &Form, Option<[f64; 3]>)> =
        robot.shapes.iter().map(|shape| (shape.link.as_str(), &shape.form, shape.colour)).collect();
    let grey = Some([0.5; 3]);
    assert_eq!(found.len(), 4, "{found:?}");
    assert_eq!(found[0], ("base", &Form::Cuboid(Vector3::new(0.2, 0.4, 0.6)), grey));
    let (link, Form::Capsule(radius, length), colour) = found[1] else { panic!("{:?}", found[1]) };
    assert_eq!((link, *radius, colour), ("arm", 0.05, Some([1.0, 0.0, 0.0])));
    assert!((length - 0.4).abs() < 1e-12);
    let ends = [-0.2, 0.2].map(|z| robot.shapes[1].at * nalgebra::Point3::new(0.0, 0.0, z));
    assert!(ends.iter().any(|end| end.coords.norm() < 1e-9) && ends.iter().any(|end| (end.y - 0.4).abs() < 1e-9));
    assert_eq!(found[2].1, &Form::Mesh("parts/hand.stl".to_owned(), Vector3::repeat(0.001)));
    assert_eq!(found[3].1, &Form::Cylinder(0.1, 0.4));
    assert!(robot.notes.iter().any(|note| note.ends_with("this part of 'arm' is not drawn")), "{:?}", robot.notes);
}
