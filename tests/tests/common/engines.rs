//! Every engine behind the limiter, on the made gait's skeleton: packs that are seeded, not trained.
#![allow(dead_code, missing_docs, clippy::needless_range_loop, reason = "each test file uses a part")]

use std::path::Path;

use faer::Mat;
use kinesic::mechanics::{BodyMechanics, FEATURES};
use kinesic::model::{Kind, MechanicsMeta, ModelMeta};
use kinesic::{Components, Emotion, LoadError, Pack, Pipeline, PipelineState, Pose, Translator};
use kinesic_host::clip::JointMap;
use kinesic_host::components::{ComponentsModel, Factors};
use kinesic_host::emotion::made;
use kinesic_host::gait;
use kinesic_host::pack::{PackFile, PackWriter, Provenance};
use kinesic_host::rig::Rig;
use nalgebra::{UnitQuaternion, Vector3};

use crate::robot::{JOINTS, limits};

const UNITS: usize = 24;
const CODE: usize = 10;
const COUNT: usize = 8;
const KEYS: usize = 5;

pub type Device<'a> = Pipeline<'a, JOINTS, 1024, { UNITS + 12 }, 20, COUNT, KEYS>;
pub type State = PipelineState<JOINTS, 1024, 20, KEYS>;

pub const ENGINES: [&str; 7] = [
    "limit alone",
    "translator, whole body",
    "translator, per joint",
    "body mechanics",
    "style components",
    "emotion",
    "pipeline",
];

/// A new state with half of the expression: all of it would be the source itself.
pub fn new_state(engine: &str) -> State {
    let mut state = State::new();
    state.modulation.amount = 0.5;
    // In the pipeline the source counts, and the motion that looks at no frame plays along unseen.
    state.weights.emotion = if engine == "emotion" { 1.0 } else { 0.0 };
    state.emotion.strength[0] = 0.5;
    state
}

/// A small generator: the same numbers everywhere.
#[derive(Clone, Copy, Debug)]
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        self.0 >> 33
    }

    /// -1 to 1.
    pub fn unit(&mut self) -> f32 {
        (self.next() % 20_001) as f32 * 1e-4 - 1.0
    }
}

pub fn rig() -> Rig {
    let skeleton = gait::skeleton();
    Rig::new(&skeleton, &JointMap::detect(&skeleton).unwrap()).unwrap()
}

/// Files of all engines.
pub struct Packs {
    pub body: PackFile,
    pub joint: PackFile,
    pub mechanics: PackFile,
    pub components: PackFile,
    pub emotion: PackFile,
    pub limits: PackFile,
}

impl Packs {
    pub fn new() -> Self {
        let golden =
            |name: &str| PackFile::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("packs/v1").join(name)).unwrap();
        Self {
            body: golden("translator-whole-body.kin"),
            joint: golden("translator-per-joint.kin"),
            mechanics: PackFile::from_bytes(&mechanics()),
            components: PackFile::from_bytes(&components()),
            emotion: PackFile::from_bytes(&emotion()),
            limits: PackFile::from_bytes(&limits_pack()),
        }
    }

    pub fn device(&self, name: &str) -> Device<'_> {
        self.load(name).unwrap()
    }

    fn load(&self, name: &str) -> Result<Device<'_>, LoadError> {
        fn open(file: &PackFile) -> Result<Pack<'_>, LoadError> {
            file.pack()
        }
        let limiter = kinesic::Limiter::load(&open(&self.limits)?)?;
        let device = Device::new(limiter);
        let (body, joint) = (open(&self.body)?, open(&self.joint)?);
        let (mechanics, components, emotion) = (open(&self.mechanics)?, open(&self.components)?, open(&self.emotion)?);
        match name {
            "limit alone" => Ok(device),
            "translator, whole body" => device.with_translator(Translator::load(&body)?),
            "translator, per joint" => device.with_translator(Translator::load(&joint)?),
            "body mechanics" => device.with_mechanics(BodyMechanics::load(&mechanics)?),
            "style components" => device.with_components(Components::load(&components)?),
            "emotion" => device.with_emotion(Emotion::load(&emotion)?),
            _ => device
                .with_translator(Translator::load(&body)?)?
                .with_mechanics(BodyMechanics::load(&mechanics)?)?
                .with_components(Components::load(&components)?)?
                .with_emotion(Emotion::load(&emotion)?),
        }
    }
}

