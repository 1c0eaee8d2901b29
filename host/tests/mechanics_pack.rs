//! The pack that ships (`models/mechanics.kin`) on real clips, and packs with shapes that do not fit.

mod mechanics_common;
mod real;

use std::path::Path;

use kinesic::mechanics::{BodyMechanics, Modulation};
use kinesic::model::{Kind, MechanicsMeta, ModelMeta};
use kinesic::{LoadError, Pack};
use kinesic_host::clip::{Clip, ReadOptions};
use kinesic_host::mechanics::{HostMechanics, NamedClip, TrainOptions, decouple, evaluate, modulate, train};
use kinesic_host::pack::{PackFile, PackWriter, Provenance};
use kinesic_host::prepare::{Source, fingerprint};
use kinesic_host::rig::{MAX_JOINTS, Rig};
use mechanics_common::on_rig;

fn shipped() -> PackFile {
    PackFile::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../models/mechanics.kin")).expect("the shipped pack")
}

/// Files of the manifest with a label, cmu31 only.
fn labelled(folder: &Path, label: &str) -> Vec<String> {
    let manifest = std::fs::read_to_string(folder.join("manifest.tsv")).expect("manifest.tsv");
    let rows = manifest.lines().map(|line| line.split('\t').collect::<Vec<_>>());
    rows.filter(|row| row.get(8) == Some(&label) && row[0].starts_with("cmu31/")).map(|row| row[0].to_owned()).collect()
}

fn read(folder: &Path, rig: &Rig, name: &str) -> Clip {
    let source = Source::read(&folder.join(name), &ReadOptions::default()).expect("a clip");
    source.on_rig(rig, 60.0).expect("on the rig")
}

#[test]
fn every_frame_of_every_expressive_clip_is_the_product_of_its_parts() {
    let Some(folder) = real::data("mechanics_pack") else { return };
    let file = shipped();
    let pack = file.pack().unwrap();
    let rig = Rig::from_pack(&pack).unwrap();
    let joints = rig.joints();
    let (mut frames, mut worst, mut none) = (0, 0.0f32, 0.0f32);
    for name in labelled(&folder, "expressive") {
        let poses = rig.poses(&read(&folder, &rig, &name));
        let parts = decouple(&pack, &poses).unwrap();
        let at = |amount| modulate(&poses, &parts, &Modulation { amount, ..Modulation::default() });
        assert_eq!(at(1.0), poses, "{name}: modulated by 1");
        let plain = at(0.0);
        for ((pose, parts), plain) in poses.iter().zip(&parts).zip(&plain) {
            let product = parts.observed();
            for joint in 0..joints {
                worst = worst.max((product.rotations[joint].coords - pose.rotations[joint].coords).amax());
                none = none.max((plain.rotations[joint].coords - parts.mechanics.rotations[joint].coords).amax());
            }
        }
        frames += poses.len();
    }
    println!("{frames} frames: E* B' differs from O by at most {worst:.1e}, modulated by 0 from B' by {none:.1e}");
    assert!(frames > 20_000 && worst <= 1e-5 && none <= 1e-5);
}

#[test]
fn unseen_plain_clips_keep_little_and_are_predicted_better_than_by_regression() {
    let Some(folder) = real::data("mechanics_pack") else { return };
    let file = shipped();
    let pack = file.pack().unwrap();
    let rig = Rig::from_pack(&pack).unwrap();
    let provenance = file.provenance().expect("a provenance");
    let report = |label| {
        let known = |name: &String| {
            let print = fingerprint(&folder.join(name)).unwrap();
            provenance.inputs.iter().any(|input| input.sha256 == print.sha256)
        };
        let unseen: Vec<String> = labelled(&folder, label).into_iter().filter(|name| !known(name)).collect();
        let clips: Vec<_> = unseen.into_iter().map(|name| (name.clone(), read(&folder, &rig, &name), false)).collect();
        evaluate(&pack, &rig, &provenance.baselines, &provenance.metrics, &clips).unwrap()
    };
    let (plain, expressive) = (report("body-mechanics"), report("expressive"));
    println!(
        "unseen clips: {} plain, {:.2} degrees left; {} expressive, {:.2} degrees left",
        plain.clips.len(),
        plain.expressive_deg,
        expressive.clips.len(),
        expressive.expressive_deg
    );
    println!(
        "plain: {:.2} predicted, {:.2} linear, {:.2} mean pose",
        plain.geodesic_deg, plain.linear_deg, plain.mean_pose_deg
    );
    assert!(plain.clips.len() >= 15 && expressive.clips.len() >= 10);
    assert!(expressive.expressive_deg > 5.0 * plain.expressive_deg);
    assert!(plain.geodesic_deg < 0.85 * plain.linear_deg && plain.linear_deg < plain.mean_pose_deg);
}

