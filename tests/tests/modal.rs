//! Real modal form against the dense form it comes from: order 40, one joint, 3 inputs and 3 outputs.
//!
//! `cargo test --release -p kinesic-tests --test modal -- --nocapture` prints the figures of `docs/quality.md`.

use faer::Mat;
use kinesic::kernel::{JointBlock, advance_joint};
use kinesic_host::clip::{self, JointMap};
use kinesic_host::gait::{Manner, walk};
use kinesic_host::prepare::Source;
use kinesic_host::rig::{Locals, Rig};
use kinesic_host::translate::identify::{balanced, impulse_response, modal};

const ORDER: usize = 40;

/// One joint's normalised positions, `[frames x 3]`.
fn joint(locals: &Locals, joint: usize, like: Option<&(Vec<f64>, f64)>) -> (Mat<f64>, (Vec<f64>, f64)) {
    let rows = || locals.positions.chunks_exact(locals.channels()).map(|row| &row[3 * joint..3 * joint + 3]);
    let frames = locals.frames();
    let (mean, deviation) = like.cloned().unwrap_or_else(|| {
        let mean: Vec<f64> = (0..3).map(|d| rows().map(|row| row[d]).sum::<f64>() / frames as f64).collect();
        let square: f64 = rows().flat_map(|row| row.iter().zip(&mean).map(|(x, m)| (x - m).powi(2))).sum();
        (mean, (square / (3 * frames) as f64).sqrt())
    });
    let rows: Vec<&[f64]> = rows().collect();
    (Mat::from_fn(frames, 3, |t, d| (rows[t][d] - mean[d]) / deviation), (mean, deviation))
}

/// Identifies one joint, then runs dense f64 and modal f32 side by side over `test`. Returns the largest difference over the
/// deviation of the output.
fn compare(source: &Locals, target: &Locals, test: &Locals, index: usize, name: &str) -> f64 {
    let (u, scale) = joint(source, index, None);
    let (y, _) = joint(target, index, Some(&scale));
    let frames = u.nrows().min(y.nrows());
    let y = y.subrows(0, frames).to_owned();
    let covered = 0..frames;
    let response = impulse_response(&[u], &[y], &[covered], 48, 60.0).unwrap();
    let dense = balanced(&response, ORDER);
    assert_eq!(dense.a.nrows(), ORDER);
    let modal = modal(&dense);
    let blocks: Vec<JointBlock> = (0..ORDER / 2)
        .map(|k| {
            let mut block = [0.0f32; 16];
            block[..4].copy_from_slice(&modal.dynamics.transition[k].map(|x| x as f32));
            for (to, from) in block[4..10].iter_mut().zip(&modal.dynamics.input[6 * k..6 * k + 6]) {
                *to = *from as f32;
            }
            for row in 0..3 {
                block[10 + row] = modal.output[(row, 2 * k)] as f32;
                block[13 + row] = modal.output[(row, 2 * k + 1)] as f32;
            }
            block
        })
        .collect();

    let (test, _) = joint(test, index, Some(&scale));
    let mut x = faer::Col::<f64>::zeros(ORDER);
    let mut states = vec![[0.0f32; 2]; blocks.len()];
    let (mut largest, mut square) = (0.0f64, 0.0);
    const FRAMES: usize = 10_000;
    for t in 0..FRAMES {
        let u = test.row(t % test.nrows());
        let expected = &dense.c * &x;
        x = &dense.a * &x + &dense.b * u.transpose();
        let mut y = [0.0f32; 3];
        advance_joint(&blocks, [u[0] as f32, u[1] as f32, u[2] as f32], &mut states, &mut y);
        for (d, y) in y.into_iter().enumerate() {
            largest = largest.max((f64::from(y) - expected[d]).abs());
            square += expected[d].powi(2);
        }
    }
    let deviation = (square / (3 * FRAMES) as f64).sqrt();
    let direct = 9;
    let (dense_adds, modal_adds) = (ORDER * ORDER + 2 * 3 * ORDER + direct, 16 * blocks.len() + direct);
    println!(
        "{name}: order {ORDER}, dense {dense_adds} multiply-adds a frame, modal {modal_adds} ({:.2} times fewer); largest \
         difference over {FRAMES} frames {:.2e} of the output's deviation; condition of the modes {:.1e}",
        dense_adds as f64 / modal_adds as f64,
        largest / deviation,
        modal.condition
    );
    assert!(dense_adds >= 5 * modal_adds);
    largest / deviation
}

#[test]
fn modal_form_is_the_dense_form_on_made_walks() {
    let walk = |manner: &Manner, seed| walk(manner, 20.0, 60.0, 0.0, seed);
    let (a, b, c) = (walk(&Manner::NEUTRAL, 1), walk(&Manner::WEARY, 2), walk(&Manner::NEUTRAL, 3));
    let rig = Rig::new(&a.skeleton, &JointMap::detect(&a.skeleton).unwrap()).unwrap();
    let locals = |clip: &clip::Clip| rig.locals(&rig.poses(clip));
    for index in [3, 15] {
        assert!(compare(&locals(&a), &locals(&b), &locals(&c), index, "made walk") < 1e-3);
    }
}

#[test]
fn modal_form_is_the_dense_form_on_real_walks() {
    let Some(data) = kinesic_tests::data("modal_form_is_the_dense_form_on_real_walks") else { return };
    let read = |name: &str| Source::read(&data.join("xia").join(name), &Default::default()).unwrap();
    let (a, b, c) = (read("neutral_01_000.bvh"), read("angry_01_000.bvh"), read("neutral_01_001.bvh"));
    let rig = a.rig().unwrap();
    let locals = |source: &Source| rig.locals(&rig.poses(&source.on_rig(&rig, 60.0).unwrap()));
    for name in ["LeftFoot", "RightHand", "Head"] {
        let index = rig.skeleton.find(name).unwrap();
        assert!(compare(&locals(&a), &locals(&b), &locals(&c), index, name) < 1e-3);
    }
}
