//! Robots from the command line: from a table of servos or a URDF and motions of their joints to what servos take.

#[path = "../../tests/tests/common/servos.rs"]
#[allow(unreachable_pub)]
mod servos;

use std::path::Path;
use std::process::Command;

use kinesic::{Frame, LimitState, Limiter, Pipeline, PipelineState, Servos, Translator, TranslatorState};
use kinesic_host::measure::{Measurable, compare_frames};
use kinesic_host::moves::{self, Options};
use kinesic_host::pack::PackFile;
use kinesic_host::robot::{Defaults, Machine, Robot, ServoTable};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use servos::{FPS, antennas, head, lamp};

/// The head with two antennas: ticks, ticks the other way, degrees about 90, pulses.
const TABLE: &str = r#"
name = "desk robot"
[[servo]]
name = "pan"
id = 11
unit = "ticks"
per_turn = 4096
zero = 2048
min = 800
max = 3300
speed = 9000
acceleration = 90000
[[servo]]
name = "tilt"
parent = "pan"
id = 12
unit = "ticks"
per_turn = 4096
zero = 2048
sign = -1
min = 1300
max = 2800
speed = 9000
acceleration = 90000
axis = [0, 1, 0]
[[servo]]
name = "left antenna"
parent = "tilt"
id = 3
unit = "deg"
zero = 90
min = 0
max = 180
speed = 600
acceleration = 9000
[[servo]]
name = "right antenna"
parent = "tilt"
id = 4
unit = "us"
per_turn = 4000
zero = 1500
min = 700
max = 2300
speed = 6600
acceleration = 99000
"#;

fn kinesic(folder: &Path, args: &[&str]) -> Result<String, String> {
    let output = Command::new(env!("CARGO_BIN_EXE_kinesic")).args(args).current_dir(folder).output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    // Wrapped for a terminal.
    let error = text(&output.stderr).replace('│', " ").split_whitespace().collect::<Vec<_>>().join(" ");
    if output.status.success() { Ok(text(&output.stdout)) } else { Err(error) }
}

/// A motion in degrees, with a light that is no joint.
fn table(rows: &[Vec<f64>], names: &[&str]) -> String {
    let mut text =
        format!("time_s,{},light\n", names.iter().map(|name| format!("{name}_deg")).collect::<Vec<_>>().join(","));
    for (frame, row) in rows.iter().enumerate() {
        let cells: Vec<String> = row.iter().map(|x| format!("{:.6}", x.to_degrees())).collect();
        text += &format!("{},{},{}\n", frame as f64 / FPS, cells.join(","), if frame % 50 < 45 { "on" } else { "off" });
    }
    text
}