#[test]
fn training_repeats_itself_and_its_pack_predicts_what_the_trainer_measured() {
    let Some(folder) = real::data("mechanics_pack") else { return };
    // The walks are one person's: another rest pose is a joint that moves, to the trainer alone.
    let names = ["cmu31/07_01.bvh", "cmu31/07_02.bvh", "cmu31/07_03.bvh", "cmu31/07_04.bvh", "cmu31/05_02.bvh"];
    let (rig, clips) = on_rig(&folder, &names);
    let named: Vec<NamedClip> = names
        .iter()
        .zip(clips)
        .map(|(name, clip)| NamedClip { name: (*name).to_owned(), clip, mechanics: !name.contains("05_02") })
        .collect();
    let options = TrainOptions { code: 8, hidden: 12, epochs: 5, ..TrainOptions::default() };
    let run = || train(&rig, &named, "test", &options, &|_, _, _, _| ()).unwrap();
    let trained = run();
    let bytes = trained.model.pack(&rig, &Provenance::default());
    assert_eq!(bytes, run().model.pack(&rig, &Provenance::default()));
    let file = PackFile::from_bytes(&bytes);
    let baselines = kinesic_host::pack::Baselines { offset: trained.mean_pose, affine: trained.linear.weights };
    let held: Vec<_> = named
        .into_iter()
        .zip(&trained.trained_on)
        .filter(|(clip, trained)| clip.mechanics && !**trained)
        .map(|(clip, _)| (clip.name, clip.clip, false))
        .collect();
    let report = evaluate(&file.pack().unwrap(), &rig, &baselines, &[], &held).unwrap();
    let figures = trained.held_back.expect("figures");
    // Two ways to the same number: the trainer's matrices and the device's tiles.
    assert!((report.geodesic_deg - figures.geodesic_deg).abs() < 1e-3 * figures.geodesic_deg, "{report:?} {figures:?}");
    assert!((report.linear_deg - figures.linear_deg).abs() < 1e-3 * figures.linear_deg);
}

#[test]
fn capacities_and_shapes_are_checked() {
    let file = shipped();
    let pack = file.pack().unwrap();
    assert!(HostMechanics::load(&pack).is_ok());
    let refused = |error: LoadError, name: &str| match error {
        LoadError::Capacity { parameter, .. } => assert_eq!(parameter, name),
        other => panic!("{name}: {other}"),
    };
    refused(BodyMechanics::<8, 152, 20>::load(&pack).unwrap_err(), "JOINTS");
    refused(BodyMechanics::<32, 148, 20>::load(&pack).unwrap_err(), "UNITS");
    refused(BodyMechanics::<32, 152, 19>::load(&pack).unwrap_err(), "WINDOW");
    assert!(BodyMechanics::<31, 150, 20>::load(&pack).is_ok());

    // A pack with one thing wrong at a time.
    type Change = fn(&mut MechanicsMeta, &mut Vec<(&'static str, Vec<f32>)>);
    let changes: [(&str, Change); 8] = [
        ("hidden", |meta, _| meta.hidden = 3),
        ("code", |meta, _| meta.code = u32::MAX),
        ("no units", |meta, _| meta.code = 0),
        ("height", |meta, _| meta.body_height = f32::NAN),
        ("exponent", |meta, _| meta.exponent = 200),
        ("gain", |meta, _| meta.gain = f32::INFINITY),
        ("NaN", |_, tensors| tensors[4].1[0] = f32::NAN),
        ("missing", |_, tensors| drop(tensors.pop())),
    ];
    let build = |change: Change| {
        let rig = Rig::from_pack(&pack).unwrap();
        let mut writer = PackWriter::new(Kind::Mechanics, "made", 60.0);
        rig.write(&mut writer);
        let mut meta = MechanicsMeta { hidden: 8, code: 8, body_height: 1.7, hip_height: 0.9, gain: 2.0, exponent: 4 };
        let outputs = 4 * (rig.joints() - 1);
        let mut tensors = vec![
            ("mechanics/clearance", vec![0.0; 4]),
            ("mechanics/feature_mean", vec![0.0; 23]),
            ("mechanics/feature_inverse_deviation", vec![1.0; 23]),
            ("mechanics/hidden", vec![0.1; 8 * 23]),
            ("mechanics/hidden_bias", vec![0.0; 8]),
            ("mechanics/code", vec![0.1; 64]),
            ("mechanics/code_bias", vec![0.0; 8]),
            ("mechanics/decoder", vec![0.1; outputs.next_multiple_of(8) * 8]),
            ("mechanics/decoder_bias", vec![0.0; outputs]),
        ];
        change(&mut meta, &mut tensors);
        writer.model(&ModelMeta::Mechanics(meta));
        writer.u16s("mechanics/feet", 4, &[3, 4, 8, 9]);
        writer.u16s("mechanics/thighs", 2, &[2, 7]);
        for (name, values) in &tensors {
            writer.f32s(name, 1, values);
        }
        PackFile::from_bytes(&writer.finish(&Provenance::default()))
    };
    let load = |file: &PackFile| file.pack().and_then(|pack| HostMechanics::load(&pack).map(drop));
    assert_eq!(load(&build(|_, _| ())), Ok(()));
    for (name, change) in changes {
        assert!(load(&build(change)).is_err(), "{name}");
    }
    assert_eq!(pack.kind(), Kind::Mechanics);
    assert!(Pack::load(&file.bytes()[..file.bytes().len() - 1]).is_err());
    assert_eq!(MAX_JOINTS, 128);
}
