//! What a frame of each engine costs on each core, as measured on the firmware workloads. A test holds it to `docs/latency.md`.

/// Cores, in the order of [`Workload::microseconds`].
pub const CORES: [&str; 6] =
    ["M0+ 133 MHz, no FPU", "RV32IMC 160 MHz, no FPU", "M4F 168 MHz", "M33 150 MHz", "M55 160 MHz", "M7 480 MHz"];

/// A workload of the firmware check.
#[derive(Clone, Copy, Debug)]
pub struct Workload {
    /// Its name in the check.
    pub name: &'static str,
    /// What its cost depends on.
    pub size: &'static str,
    /// Time of the longest frame (faces: update), microseconds of modelled cycles without wait states, by core.
    pub microseconds: [u32; 6],
}

/// The workloads of an engine, by the name that `kinesic inspect` has for it; the first is in f32.
pub fn workloads(engine: &str) -> &'static [Workload] {
    match engine {
        "translator" => &TRANSLATOR,
        "mechanics" => &MECHANICS,
        "components" => &COMPONENTS,
        "face" => &FACE,
        "emotion" => &EMOTION,
        _ => &[],
    }
}

const TRANSLATOR: [Workload; 2] = [
    Workload {
        name: "translator",
        size: "a model a joint, 25 joints, 8554 multiply-adds",
        microseconds: [9_547, 6_382, 433, 493, 395, 128],
    },
    Workload {
        name: "translator-body",
        size: "whole body, 25 joints, 5002 multiply-adds",
        microseconds: [6_925, 4_682, 266, 306, 241, 90],
    },
];
const MECHANICS: [Workload; 2] = [
    Workload {
        name: "mechanics",
        size: "f32, 31 joints, 13992 multiply-adds",
        microseconds: [19_245, 12_888, 566, 638, 498, 202],
    },
    Workload {
        name: "mechanics-i8",
        size: "the same after kinesic quantize",
        microseconds: [5_788, 3_535, 450, 517, 411, 167],
    },
];
const COMPONENTS: [Workload; 1] = [Workload {
    name: "components",
    size: "23 joints, 4320 multiply-adds",
    microseconds: [6_256, 4_208, 236, 270, 216, 80],
}];
const FACE: [Workload; 1] =
    [Workload { name: "face", size: "12 clusters, 10 hidden units", microseconds: [3_015, 2_085, 132, 152, 121, 44] }];
const EMOTION: [Workload; 2] = [
    Workload {
        name: "emotion-play",
        size: "a frame, 19 joints, 13 keyframes",
        microseconds: [464, 302, 42, 48, 42, 12],
    },
    Workload {
        name: "emotion-change",
        size: "a change of strength, 40 components",
        microseconds: [58_726, 39_920, 2_329, 2_701, 2_303, 771],
    },
];
