//! Makes the seeds of the fuzz targets: small, ours, and one for every path that matters.

use std::path::Path;

use kinesic_host::clip::{Clip, Unit, WriteOptions};
use kinesic_host::components::{self, Optimiser};
use kinesic_host::gait::{Manner, walk};
use kinesic_host::limit::{JointLimit, LimitsModel};
use kinesic_host::mechanics::{self, NamedClip, Split};
use kinesic_host::pack::Provenance;
use kinesic_host::translate::FormChoice;

use crate::{common, machines};

/// Writes all of them below `corpus`.
pub fn write(corpus: &Path) {
    let put = |target: &str, name: &str, bytes: &[u8]| {
        let folder = corpus.join(target);
        std::fs::create_dir_all(&folder).unwrap();
        std::fs::write(folder.join(name), bytes).unwrap();
    };
    for (name, bytes) in packs() {
        put("pack", name, &bytes);
    }
    for (name, text) in motions() {
        put("bvh", name, text.as_bytes());
    }
    for (name, bytes) in scenes() {
        put("gltf", name, &bytes);
    }
    for (name, text) in recordings() {
        put("csv", name, text.as_bytes());
    }
    for (name, text) in robots() {
        put("urdf", name, text.as_bytes());
    }
    for (target, name, text) in machines::seeds() {
        put(target, name, text.as_bytes());
    }
    let maps = [
        (
            "whole.toml",
            "units = \"cm\"\nup = \"y\"\n[joints]\npelvis = \"Hips\"\nl_hip = \"LeftUpLeg\"\nr_hip = \"RightUpLeg\"\nhead = \"Head\"\n",
        ),
        ("pelvis.toml", "[joints]\npelvis = \"Hips\"\n"),
        ("quoted.toml", "[joints]\n'pelvis' = 'Hip \\u00e9' # a name\nl_knee = \"\"\n"),
        ("wrong.toml", "unit = 3\n[joints]\npelvs = 1.5e3\n"),
    ];
    maps.iter().for_each(|(name, text)| put("map", name, text.as_bytes()));
}

/// One pack an engine and form, as small as they come.
fn packs() -> Vec<(&'static str, Vec<u8>)> {
    let rig = common::rig();
    let origin = Provenance { tool: "seed".into(), ..Provenance::default() };
    let mut packs = Vec::new();
    for (name, form) in [("translator-joint.kin", FormChoice::PerJoint), ("translator-body.kin", FormChoice::WholeBody)]
    {
        packs.push((name, common::trained(form, 2).model.pack(&rig, &origin)));
    }
    let clip = |manner: &Manner, seed| NamedClip {
        name: "walk".into(),
        clip: walk(manner, 2.0, 60.0, 0.0, seed),
        mechanics: true,
    };
    let clips = [clip(&Manner::NEUTRAL, 1), clip(&Manner::WEARY, 2)];
    let options = mechanics::TrainOptions { code: 2, hidden: 3, epochs: 2, hold_out: 0.0, split: Split::Clip, seed: 1 };
    let trained = mechanics::train(&rig, &clips, "seed", &options, &|_, _, _, _| ()).unwrap();
    packs.push(("mechanics.kin", trained.model.pack(&rig, &origin)));
    let options = components::TrainOptions {
        count: Some(2),
        optimiser: Optimiser { max_steps: 5, ..Optimiser::default() },
        ..components::TrainOptions::default()
    };
    let short = |manner: &Manner, seed| walk(manner, 0.3, 60.0, 0.0, seed);
    let trained =
        components::train(&rig, &short(&Manner::NEUTRAL, 1), &short(&Manner::WEARY, 2), "seed", &options).unwrap();
    packs.push(("components.kin", trained.model.pack(&rig, &origin)));
    let (model, rig) = kinesic_host::emotion::synthetic::sized(1, [3, 2, 2]);
    packs.push(("emotion.kin", model.pack(&rig, &origin)));
    let mut limits = LimitsModel::free("seed", 60.0, &rig, 6.0, 60.0);
    let (x, y, z) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
    limits.joints[1] = JointLimit::hinge(x, [-0.1, 2.3], 9.0, 110.0);
    limits.joints[2] = JointLimit::chain([x, y, z], [-1.6; 3], [1.3; 3], 7.0, 90.0);
    limits.joints[3] = JointLimit::ball([-0.7; 3], [0.9; 3], 5.0, 60.0);
    packs.push(("limits.kin", limits.pack(&rig, &origin).unwrap()));
    packs
}

