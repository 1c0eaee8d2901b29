//! Seeds of robots as machines: descriptions with servos, tables, moves, maps of limbs.

/// Target, name and text.
pub fn seeds() -> Vec<(&'static str, &'static str, String)> {
    let elbow = "[[servo]]\nname = \"elbow\"\nunit = \"deg\"\nsign = -1\nspeed = 90\n";
    let [leader, turned] = [format!("{URDF}\0{SERVOS_OF_IT}"), format!("{MJCF}\0{elbow}")];
    let all: [(&str, &str, &str); 19] = [
        ("robot", "leader.urdf", &leader),
        ("robot", "arm.xml", MJCF),
        ("robot", "servos.xml", &turned),
        ("robot", "small.urdf", SMALL),
        ("servos", "desk.toml", SERVOS),
        ("servos", "pose.toml", POSE),
        ("servos", "tree.toml", TREE),
        (
            "moves",
            "units.csv",
            "time_s,pan_deg,tilt_ticks,eyes\n0,1,2048,open\n0.02,1.5,2050,\"half, shut\"\n0.04,2,2060,shut\n",
        ),
        ("moves", "semicolons.csv", "# made\nt;pan_deg;tilt_deg\n0;1,5;2\n0,1;1,75;3\n0,2;2;-3e0\n"),
        (
            "moves",
            "columns.json",
            r#"{"fps": 50, "unit": "deg", "joints": {"pan": [1, 2, 3], "tilt": [0, -1, 1.5e0]}, "by": "us"}"#,
        ),
        ("moves", "frames.json", r#"{"joint_names": ["pan", "tilt"], "times": [0, 0.02], "frames": [[1, 0], [2, 1]]}"#),
        (
            "moves",
            "rows.json",
            r#"[{"time": 0, "pan_rad": 0.1, "tilt": 2048}, {"time": 0.5, "pan_rad": 0.2, "tilt": 2000}]"#,
        ),
        (
            "moves",
            "rows.jsonl",
            "{\"time\": 0, \"pan_deg\": 1, \"tilt_deg\": 0, \"note\": \"a\"}\n{\"time\": 0.1, \"pan_deg\": 2, \"tilt_deg\": 1, \"note\": null}\n",
        ),
        ("moves", "reachy.json", REACHY),
        ("moves", "trajectory.yaml", TRAJECTORY),
        (
            "moves",
            "lerobot.jsonl",
            "{\"timestamp\": 0, \"episode_index\": 0, \"action\": [1, 2]}\n{\"timestamp\": 0.02, \"episode_index\": 0, \"action\": [1.5, 2.5]}\n{\"timestamp\": 0, \"episode_index\": 1, \"action\": [9, 8]}\n{\"timestamp\": 0.02, \"episode_index\": 1, \"action\": [8, 8]}\n",
        ),
        (
            "limbs",
            "arm.toml",
            "forward = \"x\"\nup = \"z\"\n[limbs]\nl_upper_arm = [\"roll\", \"elbow\"]\nl_forearm = { from = \"elbow\", bone = [0, 0, -1] }\n[hold]\npitch = 0.1\n",
        ),
        (
            "limbs",
            "whole.toml",
            "[limbs]\nl_arm = { from = \"roll\", to = \"hand\", length = 0.5, weight = 2 }\nhead = \"d\"\n",
        ),
        ("limbs", "wrong.toml", "forward = \"-y\"\n[limbs]\nl_foot = \"nothing\"\nl_hand = [\"elbow\", \"hand\"]\n"),
    ];
    all.into_iter().map(|(target, name, text)| (target, name, text.to_owned())).collect()
}

const URDF: &str = "<robot name='two'><link name='base'/><link name='a'/><link name='b'/><link name='c'/><link name='d'/>\
<joint name='left_shoulder_pitch' type='revolute'><parent link='base'/><child link='a'/><origin xyz='0 0.2 0.4' rpy='0.1 0 0'/><axis xyz='0 1 0'/>\
<limit lower='-1' upper='1.5' velocity='7' effort='2'/></joint>\
<joint name='left_elbow' type='revolute'><parent link='a'/><child link='b'/><origin xyz='0 0 -0.3'/><axis xyz='0 1 0'/>\
<limit lower='-2' upper='0' velocity='7'/><safety_controller soft_lower_limit='-1.9' soft_upper_limit='-0.1'/></joint>\
<joint name='left_wrist' type='continuous'><parent link='b'/><child link='c'/><origin xyz='0 0 -0.25'/><axis xyz='0 0 1'/></joint>\
<joint name='grip' type='prismatic'><parent link='c'/><child link='d'/><axis xyz='1 0 0'/><limit lower='0' upper='0.04' velocity='0.1'/>\
<mimic joint='left_wrist' multiplier='0.01' offset='0.02'/></joint></robot>";
const SERVOS_OF_IT: &str = "name = \"two\"\n[[servo]]\nname = \"left_elbow\"\nid = 4\nunit = \"ticks\"\nper_turn = 4096\nzero = 2048\nsign = -1\nspeed = 2000\n";
const SMALL: &str = "<?xml version='1.0'?><robot name='s'><link name='l'/><link name='m'/><joint name='turn' type='revolute'>\
<parent link='l'/><child link='m'/><limit lower='-1e16' upper='inf'/></joint></robot>";
const MJCF: &str = "<mujoco model='m'><compiler angle='degree' eulerseq='xyz'/><default><joint range='-90 90'/><default class='slow'>\
<joint range='-30 60' axis='0 1 0'/></default></default><worldbody><body name='pelvis' pos='0 0 0.8'><freejoint/>\
<body name='torso' pos='0 0 0.1' childclass='slow'><joint name='waist' axis='0 0 1'/><body name='arm' pos='0 0.2 0.3' euler='45 0 0'>\
<joint name='roll' pos='0 0.1 0'/><body name='fore' pos='0 0.3 0' quat='1 0 0 0'><joint name='elbow' ref='20' range='0 120'/>\
<site name='tip' pos='0 0 -0.2'/></body></body></body><body name='left' axisangle='0 0 1 180'><joint name='grip' type='slide' range='0 0.04'/>\
</body><body name='right' xyaxes='0 1 0 -1 0 0'><joint name='grip2' type='slide' range='0 0.04'/></body></body></worldbody>\
<equality><joint joint1='grip2' joint2='grip' polycoef='0.01 0.5 0 0 0'/></equality></mujoco>";

const SERVOS: &str = "name = \"desk\"\n[[servo]]\nname = \"pan\"\nid = 1\nunit = \"deg\"\nmin = -90\nmax = 90\nspeed = 120\nacceleration = 900\n\
[[servo]]\nname = \"tilt\"\nid = 2\nunit = \"ticks\"\nper_turn = 4096\nzero = 2048\nmin = 1024\nmax = 3072\nrest = 2000\njerk = 1e6\n";
const POSE: &str = "[[servo]]\nname = \"ear\"\nunit = \"rad\"\nmin = -1\nmax = 1\n[[pose]]\nname = \"head\"\n\
min = [-0.02, -0.02, -0.02, -0.7, -0.7, -3.1]\nmax = [0.02, 0.02, 0.02, 0.7, 0.7, 3.1]\n";
const TREE: &str = "[[servo]]\nname = \"base\"\nunit = \"us\"\nper_turn = 4000\nzero = 1500\nmin = 500\nmax = 2500\naxis = [0, 0, 1]\n\
[[servo]]\nname = \"lift\"\nunit = \"mm\"\nmin = 0\nmax = 40\nparent = \"base\"\noffset = [0, 0, 0.1]\naxis = [0, 0, 1]\n";

const REACHY: &str = r#"{"description": "nod", "time": [0, 0.02], "set_target_data": [{"head": [[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]], "antennas": [0.1, -0.1], "body_yaw": 0}, {"head": [[0.96,0,0.28,0.01],[0,1,0,0],[-0.28,0,0.96,0],[0,0,0,1]], "antennas": [0.2, 0], "body_yaw": 0.1}]}"#;
const TRAJECTORY: &str = "header: {frame_id: base}\njoint_names: [pan, tilt]\npoints:\n- positions: [0.1, 0.2]\n  time_from_start: {sec: 0, nanosec: 0}\n\
- positions: [0.3, 1.0]\n  time_from_start: {sec: 1, nanosec: 500000000}\n";