#[test]
fn a_mood_learned_from_a_robot_s_own_recordings_ends_in_servo_positions_with_the_device_s_bits() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let machine = antennas();
    let names: Vec<&str> = machine.servos.iter().map(|servo| servo.name).collect();
    for (seed, seconds) in [(1, 40.0), (2, 40.0), (77, 20.0)] {
        let [calm, lively] = machine.take(seed, seconds);
        std::fs::write(at.join(format!("calm{seed}.csv")), table(&calm, &names)).unwrap();
        std::fs::write(at.join(format!("lively{seed}.csv")), table(&lively, &names)).unwrap();
    }
    std::fs::write(at.join("desk.toml"), TABLE).unwrap();
    kinesic(at, &["robot", "import", "desk.toml", "--out", "desk.kin"]).unwrap();
    let pairs = ["--pair", "calm1.csv", "lively1.csv", "--pair", "calm2.csv", "lively2.csv"];
    kinesic(
        at,
        &[&["train", "translate", "--robot", "desk.kin", "--out", "lively.kin", "--no-report"], &pairs[..]].concat(),
    )
    .unwrap();

    // An unseen take: every servo within a degree and a half, and far better than doing nothing.
    let text =
        kinesic(at, &["eval", "translate", "lively.kin", "--pair", "calm77.csv", "lively77.csv", "--json"]).unwrap();
    let report: serde_json::Value = serde_json::from_str(&text).unwrap();
    for (before, after) in
        [("identity", "error")].map(|(a, b)| (&report["degrees"][a]["joints"], &report["degrees"][b]["joints"]))
    {
        for (before, after) in before.as_array().unwrap().iter().zip(after.as_array().unwrap()).skip(1) {
            let [before, after] = [before, after].map(|joint| joint["angle"].as_f64().unwrap());
            assert!(after < 1.5 && after < 0.25 * before, "{before} {after}: {text}");
        }
    }

    // What is written is what the device tells its servos, light and all.
    let text = kinesic(at, &["apply", "lively.kin", "calm77.csv", "--out", "out.csv", "--strength", "0.7"]).unwrap();
    assert!(text.contains("limits"), "{text}");
    let written = moves::read(&at.join("out.csv"), &Options::default()).unwrap();
    assert_eq!(written.extra.columns, ["light"]);
    assert_eq!(written.extra.rows[46][0], "off");
    let file = PackFile::read(&at.join("lively.kin")).unwrap();
    let pack = file.pack().unwrap();
    let pipeline = Pipeline::<(Translator<2, 256>, Limiter<2>), 2>::load(&pack).unwrap();
    let servos = Servos::load(&pack).unwrap();
    let told = Machine::from_pack(&pack).unwrap().unwrap();
    let source = moves::read(&at.join("calm77.csv"), &Options::default()).unwrap();
    let clip = told.clip(&source, None).unwrap();
    let mut state: PipelineState<(TranslatorState<2, 256>, LimitState<2>), 2> = PipelineState::new();
    state.engine.0.controls.strength = 0.7;
    let mut out = [0.0; 4];
    for frame in 0..clip.frames() {
        let coordinates: Vec<f32> = clip.coordinates(frame).unwrap()[..4].iter().map(|x| *x as f32).collect();
        if frame == 0 {
            pipeline.start_coordinates(&mut state, &coordinates);
            // The written move begins in style, and a robot that plays it stands there.
            let (mut style, mut first) = (state.engine.0, Frame::from_coordinates(&coordinates));
            pipeline.engine.0.step(&mut style, &mut first);
            pipeline.engine.1.start(&mut state.engine.1, &first);
        }
        pipeline.step_coordinates(&mut state, Some(&coordinates), &mut out);
        for (command, written) in servos.commands(&out).zip(written.frame(frame)) {
            assert_eq!(command.value, *written as f32, "frame {frame}, servo {}", command.id);
        }
    }
    assert_eq!(servos.commands(&out).map(|command| command.id).collect::<Vec<_>>(), [11, 12, 3, 4]);

    // Wherever it stands when it is switched on, and in whatever mood: the first frame is within the limits of that place.
    let here = [0.4f32, -0.1, 0.2, -0.3];
    let mut state: PipelineState<(TranslatorState<2, 256>, LimitState<2>), 2> = PipelineState::new();
    pipeline.start_coordinates(&mut state, &here);
    pipeline.step_coordinates(&mut state, Some(&here), &mut out);
    let step = |at: usize| (out[at] - here[at]).abs();
    let most = |at: usize| pipeline.engine.1.table().acceleration.as_flattened()[at] / 2500.0;
    assert!((0..4).all(|at| step(at) <= 1.001 * most(at)) && (0..4).any(|at| step(at) > 0.5 * most(at)), "{out:?}");
}

/// Joints in a table of servos, moves in degrees, and nothing else.
#[test]
fn a_head_and_a_lamp_are_learned_from_files_of_their_moves() {
    for machine in [head(), lamp()] {
        let folder = tempfile::tempdir().unwrap();
        let at = folder.path();
        let names: Vec<&str> = machine.servos.iter().map(|servo| servo.name).collect();
        let servo = |name: &&str| {
            format!(
                "[[servo]]\nname = \"{name}\"\nunit = \"deg\"\nmin = -180\nmax = 180\nspeed = 600\nacceleration = 9000\n"
            )
        };
        std::fs::write(at.join("m.toml"), names.iter().map(servo).collect::<String>()).unwrap();
        for (seed, seconds) in [(1, 40.0), (2, 40.0), (77, 30.0)] {
            let [calm, lively] = machine.take(seed, seconds);
            std::fs::write(at.join(format!("calm{seed}.csv")), table(&calm, &names)).unwrap();
            std::fs::write(at.join(format!("lively{seed}.csv")), table(&lively, &names)).unwrap();
        }
        kinesic(at, &["robot", "import", "m.toml", "--out", "m.kin"]).unwrap();
        let pairs = ["--pair", "calm1.csv", "lively1.csv", "--pair", "calm2.csv", "lively2.csv"];
        let train = ["train", "translate", "--robot", "m.kin", "--out", "lively.kin", "--no-report"];
        kinesic(at, &[&train, &pairs[..]].concat()).unwrap();
        let unseen = ["--pair", "calm77.csv", "lively77.csv", "--json"];
        let text = kinesic(at, &[&["eval", "translate", "lively.kin"], &unseen[..]].concat()).unwrap();
        let report: serde_json::Value = serde_json::from_str(&text).unwrap();
        let joints = |what: &str| report["degrees"][what]["joints"].as_array().unwrap().clone();
        let size = std::fs::metadata(at.join("lively.kin")).unwrap().len();
        println!("{}: pack of {size} B", machine.name);
        // The first joint is the base.
        for (before, after) in joints("identity").iter().zip(joints("error")).skip(1) {
            let [was, is] = [before, &after].map(|joint| joint["angle"].as_f64().unwrap());
            println!("  {}: {is:.2} degrees, doing nothing {was:.2}", after["joint"]);
            assert!(is < 1.5 && is < 0.25 * was, "{was} {is}: {text}");
        }
    }
}

