//! Every engine behind the limiter, on the made gait's skeleton: packs that are seeded, not trained.
#![allow(dead_code, missing_docs, clippy::needless_range_loop, reason = "each test file uses a part")]

use std::path::Path;

use faer::Mat;
use kinesic::engine::{Engine, FromPack, Mix};
use kinesic::mechanics::{Expression, FEATURES};
use kinesic::model::{Kind, MechanicsMeta, ModelMeta};
use kinesic::{Components, Emotion, LimitState, Limiter, Pipeline, PipelineState, Pose, Translator};
use kinesic_host::clip::JointMap;
use kinesic_host::components::{ComponentsModel, Factors};
use kinesic_host::emotion::synthetic;
use kinesic_host::gait::{self, Manner};
use kinesic_host::limit::{JointLimit, LimitsModel};
use kinesic_host::pack::{PackFile, PackWriter, Provenance};
use kinesic_host::rig::Rig;
use nalgebra::{UnitQuaternion, Vector3};

use crate::robot::{JOINTS, RATE, ROWS, limits};

const UNITS: usize = 24;
const CODE: usize = 10;
const COUNT: usize = 8;
const KEYS: usize = 5;

pub type Mechanics<'a> = Expression<'a, JOINTS, { UNITS + 12 }, 20>;
pub type Translate<'a> = Translator<'a, ROWS, 1024>;
pub type Restyle<'a> = Components<'a, ROWS, COUNT>;
pub type Feel<'a> = Emotion<'a, ROWS, KEYS, COUNT>;
pub type Limit<'a> = Limiter<'a, ROWS>;

/// The mean of what is there, then limits.
pub type Engines<'a> =
    (Mix<(Option<Mechanics<'a>>, Option<Translate<'a>>, Option<Restyle<'a>>, Option<Feel<'a>>)>, Limit<'a>);
pub type Device<'a> = Pipeline<'a, Engines<'a>, ROWS>;
pub type EngineState = <Engines<'static> as Engine<ROWS>>::State;
pub type State = PipelineState<EngineState, ROWS>;

pub const ENGINES: [&str; 8] = [
    "limits alone",
    "limits of hinges and chains",
    "translator, whole body",
    "translator, per joint",
    "body mechanics",
    "style components",
    "emotion",
    "pipeline",
];

/// What of the mean an engine is: mechanics, translator, components, emotion, and the source.
pub fn weights(engine: &str) -> ([f32; 4], f32) {
    match engine {
        "translator, whole body" | "translator, per joint" => ([0.0, 1.0, 0.0, 0.0], 0.0),
        "body mechanics" => ([1.0, 0.0, 0.0, 0.0], 0.0),
        "style components" => ([0.0, 0.0, 1.0, 0.0], 0.0),
        "emotion" => ([0.0, 0.0, 0.0, 1.0], 0.0),
        // In the pipeline the source counts, and the motion that looks at no frame plays along unseen.
        "pipeline" => ([1.0, 1.0, 1.0, 0.0], 1.0),
        _ => ([0.0; 4], 1.0),
    }
}

/// A new state with half of the expression: all of it would be the source itself. The source cannot hold still.
pub fn new_state(engine: &str) -> State {
    let mut state = State::new();
    let (mix, _) = &mut state.engine;
    (mix.weights, mix.source) = weights(engine);
    mix.engines.0.modulation.amount = 0.5;
    mix.engines.3.strength[0] = 0.5;
    state.guard.frozen = 60;
    state
}

/// The limiter's memory.
pub fn limit_state(state: &State) -> &LimitState<ROWS> {
    &state.engine.1
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
    /// Every joint a ball, as in the packs of the engines.
    pub balls: PackFile,
    /// Hinges, chains and balls.
    pub limits: PackFile,
}

/// An engine of a pack that has it.
pub fn engine<'a, E: FromPack<'a>>(file: &'a PackFile) -> E {
    E::from_pack(&file.pack().unwrap()).unwrap()
}

impl Packs {
    pub fn new() -> Self {
        Self {
            body: golden("translator-whole-body.kin"),
            joint: golden("translator-per-joint.kin"),
            mechanics: PackFile::from_bytes(&mechanics()),
            components: PackFile::from_bytes(&components()),
            emotion: PackFile::from_bytes(&emotion()),
            balls: PackFile::from_bytes(&balls_pack()),
            limits: PackFile::from_bytes(&limits_pack()),
        }
    }

    pub fn device(&self, name: &str) -> Device<'_> {
        let limits = if name == "limits of hinges and chains" { &self.limits } else { &self.balls };
        let mut mix = (None, None, None, None);
        let all = name == "pipeline";
        if all || name == "body mechanics" {
            mix.0 = Some(engine(&self.mechanics));
        }
        if all || name == "translator, whole body" {
            mix.1 = Some(engine(&self.body));
        }
        if name == "translator, per joint" {
            mix.1 = Some(engine(&self.joint));
        }
        if all || name == "style components" {
            mix.2 = Some(engine(&self.components));
        }
        if all || name == "emotion" {
            mix.3 = Some(engine(&self.emotion));
        }
        let limiter: Limit<'_> = engine(limits);
        Device::new(*limiter.rig(), (Mix(mix), limiter)).unwrap()
    }
}

