//! The model file: golden packs load for ever, damaged ones never.

mod common;
#[path = "common/engines.rs"]
mod engines;
#[path = "common/robot.rs"]
mod robot;

use engines::{golden, golden_folder};
use kinesic::model::{Floats, Kind, Ungated};
use kinesic::{LoadError, Pack, Pipeline, PipelineState, Pose, Translator};
use kinesic_host::emotion;
use kinesic_host::engines::known;
use kinesic_host::face::synthetic;
use kinesic_host::pack::{PackFile, Provenance};
use kinesic_host::quantise::{to_int8, to_int16};
use kinesic_host::translate::{BankModel, ExpertModel, FormChoice, GateModel};
use rand::SeedableRng;
use rand::rngs::ChaCha8Rng;
use robot::small;

type Device<'a> = Pipeline<'a, Translator<'a, 20, 1024>, 20>;

/// One file of every kind for every version of the format that was released. Make a new one with
/// `KINESIC_GOLDEN=write cargo test --release -p kinesic-tests --test packs`, and never overwrite an old one: see
/// `docs/pack.md`.
const GOLDEN: [(&str, FormChoice, usize); 2] =
    [("translator-whole-body.kin", FormChoice::WholeBody, 24), ("translator-per-joint.kin", FormChoice::PerJoint, 12)];

type Make = fn() -> Vec<u8>;

/// The other kinds: small packs of drawn numbers.
const MADE: [(&str, Make); 9] = [
    ("translator-several.kin", several),
    ("translator-whole-body-i16.kin", whole_body_int16),
    ("translator-per-joint-i16.kin", per_joint_int16),
    ("mechanics.kin", engines::mechanics),
    ("mechanics-i8.kin", int8),
    ("components.kin", engines::components),
    ("face.kin", face),
    ("emotion.kin", emotion_pack),
    ("limits.kin", engines::limits_pack),
];

/// A gate and experts of drawn numbers behind the whole body's model.
fn several() -> Vec<u8> {
    const CLUSTERS: usize = 4;
    const FEATURES: usize = 8;
    const RANK: usize = 8;
    let mut random = engines::Random(11);
    let mut values = |count: usize, size: f64| (0..count).map(|_| size * f64::from(random.unit())).collect::<Vec<_>>();
    let mut trained = common::trained(FormChoice::WholeBody, 24);
    let model = &mut trained.model;
    let channels = model.mean.len();
    let BankModel::WholeBody { project, transition, .. } = &model.bank else { panic!("another form") };
    let reads = 2 * transition.len() + project.len() / channels;
    model.gate = Some(GateModel {
        project: values(FEATURES * channels, 0.3),
        speed: vec![2.0; FEATURES],
        centres: values(2 * CLUSTERS * FEATURES, 1.0).as_chunks::<2>().0.to_vec(),
        rates: [0.08, 0.04, 0.15, 0.1],
        coarse: values(channels, 0.02),
    });
    model.experts = Some(ExpertModel {
        rank: RANK,
        input: values(CLUSTERS * RANK * reads, 0.1),
        bias: values(CLUSTERS * RANK, 0.1),
        output: values(channels * RANK, 0.02),
    });
    common::packed(&trained).bytes().to_vec()
}

fn int8() -> Vec<u8> {
    to_int8(&PackFile::from_bytes(&engines::mechanics()), &Provenance::default()).unwrap()
}

fn int16(form: FormChoice, order: usize) -> Vec<u8> {
    to_int16(&common::pack(form, order), &Provenance::default()).unwrap()
}

fn whole_body_int16() -> Vec<u8> {
    int16(FormChoice::WholeBody, 24)
}

fn per_joint_int16() -> Vec<u8> {
    int16(FormChoice::PerJoint, 12)
}

fn face() -> Vec<u8> {
    synthetic::model(2, 3, &mut ChaCha8Rng::seed_from_u64(3)).pack(&Provenance::default())
}

fn emotion_pack() -> Vec<u8> {
    let (model, rig) = emotion::synthetic::sized(2, [4, 6, 3]);
    model.pack(&rig, &Provenance::default())
}

/// Every released pack: what is in the folder.
fn all() -> Vec<(String, PackFile)> {
    let names =
        std::fs::read_dir(golden_folder()).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<String> = names.collect();
    names.sort();
    names.into_iter().map(|name| (name.clone(), golden(&name))).collect()
}

#[test]
fn every_kind_of_model_has_a_golden_pack_that_loads() {
    let mut kinds = Vec::new();
    for (name, file) in all() {
        let pack = file.pack().unwrap();
        for meta in pack.metadata().models.iter() {
            let rows = kinesic::Rig::load(&pack).map_or(0, |rig| rig.rows());
            let figures = known(&meta).figures(&pack, rows);
            assert!(figures.is_ok(), "{name}: {figures:?}");
        }
        kinds.push(pack.kind());
    }
    for kind in (Kind::Translator.code()..).map_while(Kind::from_code) {
        assert!(kinds.contains(&kind), "{kind:?} has no golden pack in {}", golden_folder().display());
    }
}

