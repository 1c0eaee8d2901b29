//! What style learning minimises, and its gradient.

use faer::{Mat, MatRef};

use super::factor::{Factors, column, product};
use crate::vector::dot;

/// Weights of the terms.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weights {
    /// `c`: components like the content's.
    pub content: f64,
    /// `s`: Gram matrix like the style's.
    pub style: f64,
    /// Velocities and accelerations like the content's; beyond the paper (its open point 4).
    pub smooth: f64,
}

impl Default for Weights {
    fn default() -> Self {
        Self { content: 1.0, style: 0.01, smooth: 0.0 }
    }
}

/// Values of the terms, unweighted.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Terms {
    /// `|C_C - C_X|^2`.
    pub content: f64,
    /// `|Gram(C_S) - Gram(C_X)|^2`.
    pub style: f64,
    /// Mean of the squared velocity and acceleration differences to the content, each relative to the content's own.
    pub smooth: f64,
}

/// `C' C`, `[3 rows x 3 rows]`: how much of the motion each pair of channels shares.
///
/// The other Gram matrix, `C C'`, compares component `k` of one factorisation with component `k` of another, which have
/// nothing to do with each other.
pub fn gram(components: MatRef<'_, f64>) -> Mat<f64> {
    product(components, components.transpose())
}

/// `c |C_C - C_X|^2 + s |Gram(C_S) - Gram(C_X)|^2 + v smooth` as a function of `C_X`. Phong 2018, eq. 3 to 6, less the
/// bone term: coordinates cannot stretch a bone.
#[derive(Clone, Debug)]
pub struct Objective<'a> {
    weights: Weights,
    content: &'a Factors,
    style_gram: Mat<f64>,
    /// `W' (D1' D1 / v + D2' D2 / a) W / 2`.
    smooth: Mat<f64>,
}

impl<'a> Objective<'a> {
    /// The objective of a content and a style in the same deviations.
    pub fn new(content: &'a Factors, style: &Factors, weights: Weights) -> Self {
        Self { weights, content, style_gram: gram(style.components.as_ref()), smooth: smoothness(content) }
    }

    /// Value at `components` (`C_X` transposed), and its gradient.
    ///
    /// Cost: `2 (3R)^2 K` multiply-adds for the Gram matrix of `R` rows.
    pub fn evaluate(&self, components: &Mat<f64>, gradient: &mut Mat<f64>) -> (f64, Terms) {
        let Weights { content: c, style: s, smooth: v } = self.weights;
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
        let value = c * terms.content + s * terms.style + v * terms.smooth;
        (value, terms)
    }

    /// Terms that carry no weight are left out by [`evaluate`](Self::evaluate); here all are measured.
    pub fn measure(&self, components: &Mat<f64>) -> Terms {
        let all = Self { weights: Weights { content: 1.0, style: 1.0, smooth: 1.0 }, ..self.clone() };
        all.evaluate(components, &mut components.clone()).1
    }
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
