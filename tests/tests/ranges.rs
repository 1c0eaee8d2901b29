//! Plausible ranges of a pack's numbers: what is out of them does not load, on the device as on the host.

#[path = "common/hostile.rs"]
mod hostile;

use std::path::Path;

use hostile::Hostile;
use kinesic::LoadError;
use kinesic::model::ModelMeta;
use kinesic_host::pack::PackFile;

fn golden(name: &str) -> PackFile {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("packs/v2").join(name);
    PackFile::read(&path).unwrap_or_else(|error| panic!("{error}"))
}

/// What loading a pack with a change says.
fn load(name: &str, change: impl FnOnce(&mut Hostile)) -> Result<(), LoadError> {
    let mut pack = Hostile::of(&golden(name));
    change(&mut pack);
    PackFile::from_bytes(&pack.bytes()).pack().map(drop)
}

/// Refused as a number of this name.
fn refused(name: &str, field: &str, change: impl FnOnce(&mut Hostile)) {
    match load(name, change) {
        Err(LoadError::Range { field: found }) => assert!(found.starts_with(field), "{name}: {found}, not {field}"),
        other => panic!("{name}, {field}: {other:?}"),
    }
}

const WILD: [f32; 6] = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e10, -1e10, f32::MAX];

#[test]
fn frame_rates_are_those_of_motions() {
    for rate in [0.0, -60.0, 0.5, 1001.0, 9999.0, 1e6, 1e9].into_iter().chain(WILD) {
        for name in ["translator-whole-body.kin", "emotion.kin", "mechanics.kin", "components.kin", "limits.kin"] {
            refused(name, "frame rate", |pack| pack.frame_rate = rate);
        }
    }
    for rate in [1.0, 1000.0] {
        assert_eq!(load("translator-whole-body.kin", |pack| pack.frame_rate = rate), Ok(()));
    }
}

#[test]
fn the_skeleton_of_the_metadata_is_a_tree_and_that_of_the_tensors() {
    for name in ["translator-whole-body.kin", "translator-per-joint-i16.kin", "mechanics.kin", "components.kin"]
        .into_iter()
        .chain(["emotion.kin", "limits.kin"])
    {
        for (joint, parent) in [(0, Some(0)), (0, Some(1)), (1, Some(1)), (1, Some(2)), (2, Some(u16::MAX)), (1, None)]
        {
            refused(name, "parent of a joint", |pack| pack.joints[joint].1 = parent);
        }
        // A tree, but another one.
        let other = load(name, |pack| pack.joints[2].1 = Some(1 - pack.joints[2].1.unwrap()));
        assert_eq!(other, Err(LoadError::Value { tensor: "skeleton/parents", index: 2 }), "{name}");
        let far = load(name, |pack| pack.f32s("skeleton/offsets", |offsets| offsets[4] = 1e10));
        assert_eq!(far, Err(LoadError::Value { tensor: "skeleton/offsets", index: 1 }), "{name}");
    }
}

#[test]
fn a_clock_is_at_most_sixteen_times_as_fast_or_slow() {
    for name in ["translator-whole-body.kin", "translator-per-joint.kin", "translator-per-joint-i16.kin"] {
        for (at, value) in [(2, 1e5), (2, 20.0), (2, 12.0), (1, -1e10), (0, 4.1)] {
            let timing = |pack: &mut Hostile| pack.f32s("translate/timing", |timing| timing[at] = value);
            assert_eq!(load(name, timing), Err(LoadError::Value { tensor: "translate/timing", index: at }), "{name}");
        }
        let crossed = load(name, |pack| pack.f32s("translate/timing", |timing| (timing[1], timing[2]) = (1.0, -1.0)));
        assert_eq!(crossed, Err(LoadError::Value { tensor: "translate/timing", index: 1 }), "{name}");
    }
}

/// The pack's model, changed.
fn model(pack: &mut Hostile, change: impl Fn(&mut ModelMeta<'static>)) {
    pack.models.iter_mut().for_each(change);
}

#[test]
fn strengths_are_a_range_and_no_more_than_a_thousand() {
    let set = |meta: &mut ModelMeta<'static>, range: [f32; 2]| match meta {
        ModelMeta::Translator(meta) => meta.strength = range,
        ModelMeta::Components(meta) => meta.strength = range,
        ModelMeta::Face(meta) => meta.strength = range,
        ModelMeta::Emotion(meta) => meta.attributes[1].as_mut().unwrap().strength = range,
        _ => unreachable!(),
    };
    for name in
        ["translator-whole-body.kin", "translator-per-joint-i16.kin", "components.kin", "face.kin", "emotion.kin"]
    {
        let wild = WILD.into_iter().flat_map(|wild| [[wild, 1.0], [0.0, wild]]).chain([[1.0, 0.0], [0.0, 1000.5]]);
        for range in wild {
            refused(name, "range of strengths", |pack| model(pack, |meta| set(meta, range)));
        }
        assert_eq!(load(name, |pack| model(pack, |meta| set(meta, [-1000.0, 1000.0]))), Ok(()), "{name}");
    }
}

#[test]
fn bodies_and_gains_are_those_of_bodies() {
    for wild in WILD.into_iter().chain([0.0, 1001.0]) {
        let body = |change: fn(&mut kinesic::model::MechanicsMeta, f32)| {
            move |pack: &mut Hostile| {
                model(pack, |meta| {
                    let ModelMeta::Mechanics(meta) = meta else { unreachable!() };
                    change(meta, wild);
                });
            }
        };
        refused("mechanics.kin", "size of the body", body(|meta, wild| meta.body_height = wild));
        refused("mechanics-i8.kin", "size of the body", body(|meta, wild| meta.hip_height = wild));
        if wild != 0.0 {
            refused("mechanics.kin", "gain", body(|meta, wild| meta.gain = wild));
        }
    }
}

/// Sets a count of a model.
type Set = fn(&mut ModelMeta<'static>, u32);

#[test]
fn shapes_add_up_without_overflow() {
    for huge in [(1 << 20) + 1, 1 << 31, u32::MAX] {
        let fields: [(&str, Set); 8] = [
            ("translator-whole-body.kin", |meta, huge| {
                if let ModelMeta::Translator(meta) = meta {
                    meta.blocks = huge
                }
            }),
            ("translator-whole-body.kin", |meta, huge| {
                if let ModelMeta::Translator(meta) = meta {
                    meta.drives = huge
                }
            }),
            ("components.kin", |meta, huge| {
                if let ModelMeta::Components(meta) = meta {
                    meta.count = huge
                }
            }),
            ("components.kin", |meta, huge| {
                if let ModelMeta::Components(meta) = meta {
                    meta.frames = huge
                }
            }),
            ("face.kin", |meta, huge| {
                if let ModelMeta::Face(meta) = meta {
                    meta.clusters = huge
                }
            }),
            ("emotion.kin", |meta, huge| {
                if let ModelMeta::Emotion(meta) = meta {
                    meta.keyframes = huge
                }
            }),
            ("emotion.kin", |meta, huge| {
                if let ModelMeta::Emotion(meta) = meta {
                    meta.hidden = huge
                }
            }),
            ("mechanics.kin", |meta, huge| {
                if let ModelMeta::Mechanics(meta) = meta {
                    meta.code = huge
                }
            }),
        ];
        for (name, set) in fields {
            refused(name, "shape of a model", |pack| model(pack, |meta| set(meta, huge)));
        }
    }
}