/// A greeting at a mood: one sequence of poses; the mood makes it larger and faster, and lifts the antennas.
fn greeting(mood: f64, seed: u64) -> String {
    const KEYS: [(f64, [f64; 4]); 6] = [
        (0.0, [0.0; 4]),
        (0.12, [0.2, -0.2, 0.2, 0.2]),
        (0.25, [0.2, 0.15, 0.0, 0.1]),
        (0.55, [-0.3, 0.1, 0.1, 0.25]),
        (0.75, [-0.35, -0.1, 0.3, 0.1]),
        (1.0, [0.0; 4]),
    ];
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut about = |share: f64| 1.0 + share * random.random_range(-1.0..1.0);
    let (seconds, size) = ((3.6 - 1.6 * mood) * about(0.03), 0.5 + 0.8 * mood);
    let keys = KEYS.map(|(at, pose)| (at, pose.map(|x| x * about(0.06))));
    let frames = (seconds * FPS) as usize;
    let mut text = "time_s,pan_rad,tilt_rad,left antenna_rad,right antenna_rad\n".to_owned();
    for frame in 0..=frames {
        let at = frame as f64 / frames as f64;
        let piece = keys.windows(2).find(|pair| at <= pair[1].0 + 1e-9).unwrap();
        let x = (at - piece[0].0) / (piece[1].0 - piece[0].0);
        // Minimum jerk from pose to pose.
        let part = x * x * x * (10.0 + x * (6.0 * x - 15.0));
        let lift = [0.0, -0.1, 0.25, 0.25].map(|lift| lift * mood * (std::f64::consts::PI * at).sin());
        let cell =
            |servo: usize| size * (piece[0].1[servo] + part * (piece[1].1[servo] - piece[0].1[servo])) + lift[servo];
        let cells: Vec<String> = (0..4).map(|servo| format!("{:.5}", cell(servo))).collect();
        text += &format!("{},{}\n", frame as f64 / FPS, cells.join(","));
    }
    text
}

#[test]
fn a_mood_dial_gives_the_mood_that_it_is_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    std::fs::write(at.join("desk.toml"), TABLE).unwrap();
    kinesic(at, &["robot", "import", "desk.toml", "--out", "desk.kin"]).unwrap();
    let mut labels = "file\tmood\ttake\n".to_owned();
    for take in 0..6 {
        for (step, mood) in [0.0, 0.25, 0.5, 0.75, 1.0].into_iter().enumerate() {
            let name = format!("greeting-{take}-{step}.csv");
            std::fs::write(at.join(&name), greeting(mood, 10 * take + step as u64)).unwrap();
            labels += &format!("{name}\t{mood}\t{take}\n");
        }
    }
    std::fs::write(at.join("moods.tsv"), labels).unwrap();
    let train = [
        "train",
        "emotion",
        "--robot",
        "desk.kin",
        "--labels",
        "moods.tsv",
        "--attribute",
        "mood",
        "--no-report",
        "--out",
        "mood.kin",
    ];
    kinesic(at, &train).unwrap();
    // At the robot's rate.
    let mood = PackFile::read(&at.join("mood.kin")).unwrap();
    assert_eq!(mood.pack().unwrap().metadata().frame_rate, 50.0);
    // Played, limited, written as servo numbers, and read again from the file.
    let asked: Vec<f64> = (0..=20).map(|step| f64::from(step) / 20.0).collect();
    let read = |mood: &f64| {
        kinesic(at, &["synth", "mood.kin", "--strength", &mood.to_string(), "--fps", "50", "--out", "greet.csv"])
            .unwrap();
        let text = kinesic(at, &["score", "mood.kin", "greet.csv", "--json"]).unwrap();
        let report: serde_json::Value = serde_json::from_str(&text).unwrap();
        report["clips"][0]["strength"][0].as_f64().unwrap()
    };
    let found: Vec<f64> = asked.iter().map(read).collect();
    let worst = found.iter().zip(&asked).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    let rank = kinesic_host::learn::spearman(&asked, &found);
    println!("asked of a dial and read from servo positions: Spearman {rank:.4}, off by at most {worst:.3}");
    assert!(rank > 0.99 && worst < 0.1, "{found:?}");
}

