//! What style learning minimises, and its gradient.

use faer::{Mat, MatRef};

use super::factor::{Factors, column, column_mut, product};
use crate::rig::Rig;
use crate::vector::{Work, vectorised};

/// Bones shorter than this are joints in one place, m.
const SHORTEST_BONE: f64 = 1e-4;

/// Weights of the terms.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weights {
    /// `c`: components like the content's.
    pub content: f64,
    /// `s`: Gram matrix like the style's.
    pub style: f64,
    /// Bones that keep their length.
    pub bones: f64,
    /// Velocities and accelerations like the content's; beyond the paper (its open point 4).
    pub smooth: f64,
}

impl Default for Weights {
    fn default() -> Self {
        Self { content: 1.0, style: 0.01, bones: 10.0, smooth: 0.0 }
    }
}

/// Values of the terms, unweighted.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Terms {
    /// `|C_C - C_X|^2`.
    pub content: f64,
    /// `|Gram(C_S) - Gram(C_X)|^2`.
    pub style: f64,
    /// `1/F sum over frames and bones of (length - rest)^2`, in deviations.
    pub bones: f64,
    /// Mean of the squared velocity and acceleration differences to the content, each relative to the content's own.
    pub smooth: f64,
}

/// A bone from a joint to its child.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bone {
    /// `[parent, child]`.
    pub joints: [usize; 2],
    /// Rest length, m.
    pub length: f64,
}

/// The bones of a rig that have a length.
pub fn bones(rig: &Rig) -> Vec<Bone> {
    let joints = rig.skeleton.joints.iter().enumerate();
    joints
        .filter_map(|(child, joint)| Some(Bone { joints: [joint.parent?, child], length: joint.offset.norm() }))
        .filter(|bone| bone.length > SHORTEST_BONE)
        .collect()
}

/// `C' C`, `[3 joints x 3 joints]`: how much of the motion each pair of channels shares.
///
/// The other Gram matrix, `C C'`, compares component `k` of one factorisation with component `k` of another, which have
/// nothing to do with each other.
pub fn gram(components: MatRef<'_, f64>) -> Mat<f64> {
    product(components, components.transpose())
}

/// `c |C_C - C_X|^2 + s |Gram(C_S) - Gram(C_X)|^2 + b bones + v smooth` as a function of `C_X`. Phong 2018, eq. 3 to 6.
#[derive(Clone, Debug)]
pub struct Objective<'a> {
    weights: Weights,
    content: &'a Factors,
    style_gram: Mat<f64>,
    bones: &'a [Bone],
    /// Bones of the mean pose, all x, all y, all z, and rest lengths, in deviations.
    mean: Vec<f64>,
    lengths: Vec<f64>,
    /// `W' (D1' D1 / v + D2' D2 / a) W / 2`.
    smooth: Mat<f64>,
}

impl<'a> Objective<'a> {
    /// `mean`: mean pose of the result, m, `[3 joints]`; `scale`: metres in a deviation.
    pub fn new(
        content: &'a Factors,
        style: &Factors,
        bones: &'a [Bone],
        mean: &[f64],
        scale: f64,
        weights: Weights,
    ) -> Self {
        let at = |joint: usize, c: usize| mean[3 * joint + c] / scale;
        let between = |c: usize| bones.iter().map(move |bone| at(bone.joints[1], c) - at(bone.joints[0], c));
        Self {
            weights,
            content,
            style_gram: gram(style.components.as_ref()),
            bones,
            mean: (0..3).flat_map(between).collect(),
            lengths: bones.iter().map(|bone| bone.length / scale).collect(),
            smooth: smoothness(content),
        }
    }

    /// Value at `components` (`C_X` transposed), and its gradient.
    ///
    /// Cost: `2 F 3B K` multiply-adds for the bones, `2 (3N)^2 K` for the Gram matrix.
    pub fn evaluate(&self, components: &Mat<f64>, gradient: &mut Mat<f64>) -> (f64, Terms) {
        let Weights { content: c, style: s, bones: b, smooth: v } = self.weights;
        let mut terms = Terms::default();
        let apart = components - &self.content.components;
        terms.content = apart.squared_norm_l2();
        *gradient = &apart * faer::Scale(2.0 * c);
        if s != 0.0 {
            let change = gram(components.as_ref()) - &self.style_gram;
            terms.style = change.squared_norm_l2();
            *gradient += product(change.as_ref(), components.as_ref()) * faer::Scale(4.0 * s);
        }
        if v != 0.0 {
            let slope = product(apart.as_ref(), self.smooth.as_ref());
            terms.smooth = (0..apart.ncols()).map(|k| dot(column(&apart, k), column(&slope, k))).sum();
            *gradient += slope * faer::Scale(2.0 * v);
        }
        if b != 0.0 {
            terms.bones = self.add_bones(components, b, gradient);
        }
        let value = c * terms.content + s * terms.style + b * terms.bones + v * terms.smooth;
        (value, terms)
    }

