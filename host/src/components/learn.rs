//! Style learning: Adam from seeded white noise.

use faer::Mat;
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

use super::factor::{column, column_mut};
use super::objective::{Objective, Terms};
use crate::vector::vectorised;

/// Steps over which progress is judged.
const WINDOW: usize = 20;

/// How to descend.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Optimiser {
    /// Seed of the noise that the components start from.
    pub seed: u64,
    /// Step of Adam, in deviations.
    pub rate: f64,
    /// Stop when 20 steps lower the objective by less than this share of it.
    pub threshold: f64,
    /// At most so many steps.
    pub max_steps: usize,
}

impl Default for Optimiser {
    fn default() -> Self {
        Self { seed: 1, rate: 0.1, threshold: 1e-3, max_steps: 2000 }
    }
}

/// Learned components.
#[derive(Clone, Debug)]
pub struct Learned {
    /// `C_X` transposed, `[3 rows x K]`, in deviations.
    pub components: Mat<f64>,
    /// Objective at the start and after every step.
    pub history: Vec<f64>,
    /// The terms at the end.
    pub terms: Terms,
}

/// White noise of unit deviation (sum of twelve uniform numbers: no function whose bits depend on the machine).
pub fn noise(rows: usize, columns: usize, seed: u64) -> Mat<f64> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut normal = || (0..12).map(|_| random.random::<f64>()).sum::<f64>() - 6.0;
    let mut noise = Mat::zeros(rows, columns);
    for k in 0..columns {
        column_mut(&mut noise, k).iter_mut().for_each(|x| *x = normal());
    }
    noise
}

/// Adam (Kingma 2015) from `start`; see [`noise`]. Returns the best point met.
pub fn learn(objective: &Objective, start: Mat<f64>, optimiser: &Optimiser) -> Learned {
    const FADE: [f64; 2] = [0.9, 0.999];
    let mut components = start;
    let (rows, columns) = (components.nrows(), components.ncols());
    let mut gradient = Mat::zeros(rows, columns);
    let mut mean = Mat::<f64>::zeros(rows, columns);
    let mut square = Mat::<f64>::zeros(rows, columns);
    let (value, terms) = objective.evaluate(&components, &mut gradient);
    let mut best = Learned { components: components.clone(), history: vec![value], terms };
    let mut lowest = vec![value];
    let mut faded = [1.0, 1.0];
    for step in 1..=optimiser.max_steps {
        faded = [faded[0] * FADE[0], faded[1] * FADE[1]];
        for k in 0..columns {
            let states = column_mut(&mut mean, k).iter_mut().zip(column_mut(&mut square, k));
            let points = column_mut(&mut components, k).iter_mut().zip(column(&gradient, k));
            vectorised(|| {
                for ((x, g), (m, s)) in points.zip(states) {
                    *m = FADE[0] * *m + (1.0 - FADE[0]) * g;
                    *s = FADE[1] * *s + (1.0 - FADE[1]) * g * g;
                    *x -= optimiser.rate * (*m / (1.0 - faded[0])) / ((*s / (1.0 - faded[1])).sqrt() + 1e-8);
                }
            });
        }
        let (value, terms) = objective.evaluate(&components, &mut gradient);
        best.history.push(value);
        let so_far = lowest.last().copied().unwrap_or(value);
        if value < so_far {
            best.components.clone_from(&components);
            best.terms = terms;
        }
        lowest.push(value.min(so_far));
        if step > WINDOW && lowest[step - WINDOW] - lowest[step] <= optimiser.threshold * lowest[step] {
            break;
        }
    }
    best
}