#[test]
fn a_description_becomes_a_machine_of_all_its_moving_joints() {
    let urdf = r#"<robot name="odd">
      <link name="base"/> <link name="a"/> <link name="b"/> <link name="c"/> <link name="d"/> <link name="e"/> <link name="f"/>
      <joint name="yaw" type="continuous"><parent link="base"/><child link="a"/><axis xyz="0 0 1"/><limit effort="1" velocity="3"/></joint>
      <joint name="plate" type="fixed"><parent link="a"/><child link="b"/><origin xyz="0 0 0.1" rpy="0.785398 0 0"/></joint>
      <joint name="canted" type="revolute"><parent link="b"/><child link="c"/><origin xyz="0.1 0 0"/><axis xyz="0 0.7 0.714142"/>
        <limit lower="-1" upper="2" velocity="4" effort="1"/></joint>
      <joint name="rail" type="prismatic"><parent link="c"/><child link="d"/><axis xyz="1 0 0"/><limit lower="0" upper="0.3" velocity="0.2" effort="1"/></joint>
      <joint name="claw" type="revolute"><parent link="d"/><child link="e"/><axis xyz="0 1 0"/><limit lower="0" upper="1" velocity="2" effort="1"/></joint>
      <joint name="other claw" type="revolute"><parent link="d"/><child link="f"/><axis xyz="0 1 0"/><mimic joint="claw" multiplier="-1"/>
        <limit lower="-1" upper="0" velocity="2" effort="1"/></joint>
    </robot>"#;
    let robot = Robot::parse(urdf).unwrap();
    let machine = Machine::of_robot(&robot, &ServoTable::default(), 50.0, Defaults::default()).unwrap();
    let names: Vec<&str> = machine.servos.iter().map(|servo| servo.name.as_str()).collect();
    assert_eq!(names, ["yaw", "canted", "rail", "claw"]);
    // A continuous joint counts its turns.
    assert_eq!(machine.ranges(), [[-100.0, 100.0], [-1.0, 2.0], [0.0, f64::from(0.3f32)], [0.0, 1.0]]);
    assert!(
        machine.notes.iter().any(|note| note.contains("other claw") && note.contains("follows 'claw'")),
        "{:?}",
        machine.notes
    );
    assert!(machine.notes.iter().any(|note| note.contains("no bounds are known for yaw")), "{:?}", machine.notes);
    // What is fixed is folded away: the pack's joints stand where the description's do, and turn about the same axes.
    let skeleton = &machine.rig.skeleton;
    let frames = robot.frames();
    let poses = machine.rig.clip_of(&[Default::default()], 1.0);
    let places = poses.positions(0);
    for name in names {
        let (own, other) = (places[skeleton.find(name).unwrap()], frames[robot.find(name).unwrap()].translation.vector);
        // Z up to Y up.
        assert!(
            (own.x - other.x).abs() + (own.y - other.z).abs() + (own.z + other.y).abs() < 1e-6,
            "{name}: {own} {other}"
        );
    }
    // The pack gives the machine back.
    let file = PackFile::from_bytes(&machine.pack(None, &Default::default()).unwrap());
    let back = Machine::from_pack(&file.pack().unwrap()).unwrap().unwrap();
    assert_eq!((&back.servos, &back.limits), (&machine.servos, &machine.limits));
}

