//! One frame of style translation on the host: the recursion against a dense one in nalgebra, and whole steps.
#![allow(missing_docs, reason = "criterion's macros make undocumented items")]

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use kinesic::kernel::{JointBlock, advance_joint};
use kinesic::{Pipeline, PipelineState, Pose};
use kinesic_host::clip::JointMap;
use kinesic_host::gait::{Manner, walk};
use kinesic_host::pack::{PackFile, Provenance};
use kinesic_host::rig::{MAX_ROWS, Rig};
use kinesic_host::translate::{FormChoice, HostTranslator, TrainOptions, TrainPair, train};
use nalgebra::{SMatrix, SVector};

const ORDER: usize = 40;

/// One joint of order 40, 3 inputs, 3 outputs.
fn recursion(c: &mut Criterion) {
    let mut group = c.benchmark_group("one joint, order 40");
    let block: JointBlock = std::array::from_fn(|i| if i < 4 { [0.8, 0.3, -0.3, 0.8][i] } else { 0.01 * i as f32 });
    let blocks = [block; ORDER / 2];
    let mut x = [[0.0f32; 2]; ORDER / 2];
    group.bench_function("modal blocks (kinesic)", |b| {
        b.iter(|| {
            let mut y = [0.0; 3];
            advance_joint(black_box(&blocks), black_box([0.1, -0.2, 0.3]), &mut x, &mut y);
            y
        });
    });
    let a = SMatrix::<f32, ORDER, ORDER>::from_fn(|i, j| if i == j { 0.9 } else { 1e-3 });
    let b_matrix = SMatrix::<f32, ORDER, 3>::from_element(0.01);
    let c_matrix = SMatrix::<f32, 3, ORDER>::from_element(0.01);
    let mut x = SVector::<f32, ORDER>::zeros();
    group.bench_function("dense matrices (nalgebra)", |b| {
        b.iter(|| {
            let u = black_box(SVector::<f32, 3>::new(0.1, -0.2, 0.3));
            let y = black_box(&c_matrix) * x;
            x = black_box(&a) * x + black_box(&b_matrix) * u;
            y
        });
    });
    group.finish();
}

/// A frame of a 19-joint walk from pose to pose, in both forms.
fn step(c: &mut Criterion) {
    let mut group = c.benchmark_group("translator, 19 joints");
    let (neutral, weary) = (walk(&Manner::NEUTRAL, 4.0, 60.0, 0.0, 1), walk(&Manner::WEARY, 5.0, 60.0, 0.0, 2));
    let map = JointMap::detect(&neutral.skeleton).expect("the made skeleton is known");
    let rig = Rig::new(&neutral.skeleton, &map).expect("the made skeleton is a rig");
    let poses = rig.poses(&neutral);
    let pair = TrainPair {
        source_name: "neutral".into(),
        target_name: "weary".into(),
        source: rig.locals(&poses),
        target: rig.locals(&rig.poses(&weary)),
    };
    for (name, form) in [("whole body", FormChoice::WholeBody), ("per joint", FormChoice::PerJoint)] {
        let options = TrainOptions { form, ..TrainOptions::default() };
        let trained = train(&rig, std::slice::from_ref(&pair), "weary", 60.0, &options, &|_| {}).expect("trains");
        let file = PackFile::from_bytes(&trained.model.pack(&rig, &Provenance::default()));
        let pack = file.pack().expect("loads");
        let pipeline = Pipeline::<HostTranslator, MAX_ROWS>::load(&pack).expect("loads");
        let mut state = Box::new(PipelineState::new());
        let mut styled = Pose::identity();
        let mut frames = poses.iter().cycle();
        group.bench_function(name, |b| {
            b.iter(|| pipeline.step(&mut state, frames.next(), &mut styled));
        });
    }
    group.finish();
}

criterion_group!(translate, recursion, step);
criterion_main!(translate);