/// An arm, the same with a map behind it, and one that turns, follows and slides.
fn robots() -> Vec<(&'static str, String)> {
    let joint = |name: &str, kind: &str, [from, to]: [&str; 2], rest: &str| {
        format!(
            "<link name='{to}'/><joint name='{name}' type='{kind}'><parent link='{from}'/><child link='{to}'/>{rest}</joint>"
        )
    };
    let limit = "<limit lower='-1' upper='1.5' velocity='7' effort='2'/>";
    let hinge = |axis: &str| format!("<origin xyz='0 0 -0.2' rpy='0 0 0'/><axis xyz='{axis}'/>{limit}");
    let arm = [
        "<robot name='arm'><link name='base'/>".to_owned(),
        joint("pitch", "revolute", ["base", "a"], &hinge("0 1 0")),
        joint("roll", "revolute", ["a", "b"], &hinge("1 0 0")),
        joint("yaw", "revolute", ["b", "c"], &hinge("0 0 1")),
        joint("elbow", "revolute", ["c", "d"], &hinge("0 1 0")),
        "</robot>".to_owned(),
    ]
    .concat();
    let map = "acceleration = 3\nup = \"z\"\nunmapped = \"fixed\"\n[joints]\nl_elbow = { urdf = \"elbow\", lower = -0.5, bone = [0, 0, 1] }\n\
               l_shoulder = { kind = \"ball\", urdf = [\"pitch\", \"roll\"], rest = [0.1, 0], velocity = 2 }\n";
    let odd = [
        "<?xml version='1.0'?><robot name='odd'><link name='base'/>".to_owned(),
        joint("elbow", "continuous", ["base", "a"], "<axis xyz='0 0 2'/><limit velocity='3'/>"),
        joint("grip", "revolute", ["a", "b"], &format!("{limit}<mimic joint='elbow' multiplier='-0.2' offset='0.3'/>")),
        joint("slide", "prismatic", ["a", "c"], &hinge("0 1 0")),
        "</robot>".to_owned(),
    ]
    .concat();
    let alone = "acceleration = 3\n[joints]\nl_elbow = \"elbow\"\n";
    vec![("arm.urdf", arm.clone()), ("mapped.urdf", format!("{arm}\0{map}")), ("odd.urdf", format!("{odd}\0{alone}"))]
}

/// The writer's dialect, another unit, and dialects that the writer does not speak.
fn motions() -> Vec<(&'static str, String)> {
    let walk: Clip = walk(&Manner::NEUTRAL, 0.1, 60.0, 0.0, 1);
    let odd = "hierarchy\r\nROOT Scene {\r\n OFFSET 0 0 0\r\n CHANNELS 0\r\n JOINT Hips {\r\n  OFFSET 0 90 0\r\n  CHANNELS 6 Xposition \
               Yposition Zposition Yrotation Xrotation Zrotation\r\n  JOINT LeftUpLeg {\r\n   OFFSET 9 -6 0\r\n   CHANNELS 1 Xrotation\r\n   \
               End Site { OFFSET 0 -80 0 }\r\n  }\r\n  JOINT RightUpLeg {\r\n   OFFSET -9 -6 0\r\n   CHANNELS 3 Xposition Yposition \
               Zposition\r\n   End tip { OFFSET 0 -80 0 }\r\n  }\r\n }\r\n}\r\nMOTION\r\nFrames : 2\r\nFrame Time : 0.04\r\n1 90 2 3 4 5 6 -9 -6 \
               0\r\n1 91 2e0 -3 +4 5. .6 -9.1 -6 0\r\n";
    let stick = "HIERARCHY ROOT a { OFFSET 0 0 0 CHANNELS 3 Zrotation Xrotation Yrotation End Site { OFFSET 0 170 0 } } MOTION\n\
                 Frames: 1\nFrame Time: 0.033333\n1 2 3\n";
    vec![
        ("walk.bvh", walk.to_bvh(&WriteOptions::default()).unwrap()),
        ("metres.bvh", walk.to_bvh(&WriteOptions { units: Unit::Metre }).unwrap()),
        ("odd.bvh", odd.to_owned()),
        ("stick.bvh", stick.to_owned()),
    ]
}