/// The folder of the golden packs.
pub fn golden_folder() -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("packs/v2")
}

pub fn golden(name: &str) -> PackFile {
    PackFile::read(&golden_folder().join(name)).unwrap_or_else(|error| panic!("{error}"))
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
    let channels = 3 * rig.rows();
    let mut matrix =
        |rows: usize, columns: usize, size: f32| Mat::from_fn(rows, columns, |_, _| f64::from(size * random.unit()));
    let (directions, change) = (matrix(channels, COUNT, 0.5), matrix(channels, COUNT, 0.1));
    let weights = matrix(10, COUNT, 1.0);
    // The root's height is about that of a person, everything else about 0.
    let mean = (0..channels).map(|at| if at == 1 { 0.95 } else { 0.0 }).collect();
    let model = ComponentsModel {
        style: "made".to_owned(),
        frame_rate: 60.0,
        mean,
        // Travel is in metres per frame.
        shift: (0..channels).map(|at| if at < 3 { 0.001 } else { 0.01 }).collect(),
        scale: (0..channels).map(|at| if at < 3 { 0.01 } else { 0.1 }).collect(),
        learned: &directions + &change,
        content: Factors { weights, components: directions },
        track: vec![[0.0, 0.02, 0.0, 1.0]; 10],
        strength: [0.0, 1.0],
    };
    model.pack(&rig, &Provenance::default())
}

/// A made walk, neutral and weary, on balls like the other engines.
pub fn emotion() -> Vec<u8> {
    const FPS: f64 = 480.0;
    let rig = rig();
    let moments = [Manner::NEUTRAL, Manner::WEARY].map(|manner| -> Vec<synthetic::Moment> {
        let seconds = 1.0 / manner.cadence;
        let poses = rig.poses(&gait::walk(&manner, seconds + 0.1, FPS, 0.0, 1));
        let frame = |key: usize| (seconds * FPS * key as f64 / (KEYS - 1) as f64).round() as usize;
        (0..KEYS).map(|key| (frame(key) as f64 / FPS, poses[frame(key)])).collect()
    });
    synthetic::over(&rig, &moments, [COUNT, 3]).pack(&rig, &Provenance::default())
}

pub fn limits_pack() -> Vec<u8> {
    limits().pack(&rig(), &Provenance::default()).unwrap()
}

/// Limits for engines on balls, which keep their references: all joints but the hips are bounded.
pub fn balls_pack() -> Vec<u8> {
    let mut model = LimitsModel::free("balls", f64::from(RATE), &rig(), 6.0, 60.0);
    for limit in model.joints.iter_mut().skip(1) {
        *limit = JointLimit::ball([-0.9, -0.7, -0.8], [1.2, 0.7, 1.0], 7.0, 90.0);
    }
    model.pack(&rig(), &Provenance::default()).unwrap()
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