    /// Terms that carry no weight are left out by [`evaluate`](Self::evaluate); here all are measured.
    pub fn measure(&self, components: &Mat<f64>) -> Terms {
        let all = Self { weights: Weights { content: 1.0, style: 1.0, bones: 1.0, smooth: 1.0 }, ..self.clone() };
        all.evaluate(components, &mut components.clone()).1
    }

    fn add_bones(&self, components: &Mat<f64>, weight: f64, gradient: &mut Mat<f64>) -> f64 {
        let weights = &self.content.weights;
        let count = self.bones.len();
        // All x, all y, all z: so that the loop over bones below is one of vectors.
        let mut edges = Mat::zeros(3 * count, components.ncols());
        for k in 0..components.ncols() {
            let (from, to) = (column(components, k), column_mut(&mut edges, k));
            for (b, Bone { joints: [parent, child], .. }) in self.bones.iter().enumerate() {
                (0..3).for_each(|c| to[c * count + b] = from[3 * child + c] - from[3 * parent + c]);
            }
        }
        // One frame a column; turned into the gradient in place.
        let mut frames = product(edges.as_ref(), weights.transpose());
        let share = 1.0 / weights.nrows().max(1) as f64;
        let mut squares = vec![0.0; count];
        vectorised(Pull { objective: self, frames: &mut frames, factor: 2.0 * share * weight, squares: &mut squares });
        let sum: f64 = squares.iter().sum();
        let slopes = product(frames.as_ref(), weights.as_ref());
        for k in 0..components.ncols() {
            let (to, slope) = (column_mut(gradient, k), column(&slopes, k));
            for (b, Bone { joints: [parent, child], .. }) in self.bones.iter().enumerate() {
                for c in 0..3 {
                    to[3 * child + c] += slope[c * count + b];
                    to[3 * parent + c] -= slope[c * count + b];
                }
            }
        }
        sum * share
    }
}

/// Turns the bones of every frame, without the mean pose, into `factor * error` times their direction; adds squared errors.
struct Pull<'a> {
    objective: &'a Objective<'a>,
    frames: &'a mut Mat<f64>,
    factor: f64,
    squares: &'a mut [f64],
}

impl Work for Pull<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { objective, frames, factor, squares } = self;
        let count = squares.len();
        let [mean_x, mean_y, mean_z] = thirds(&objective.mean, count);
        let lengths = &objective.lengths[..count];
        for f in 0..frames.ncols() {
            let (x, rest) = column_mut(frames, f).split_at_mut(count);
            let (y, z) = rest.split_at_mut(count);
            let z = &mut z[..count];
            for b in 0..count {
                let (px, py, pz) = (x[b] + mean_x[b], y[b] + mean_y[b], z[b] + mean_z[b]);
                let length = (px * px + py * py + pz * pz).sqrt();
                let error = length - lengths[b];
                squares[b] += error * error;
                // A bone of no length has no direction to grow in.
                let pull = if length > 1e-12 { factor * error / length } else { 0.0 };
                (x[b], y[b], z[b]) = (pull * px, pull * py, pull * pz);
            }
        }
    }
}

fn thirds(all: &[f64], count: usize) -> [&[f64]; 3] {
    [&all[..count], &all[count..2 * count], &all[2 * count..3 * count]]
}

/// First and second differences of the weights, each relative to how fast the content moves.
fn smoothness(content: &Factors) -> Mat<f64> {
    let count = content.count();
    let mut sum = Mat::zeros(count, count);
    let mut rows = content.weights.clone();
    for _ in 0..2 {
        let frames = rows.nrows().saturating_sub(1);
        rows = Mat::from_fn(frames, count, |f, k| rows[(f + 1, k)] - rows[(f, k)]);
        let gram = product(rows.as_ref().transpose(), rows.as_ref());
        let moved = product(content.components.as_ref(), gram.as_ref());
        let own: f64 = (0..count).map(|k| dot(column(&content.components, k), column(&moved, k))).sum();
        if own > 0.0 {
            sum += gram * faer::Scale(0.5 / own);
        }
    }
    // In units of the content term: 1 when the result has nothing in common with the content's movement.
    sum * faer::Scale(content.components.squared_norm_l2())
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