#[test]
fn a_trajectory_of_ros_is_in_radians_whatever_the_servos_take() {
    let machine = Machine::of_table(&ServoTable::parse(TABLE).unwrap(), 50.0, Defaults::default()).unwrap();
    let point = |second: usize| {
        format!("- positions: [0.1, 0.2, 0.3, 0.4]\n  time_from_start: {{sec: {second}, nanosec: 0}}\n")
    };
    let text = format!("joint_names: [pan, tilt, left antenna, right antenna]\npoints:\n{}{}", point(0), point(1));
    let moves = moves::parse(text.as_bytes(), Path::new("m.yaml"), &Options::default()).unwrap();
    let clip = machine.clip(&moves, None).unwrap();
    assert_eq!(clip.coordinates(0).unwrap()[..4], [0.1f32, 0.2, 0.3, 0.4].map(f64::from));
    // Ticks are no radians on the way out either.
    let folder = tempfile::tempdir().unwrap();
    let error = machine.moves(&clip, Some(&moves)).write(&folder.path().join("m.yaml")).unwrap_err();
    assert!(error.to_string().contains("'pan' is in ticks"), "{error}");
}

#[test]
fn jerk_limits_of_a_table_are_kept_by_what_is_played_and_name_the_limiter() {
    let table = TABLE.replace("acceleration = 9000\n", "acceleration = 9000\njerk = 180000\n");
    let defaults = Defaults { jerk: Some(3000.0), ..Defaults::default() };
    let machine = Machine::of_table(&ServoTable::parse(&table).unwrap(), 50.0, defaults).unwrap();
    // The table's own, in the servo's unit, goes before the default.
    let jerks: Vec<f32> = machine.limits.joints.iter().skip(1).map(|joint| joint.jerk[0]).collect();
    assert_eq!(jerks, [3000.0, 3000.0, 3_141.592_8, 3000.0]);
    let mut text = "t,pan_deg,tilt_deg,left_antenna_deg,right_antenna_deg\n".to_owned();
    for at in 0..200 {
        let jump = if at / 40 % 2 == 0 { -30 } else { 30 };
        text += &format!("{},{jump},{},{jump},0\n", f64::from(at) / 50.0, at % 7);
    }
    let moves = moves::parse(text.as_bytes(), Path::new("m.csv"), &Options::default()).unwrap();
    let file = PackFile::from_bytes(&machine.pack(None, &Default::default()).unwrap());
    let pack = file.pack().unwrap();
    let clip = machine.clip(&moves, None).unwrap();
    let (limited, clamps) = kinesic_host::limit::play(&pack, &machine.rig, &clip).unwrap().unwrap();
    assert!(clamps.clamped_frames > 20, "{clamps:?}");
    for (at, jerk) in jerks.iter().enumerate() {
        let way: Vec<f64> = (0..200).map(|frame| limited.coordinates(frame).unwrap()[at]).collect();
        let most = way.windows(4).map(|w| (w[3] - 3.0 * w[2] + 3.0 * w[1] - w[0]).abs()).fold(0.0, f64::max);
        let bound = f64::from(*jerk) / 50f64.powi(3);
        assert!(most < 1.0001 * bound + 1e-6 && (at != 0 || most > 0.9 * bound), "{at}: {most} {bound}");
    }
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("desk.kin"), file.bytes()).unwrap();
    let text = kinesic(folder.path(), &["inspect", "desk.kin"]).unwrap();
    assert!(text.contains("SmoothLimiter::<2>"), "{text}");
    // The limiter without them refuses, and says which one has them.
    assert_eq!(Limiter::<2>::load(&pack).unwrap_err(), kinesic::LoadError::Jerk);
}

