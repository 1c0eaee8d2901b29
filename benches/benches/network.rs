//! The network 23-100-300-120 on the host: f32 and int8, with nalgebra's dense matrices and a crate from the registry beside them.
#![allow(missing_docs, reason = "criterion's macros make undocumented items")]

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use embedded_nn::fully_connected::fully_connected_s8;
use embedded_nn::types::{Activation, Dims, FcParams, PerTensorQuantParams};
use kinesic::kernel::{Activations, LARGEST_ACTIVATION, PRE_ACTIVATION_BITS, Quantised, Tiled, tanh};
use kinesic::model::Kind;
use kinesic_host::pack::{PackFile, PackWriter, Provenance};
use kinesic_host::quantise::layer;
use nalgebra::{SMatrix, SVector};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

const SHAPE: [usize; 4] = [23, 100, 300, 120];
const F32: [&str; 3] = ["f32/hidden", "f32/code", "f32/decoder"];
const I8: [[&str; 3]; 3] = [
    ["i8/hidden", "i8/hidden_scale", "i8/hidden_bias"],
    ["i8/code", "i8/code_scale", "i8/code_bias"],
    ["i8/decoder", "i8/decoder_scale", "i8/decoder_bias"],
];

/// Row-major weights of the three layers, seeded.
fn weights() -> [Vec<f32>; 3] {
    let mut random = ChaCha8Rng::seed_from_u64(3);
    [0, 1, 2].map(|at| {
        let size = (3.0 / SHAPE[at] as f32).sqrt();
        (0..SHAPE[at] * SHAPE[at + 1]).map(|_| random.random_range(-size..size)).collect()
    })
}

fn pack(weights: &[Vec<f32>; 3]) -> PackFile {
    let mut out = PackWriter::new(Kind::Style, "network", 60.0);
    for (at, weights) in weights.iter().enumerate() {
        out.tiled(F32[at], SHAPE[at], weights);
        let (bias, unit) = (vec![0.0; SHAPE[at + 1]], 1.0 / f64::from(LARGEST_ACTIVATION));
        let integer = layer("i8", SHAPE[at], weights, &bias, unit, PRE_ACTIVATION_BITS).expect("small weights");
        out.integer_layer(I8[at], &integer);
    }
    PackFile::from_bytes(&out.finish(&Provenance::default()))
}

fn network(c: &mut Criterion) {
    let mut group = c.benchmark_group("network 23-100-300-120");
    let weights = weights();
    let file = pack(&weights);
    let pack = file.pack().expect("its own pack");
    let input: [f32; SHAPE[0]] = std::array::from_fn(|at| (at as f32 * 0.7).sin());

    let float = [0, 1, 2].map(|at| Tiled::load(&pack, F32[at], SHAPE[at + 1], SHAPE[at]).expect("its own tensor"));
    group.bench_function("f32 (kinesic)", |b| {
        b.iter(|| {
            let (mut hidden, mut code, mut output) = ([0.0; SHAPE[1]], [0.0; SHAPE[2]], [0.0; SHAPE[3]]);
            float[0].multiply_add(black_box(&input), &mut hidden);
            hidden.iter_mut().for_each(|x| *x = tanh(*x));
            float[1].multiply_add(&hidden, &mut code);
            code.iter_mut().for_each(|x| *x = tanh(*x));
            float[2].multiply_add(&code, &mut output);
            output
        });
    });

    let integer = [0, 1, 2].map(|at| Quantised::load(&pack, I8[at], SHAPE[at + 1], SHAPE[at]).expect("its own tensor"));
    let mut activations = Activations::<24>::zero();
    activations.values().iter_mut().zip(input).for_each(|(out, x)| *out = (x * f32::from(LARGEST_ACTIVATION)) as i16);
    group.bench_function("int8 weights, int16 activations (kinesic)", |b| {
        b.iter(|| {
            let (mut hidden, mut code) = (Activations::<{ SHAPE[1] }>::zero(), Activations::<{ SHAPE[2] }>::zero());
            let mut output = [0i32; SHAPE[3]];
            integer[0].apply_tanh(black_box(activations.values()), hidden.values());
            integer[1].apply_tanh(hidden.values(), code.values());
            integer[2].apply(code.values(), &mut output, |z| z);
            output
        });
    });

    let first = Box::new(SMatrix::<f32, { SHAPE[1] }, { SHAPE[0] }>::from_row_slice(&weights[0]));
    let second = Box::new(SMatrix::<f32, { SHAPE[2] }, { SHAPE[1] }>::from_row_slice(&weights[1]));
    let third = Box::new(SMatrix::<f32, { SHAPE[3] }, { SHAPE[2] }>::from_row_slice(&weights[2]));
    let x = SVector::<f32, { SHAPE[0] }>::from_row_slice(&input);
    group.bench_function("f32, dense matrices (nalgebra), the same tanh", |b| {
        b.iter(|| {
            let hidden = (first.as_ref() * black_box(x)).map(tanh);
            let code = (second.as_ref() * hidden).map(tanh);
            third.as_ref() * code
        });
    });

    let bytes = weights.map(|weights| {
        let largest = weights.iter().fold(0.0f32, |most, weight| most.max(weight.abs()));
        weights.iter().map(|weight| (weight / largest * 127.0).round() as i8).collect::<Vec<i8>>()
    });
    let x = input.map(|x| (x * 127.0) as i8);
    group.bench_function("int8, without tanh (embedded-nn)", |b| {
        b.iter(|| {
            let (mut hidden, mut code, mut output) = ([0i8; SHAPE[1]], [0i8; SHAPE[2]], [0i8; SHAPE[3]]);
            fully_connected(black_box(&x), &bytes[0], &mut hidden);
            fully_connected(&hidden, &bytes[1], &mut code);
            fully_connected(&code, &bytes[2], &mut output);
            output
        });
    });
    group.finish();
}

fn fully_connected(x: &[i8], weights: &[i8], y: &mut [i8]) {
    let (columns, rows) = (x.len() as i32, y.len() as i32);
    let activation = Activation { min: -128, max: 127 };
    let params = FcParams { input_offset: 0, filter_offset: 0, output_offset: 0, activation };
    let scale = PerTensorQuantParams { multiplier: 1 << 30, shift: -8 };
    let dims = |n, c| Dims { n, h: 1, w: 1, c };
    let (input, filter, output) = (dims(1, columns), dims(columns, rows), dims(1, rows));
    fully_connected_s8(&params, &scale, &input, x, &filter, weights, None, &output, y).expect("shapes that fit");
}

criterion_group!(benches, network);
criterion_main!(benches);
