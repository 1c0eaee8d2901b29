//! A rigid skeleton for measured positions.

use nalgebra::Vector3;

use super::{JOINTS, KinectFault, Skeleton20};
use crate::clip::solve::turn;
use crate::clip::{Joint, Skeleton};

/// Directions of the rest pose, from parent to joint: standing, arms out to the sides, facing +Z, left at +X.
const REST: [[f64; 3]; 20] = [
    [0.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.8, -0.6, 0.0],
    [1.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [-0.8, -0.6, 0.0],
    [-1.0, 0.0, 0.0],
    [-1.0, 0.0, 0.0],
    [-1.0, 0.0, 0.0],
    [0.7, -0.7, 0.0],
    [0.0, -1.0, 0.0],
    [0.0, -1.0, 0.0],
    [0.0, -0.6, 0.8],
    [-0.7, -0.7, 0.0],
    [0.0, -1.0, 0.0],
    [0.0, -1.0, 0.0],
    [0.0, -0.6, 0.8],
];

/// Joints with several children: their rest shape is measured, since three directions hardly ever fit by convention.
const HUBS: [(usize, [usize; 3]); 2] = [(0, [1, 12, 16]), (2, [3, 4, 8])];

/// Rounds of measuring a shape in the frame that the last shape gave.
const ROUNDS: usize = 5;

/// The skeleton: each bone has its median length; bones of one child point as in [`REST`], those of hubs as measured.
pub(super) fn skeleton(frames: &[Skeleton20]) -> Result<Skeleton, KinectFault> {
    let mut offsets = [Vector3::zeros(); 20];
    for (joint, (name, parent)) in JOINTS.iter().enumerate() {
        let Some(parent) = *parent else { continue };
        let mut lengths: Vec<f64> = frames.iter().map(|f| (f[joint] - f[parent]).norm()).collect();
        lengths.sort_by(f64::total_cmp);
        let length = lengths.get(lengths.len() / 2).copied().unwrap_or(0.0);
        if length < 1e-4 {
            return Err(KinectFault::NoBone { joint: name });
        }
        offsets[joint] = Vector3::from(REST[joint]).normalize() * length;
    }
    for (hub, children) in HUBS {
        let canonical = children.map(|c| offsets[c]);
        let shape = measure(frames, hub, children, canonical);
        // Any turn of the shape fits as well; the one nearest to the convention makes the rest pose stand upright.
        let upright = turn(&std::array::from_fn::<_, 3, _>(|i| (shape[i], canonical[i])));
        for (child, direction) in children.into_iter().zip(shape) {
            offsets[child] = upright * direction;
        }
    }
    let joints = JOINTS.iter().zip(offsets);
    let joints = joints.map(|(&(name, parent), offset)| Joint { name: name.into(), parent, offset, end: None });
    Ok(Skeleton { joints: joints.collect() })
}

/// Mean shape of a hub's children, each at its own length (generalised Procrustes analysis).
fn measure(frames: &[Skeleton20], hub: usize, children: [usize; 3], start: [Vector3<f64>; 3]) -> [Vector3<f64>; 3] {
    let mut shape = start;
    for _ in 0..ROUNDS {
        let mut sums = [Vector3::zeros(); 3];
        for frame in frames {
            let seen = children.map(|c| frame[c] - frame[hub]);
            let turned = turn(&std::array::from_fn::<_, 3, _>(|i| (shape[i], seen[i])));
            for (sum, seen) in sums.iter_mut().zip(seen) {
                *sum += turned.inverse() * seen;
            }
        }
        for ((place, sum), start) in shape.iter_mut().zip(sums).zip(start) {
            *place = sum.try_normalize(1e-9).unwrap_or(start.normalize()) * start.norm();
        }
    }
    shape
}