#[test]
fn sliders_and_turns_are_played_as_they_are() {
    let table =
        "[[servo]]\nname = \"lift\"\nunit = \"mm\"\nmin = 0\nmax = 200\n[[servo]]\nname = \"reel\"\nunit = \"deg\"\n";
    let machine = Machine::of_table(&ServoTable::parse(table).unwrap(), 50.0, Defaults::default()).unwrap();
    let text: String =
        (0..60).map(|t| format!("{},{},{}\n", t as f64 / 50.0, 100.0 + t as f64, 30.0 * t as f64)).collect();
    let moves = moves::parse(format!("t,lift_mm,reel_deg\n{text}").as_bytes(), Path::new("m.csv"), &Options::default())
        .unwrap();
    let clip = machine.clip(&moves, None).unwrap();
    let back = machine.moves(&clip, Some(&moves));
    for (a, b) in back.values.iter().zip(&moves.values) {
        assert!((a - b).abs() < 1e-3, "{a} {b}");
    }
    // Almost five turns.
    assert!(moves.values.last().unwrap() > &1700.0);
    // Evaluation sees sliders: 5 mm farther is 5 mm.
    let mut far = moves.clone();
    far.values.iter_mut().step_by(2).for_each(|lift| *lift += 5.0);
    let take = |moves| Measurable::new(&machine.rig, &machine.clip(moves, None).unwrap());
    let found = compare_frames(&machine.rig, &take(&moves), &take(&far)).degrees;
    let of = |name: &str| found.joints.iter().find(|joint| joint.joint == name).unwrap().clone();
    assert!((of("lift").millimetres.unwrap() - 5.0).abs() < 1e-3 && of("reel").millimetres.is_none(), "{found:?}");
}

#[test]
fn what_does_not_fit_is_refused_with_joint_found_and_expected() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    std::fs::write(at.join("desk.toml"), TABLE).unwrap();
    kinesic(at, &["robot", "import", "desk.toml", "--out", "desk.kin"]).unwrap();
    let inspect = |name: &str, text: &str| {
        std::fs::write(at.join(name), text).unwrap();
        kinesic(at, &["inspect", name, "--robot", "desk.kin"])
    };
    let rows = "0,1,2,3,4\n0.02,1,2,3,4\n";
    let refused = inspect("a.csv", &format!("t,pan_deg,tilt_deg,left_antenna_deg,elbow_deg\n{rows}")).unwrap_err();
    assert!(refused.contains("right antenna") && refused.contains("elbow"), "{refused}");
    let refused = inspect("b.csv", &format!("t,pan,tilt,left_antenna,right_antenna\n{rows}")).unwrap_err();
    assert!(refused.contains("'pan'") && refused.contains("ticks") && refused.contains("--angles deg"), "{refused}");
    let refused =
        inspect("c.csv", &format!("t,pan_mm,tilt_deg,left_antenna_deg,right_antenna_deg\n{rows}")).unwrap_err();
    assert!(refused.contains("'pan'") && refused.contains("found mm"), "{refused}");
    // Named as people do, in the servos' own numbers.
    let fits = "0,2100,2000,91,1500\n0.02,2110,2000,92,1510\n";
    let text = inspect("d.csv", &format!("t,Pan,TILT,left-antenna,rightAntenna\n{fits}")).unwrap();
    assert!(
        text.contains("Fits the robot 'desk robot'")
            && text.contains("names no unit")
            && text.contains("left antenna (deg)"),
        "{text}"
    );
    // A robot's motion without a robot, and a body's clip for a robot.
    let alone = kinesic(at, &["export", "d.csv", "--out", "x.bvh"]).unwrap_err();
    assert!(alone.contains("--robot ROBOT.kin"), "{alone}");
    for (table, words) in [
        ("[[servo]]\nname = \"a\"\n", ["'a'", "no unit"]),
        ("[[servo]]\nname = \"a\"\nunit = \"furlong\"\n", ["furlong", "ticks"]),
        ("[[servo]]\nname = \"a\"\nunit = \"ticks\"\n", ["per_turn", "nothing"]),
        ("[[servo]]\nname = \"a\"\nunit = \"deg\"\nmin = 4\nmax = 1\n", ["max", "more than min"]),
        (
            "[[servo]]\nname = \"a\"\nid = 1\nunit = \"deg\"\n[[servo]]\nname = \"b\"\nid = 1\nunit = \"deg\"\n",
            ["'b'", "id 1"],
        ),
        ("[[servo]]\nname = \"a\"\nunit = \"deg\"\nspeeed = 1\n", ["speeed", "speed"]),
    ] {
        std::fs::write(at.join("bad.toml"), table).unwrap();
        let refused = kinesic(at, &["robot", "import", "bad.toml", "--out", "bad.kin"]).unwrap_err();
        assert!(words.iter().all(|word| refused.contains(word)), "{table}: {refused}");
        assert!(refused.contains("bad.toml") && !at.join("bad.kin").exists(), "{refused}");
    }
}