/// What the writer makes of two joints, as bytes and as text; a scene without a skin with sparse, cubic, stepped and whole-number keys.
fn scenes() -> Vec<(&'static str, Vec<u8>)> {
    let mut stick: Clip = walk(&Manner::NEUTRAL, 0.1, 60.0, 0.0, 1).with_joints(&mut hips());
    stick.root.truncate(3);
    stick.rotations.truncate(3 * stick.skeleton.len());
    let whole = walk(&Manner::NEUTRAL, 0.1, 30.0, 0.0, 1);
    // Times 0, 1/2, 1; quaternions as shares of 127; one place out of a sparse list.
    let numbers = "AAAAAAAAAD8AAIA/AAAAfwB/AAAAAH8AAQAAAAAAgD8AAIA/AACAPw==";
    let view = |at: usize, length: usize| format!("{{\"buffer\":0,\"byteOffset\":{at},\"byteLength\":{length}}}");
    let odd = format!(
        "{{\"asset\":{{\"version\":\"2.0\"}},\"buffers\":[{{\"byteLength\":40,\"uri\":\"data:application/octet-stream;base64,{numbers}\"}}],\
         \"bufferViews\":[{},{},{},{}],\"accessors\":[{{\"bufferView\":0,\"componentType\":5126,\"type\":\"SCALAR\",\"count\":3,\
         \"min\":[0],\"max\":[1]}},{{\"bufferView\":1,\"componentType\":5120,\"normalized\":true,\"type\":\"VEC4\",\"count\":3}},\
         {{\"componentType\":5126,\"type\":\"VEC3\",\"count\":3,\"sparse\":{{\"count\":1,\"indices\":{{\"bufferView\":2,\
         \"componentType\":5121}},\"values\":{{\"bufferView\":3}}}}}}],\"nodes\":[{{\"name\":\"Hips\",\"children\":[1,2]}},\
         {{\"name\":\"Head\",\"translation\":[0,0.7,0],\"scale\":[2,2,2]}},{{\"name\":\"LeftFoot\",\"matrix\":[1,0,0,0,0,1,0,0,0,0,1,0,0.1,-0.9,0,1]}}],\
         \"scenes\":[{{\"nodes\":[0]}}],\"animations\":[{{\"samplers\":[{{\"input\":0,\"output\":1,\"interpolation\":\"STEP\"}},{{\"input\":0,\
         \"output\":2}}],\"channels\":[{{\"sampler\":0,\"target\":{{\"node\":0,\"path\":\"rotation\"}}}},{{\"sampler\":0,\"target\":{{\"node\":1,\
         \"path\":\"rotation\"}}}},{{\"sampler\":1,\"target\":{{\"node\":0,\"path\":\"translation\"}}}}]}}]}}",
        view(0, 12),
        view(12, 12),
        view(24, 4),
        view(28, 12)
    );
    vec![
        ("stick.glb", stick.to_glb().unwrap()),
        ("stick.gltf", stick.to_gltf().unwrap().into_bytes()),
        ("walk.glb", whole.to_glb().unwrap()),
        ("odd.gltf", odd.into_bytes()),
    ]
}

/// Of the made walk the hips and one foot with what carries it.
fn hips() -> Vec<bool> {
    let skeleton = kinesic_host::gait::skeleton();
    let foot = skeleton.find("LeftFoot");
    (0..skeleton.len()).map(|joint| Some(joint) == foot).collect()
}

/// A person who stands, one with gaps, one without a body.
fn recordings() -> Vec<(&'static str, String)> {
    const BODY: [(&str, [f64; 3]); 20] = [
        ("HipCenter", [0.0, 0.9, 2.5]),
        ("Spine", [0.0, 1.0, 2.5]),
        ("ShoulderCenter", [0.0, 1.4, 2.5]),
        ("Head", [0.0, 1.6, 2.5]),
        ("ShoulderLeft", [-0.2, 1.35, 2.5]),
        ("ElbowLeft", [-0.25, 1.1, 2.5]),
        ("WristLeft", [-0.27, 0.85, 2.4]),
        ("HandLeft", [-0.27, 0.78, 2.4]),
        ("ShoulderRight", [0.2, 1.35, 2.5]),
        ("ElbowRight", [0.25, 1.1, 2.5]),
        ("WristRight", [0.27, 0.85, 2.4]),
        ("HandRight", [0.27, 0.78, 2.4]),
        ("HipLeft", [-0.1, 0.85, 2.5]),
        ("KneeLeft", [-0.1, 0.45, 2.5]),
        ("AnkleLeft", [-0.1, 0.1, 2.5]),
        ("FootLeft", [-0.1, 0.05, 2.4]),
        ("HipRight", [0.1, 0.85, 2.5]),
        ("KneeRight", [0.1, 0.45, 2.5]),
        ("AnkleRight", [0.1, 0.1, 2.5]),
        ("FootRight", [0.1, 0.05, 2.4]),
    ];
    let header: Vec<String> =
        BODY.iter().flat_map(|(name, _)| ["X", "Y", "Z"].map(|axis| format!("{name}{axis}"))).collect();
    let table = |cell: &dyn Fn(usize, usize, f64) -> String| {
        let row = |row: usize| {
            let values = BODY.iter().flat_map(|(_, position)| *position).enumerate();
            let cells: Vec<String> = values.map(|(column, value)| cell(row, column, value)).collect();
            format!("{},{}\n", 33 * row, cells.join(","))
        };
        format!("Timestamp,{}\n{}", header.join(","), (0..4).map(row).collect::<String>())
    };
    vec![
        ("stands.csv", table(&|row, _, value| format!("{:.3}", value + 0.01 * row as f64))),
        (
            "gaps.csv",
            table(&|row, column, value| match (row + column) % 5 {
                0 if row == 1 => String::new(),
                1 if row == 2 => "NaN".into(),
                _ => format!("{value}"),
            }),
        ),
        ("point.csv", table(&|_, _, _| "0".into())),
    ]
}