pub fn mechanics() -> Vec<u8> {
    let mut random = Random(5);
    let mut values = |count: usize, size: f32| (0..count).map(|_| size * random.unit()).collect::<Vec<f32>>();
    let mut pack = PackWriter::new(Kind::Mechanics, "made", 60.0);
    rig().write(&mut pack);
    pack.model(&ModelMeta::Mechanics(MechanicsMeta {
        hidden: UNITS as u32,
        code: CODE as u32,
        body_height: 1.7,
        hip_height: 0.95,
        gain: 2.0,
        exponent: 4,
    }));
    pack.u16s("mechanics/feet", 4, &[3, 4, 7, 8]);
    pack.f32s("mechanics/clearance", 4, &[0.08, 0.02, 0.08, 0.02]);
    pack.u16s("mechanics/thighs", 2, &[1, 5]);
    pack.f32s("mechanics/feature_mean", FEATURES, &[0.0; FEATURES]);
    pack.f32s("mechanics/feature_inverse_deviation", FEATURES, &[1.0; FEATURES]);
    let outputs = 4 * (JOINTS - 1);
    pack.tiled("mechanics/hidden", FEATURES, &values(UNITS * FEATURES, 0.3));
    pack.f32s("mechanics/hidden_bias", UNITS, &values(UNITS, 0.1));
    pack.tiled("mechanics/code", UNITS, &values(CODE * UNITS, 0.3));
    pack.f32s("mechanics/code_bias", CODE, &values(CODE, 0.1));
    pack.tiled("mechanics/decoder", CODE, &values(outputs * CODE, 0.05));
    let rest: Vec<f32> = (0..outputs).map(|at| if at % 4 == 3 { 1.0 } else { 0.0 }).collect();
    pack.f32s("mechanics/decoder_bias", outputs, &rest);
    pack.finish(&Provenance::default())
}

pub fn components() -> Vec<u8> {
    let mut random = Random(7);
    let rig = rig();
    let rest = [rig.poses(&rig.clip(&[Pose::identity()], 1.0 / 60.0))[0]];
    let mean = rig.locals(&rest).positions;
    let mut matrix =
        |rows: usize, columns: usize, size: f32| Mat::from_fn(rows, columns, |_, _| f64::from(size * random.unit()));
    let (directions, change) = (matrix(3 * JOINTS, COUNT, 0.5), matrix(3 * JOINTS, COUNT, 0.1));
    let weights = matrix(10, COUNT, 1.0);
    let model = ComponentsModel {
        style: "made".to_owned(),
        frame_rate: 60.0,
        shift: vec![0.01; mean.len()],
        mean,
        scale: 0.1,
        learned: &directions + &change,
        content: Factors { weights, components: directions },
        track: vec![[0.0, 0.02, 0.0, 1.0]; 10],
        reference: vec![[0.0, 0.0, 0.0, 1.0]; JOINTS],
        strength: [0.0, 1.0],
    };
    model.pack(&rig, &Provenance::default())
}

pub fn emotion() -> Vec<u8> {
    let (model, rig) = made::sized(1, [KEYS, COUNT, 3]);
    model.pack(&rig, &Provenance::default())
}

pub fn limits_pack() -> Vec<u8> {
    limits().pack(&rig(), &Provenance::default())
}

/// Random valid input that goes on for ever: every joint turns about an axis of its own, at speeds that change, along a path.
#[derive(Clone, Debug)]
pub struct Motion {
    random: Random,
    angle: [f32; JOINTS],
    speed: [f32; JOINTS],
    root: Vector3<f32>,
}

impl Motion {
    pub fn new(seed: u64) -> Self {
        Self { random: Random(seed), angle: [0.0; JOINTS], speed: [0.0; JOINTS], root: Vector3::new(0.0, 0.95, 0.0) }
    }

    pub fn next(&mut self) -> Pose<JOINTS> {
        let mut pose = Pose::identity();
        for (joint, q) in pose.rotations.iter_mut().enumerate() {
            let (angle, speed) = (&mut self.angle[joint], &mut self.speed[joint]);
            *speed += 0.002 * self.random.unit() - 0.002 * *angle - 0.03 * *speed;
            *angle += *speed;
            let axis = [Vector3::x(), Vector3::new(0.6, 0.8, 0.0), Vector3::new(0.0, 0.6, 0.8)][joint % 3];
            *q = UnitQuaternion::from_scaled_axis(axis * *angle);
        }
        self.root += Vector3::new(0.01 * self.random.unit(), 0.0, 0.01 * self.random.unit()) - self.root * 1e-4;
        self.root.y = 0.95 + 0.02 * self.angle[0];
        pose.root = self.root;
        pose
    }
}