#[test]
fn golden_packs_load_and_step() {
    for (name, form, order) in GOLDEN {
        let path = golden_folder().join(name);
        if std::env::var("KINESIC_GOLDEN").as_deref() == Ok("write") && !path.exists() {
            std::fs::write(&path, common::pack(form, order).bytes()).unwrap();
        }
    }
    for name in GOLDEN.map(|(name, ..)| name).into_iter().chain(["translator-several.kin"]) {
        let file = golden(name);
        let pack = file.pack().unwrap();
        let device = Device::load(&pack).unwrap();
        let mut state = PipelineState::new();
        let mut styled = Pose::<19>::identity();
        let rig = common::rig();
        for pose in rig.poses(&common::neutral(3)) {
            device.step(&mut state, Some(&small(&pose)), &mut styled);
            assert!(styled.rotations.iter().all(|q| (q.norm() - 1.0).abs() < 1e-5), "{name}");
        }
        assert!(styled.root.norm() < 20.0, "{name}: {}", styled.root);
    }
}

/// A product without a gate links none of it, refuses a pack that has one by name, and makes of any other the same bits.
#[test]
fn a_type_without_a_gate_reads_packs_without_a_gate() {
    type Plain<'p> = Pipeline<'p, Translator<'p, 20, 1024, Ungated<Floats>>, 20>;
    let gated = golden("translator-several.kin");
    assert_eq!(Plain::load(&gated.pack().unwrap()).err(), Some(LoadError::Gated));
    let file = golden("translator-whole-body.kin");
    let pack = file.pack().unwrap();
    let (plain, any) = (Plain::load(&pack).unwrap(), Device::load(&pack).unwrap());
    let (mut of_plain, mut of_any) = (PipelineState::new(), PipelineState::new());
    for pose in common::rig().poses(&common::neutral(3)) {
        let [mut a, mut b] = [Pose::<19>::identity(); 2];
        plain.step(&mut of_plain, Some(&small(&pose)), &mut a);
        any.step(&mut of_any, Some(&small(&pose)), &mut b);
        assert_eq!(a, b);
    }
}

#[test]
fn golden_packs_are_what_the_present_writer_makes() {
    for (name, make) in MADE {
        let path = golden_folder().join(name);
        if std::env::var("KINESIC_GOLDEN").as_deref() == Ok("write") && !path.exists() {
            std::fs::write(&path, make()).unwrap();
        }
        let file = golden(name);
        // The present writer still writes this format; last bits of what it computes may differ from machine to machine.
        assert_eq!(file.bytes().len(), make().len(), "{name}");
    }
}

#[test]
fn a_pack_truncated_at_any_byte_is_refused() {
    for (name, file) in all() {
        for len in 0..file.bytes().len() {
            assert!(Pack::load(&file.bytes()[..len]).is_err(), "{name} cut to {len} bytes loads");
        }
        let mut longer = file.bytes().to_vec();
        longer.push(0);
        assert!(PackFile::from_bytes(&longer).pack().is_err());
    }
}

#[test]
fn a_pack_with_any_bit_flipped_is_refused() {
    for (name, mut file) in all() {
        let bytes = file.bytes().to_vec();
        for bit in 0..8 * bytes.len() {
            let mut damaged = file.bytes_mut();
            damaged[bit / 8] ^= 1 << (bit % 8);
            let refused = Pack::load(damaged).is_err();
            damaged = file.bytes_mut();
            damaged[bit / 8] ^= 1 << (bit % 8);
            assert!(refused, "{name} with bit {bit} flipped loads");
        }
        assert_eq!(file.bytes(), bytes);
    }
}

#[test]
fn refusals_say_why() {
    let file = golden(GOLDEN[0].0);
    let changed = |change: &dyn Fn(&mut Vec<u8>)| {
        let mut bytes = file.bytes().to_vec();
        change(&mut bytes);
        PackFile::from_bytes(&bytes).pack().unwrap_err()
    };
    assert_eq!(changed(&|b| b.truncate(7)), LoadError::TooShort { found: 7, expected: 20 });
    assert_eq!(changed(&|b| b[0] = b'X'), LoadError::NotAPack { found: *b"XNSC" });
    assert_eq!(changed(&|b| b[4] = 9), LoadError::Version { found: 9, expected: 2 });
    assert_eq!(changed(&|b| b[7] = 9), LoadError::Kind { found: 0x0901 });
    assert!(matches!(changed(&|b| b.truncate(b.len() - 16)), LoadError::Length { .. }));
    assert!(matches!(changed(&|b| *b.last_mut().unwrap() ^= 1), LoadError::Checksum { .. }));
    let mut shifted = vec![0; 1];
    shifted.extend_from_slice(file.bytes());
    let shifted = PackFile::from_bytes(&shifted);
    assert_eq!(Pack::load(&shifted.bytes()[1..]).unwrap_err(), LoadError::Misaligned { off_by: 1 });

    let pack = file.pack().unwrap();
    let small = Translator::<19, 1024>::load(&pack).unwrap_err();
    assert_eq!(small, LoadError::Capacity { parameter: "ROWS", found: 20, capacity: 19 });
    let small = Translator::<20, 8>::load(&pack).unwrap_err();
    assert!(matches!(small, LoadError::Capacity { parameter: "STATES", capacity: 8, .. }));
}
