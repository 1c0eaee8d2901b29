//! Inverse kinematics of one pose: damped least squares within a box.
//!
//! Levenberg-Marquardt on the differences of arrows, with the exact Jacobian. A variable at a bound that wants to go further is taken out
//! of the step (active set); what a step carries over a bound is put back on it.

use nalgebra::Vector3;

use super::body::{Arrow, Body};

/// An arrow of the robot, what moves it, and how much its error counts.
pub(super) struct Term {
    pub arrow: Arrow,
    pub movers: Vec<(usize, i8)>,
    pub weight: f64,
}

/// A pull on every variable.
pub(super) struct Pull<'p> {
    pub to: &'p [f64],
    pub weight: f64,
}

pub(super) struct Solver<'b> {
    pub body: &'b Body<'b>,
    pub terms: Vec<Term>,
    /// Variables that move an arrow.
    pub active: Vec<usize>,
    /// Place of each variable among the active ones.
    slot: Vec<Option<usize>>,
}

impl<'b> Solver<'b> {
    pub fn new(body: &'b Body<'b>, terms: Vec<Term>) -> Self {
        let mut slot = vec![None; body.variables.len()];
        let frames = body.placed(&vec![0.0; body.variables.len()]);
        for term in &terms {
            body.slopes(&frames, term.arrow, &term.movers, |variable, _| slot[variable] = Some(0));
        }
        // A slope may vanish at zero: every mover counts, not only those that move the arrow now. A locked one does not.
        let free = |variable: usize| body.variables[variable].lower < body.variables[variable].upper;
        let active: Vec<usize> = (0..slot.len()).filter(|at| slot[*at].is_some() && free(*at)).collect();
        slot.fill(None);
        active.iter().enumerate().for_each(|(place, variable)| slot[*variable] = Some(place));
        Self { body, terms, active, slot }
    }

    /// Bounds of every variable.
    pub fn bounds(&self) -> Vec<[f64; 2]> {
        self.body.variables.iter().map(|variable| [variable.lower, variable.upper]).collect()
    }

    /// Variables that move an arrow, those that are held left out.
    pub fn movers(&self, term: usize) -> Vec<usize> {
        let mut moving: Vec<usize> =
            self.terms[term].movers.iter().filter_map(|(joint, _)| self.body.variable(*joint)).collect();
        moving.retain(|at| self.active.contains(at));
        moving.sort_unstable();
        moving.dedup();
        moving
    }

    /// Sum of squares: of arrows' errors, and of what pulls.
    pub fn cost(&self, values: &[f64], targets: &[Option<Vector3<f64>>], pulls: &[Pull]) -> f64 {
        let frames = self.body.placed(values);
        let arrows = self.terms.iter().zip(targets).filter_map(|(term, target)| {
            Some(term.weight * (self.body.arrow(&frames, term.arrow) - (*target)?).norm_squared())
        });
        let pulled = pulls
            .iter()
            .map(|pull| pull.weight * self.active.iter().map(|at| (values[*at] - pull.to[*at]).powi(2)).sum::<f64>());
        arrows.sum::<f64>() + pulled.sum::<f64>()
    }

    /// Moves the values to a least sum of squares near them, in the box of bounds. Gives that sum.
    pub fn solve(
        &self,
        values: &mut [f64],
        targets: &[Option<Vector3<f64>>],
        pulls: &[Pull],
        within: &[[f64; 2]],
        most: usize,
    ) -> f64 {
        let n = self.active.len();
        let bounds = |place: usize| within[self.active[place]].into();
        let mut cost = self.cost(values, targets, pulls);
        let mut damping: f64 = 1e-3;
        let mut tried = values.to_vec();
        for _ in 0..most {
            let frames = self.body.placed(values);
            let (mut square, mut slope) = (vec![0.0; n * n], vec![0.0; n]);
            for (term, target) in self.terms.iter().zip(targets) {
                let Some(target) = target else { continue };
                let rest = self.body.arrow(&frames, term.arrow) - target;
                let mut columns: Vec<(usize, Vector3<f64>)> = Vec::with_capacity(term.movers.len());
                self.body.slopes(&frames, term.arrow, &term.movers, |variable, slope| {
                    columns.extend(self.slot[variable].map(|place| (place, slope)));
                });
                for (a, first) in &columns {
                    slope[*a] += term.weight * first.dot(&rest);
                    for (b, second) in &columns {
                        square[a * n + b] += term.weight * first.dot(second);
                    }
                }
            }
            for pull in pulls {
                for (place, at) in self.active.iter().enumerate() {
                    slope[place] += pull.weight * (values[*at] - pull.to[*at]);
                    square[place * n + place] += pull.weight;
                }
            }
            for place in 0..n {
                let (value, (lower, upper)): (f64, (f64, f64)) = (values[self.active[place]], bounds(place));
                if (value <= lower && slope[place] > 0.0) || (value >= upper && slope[place] < 0.0) {
                    (0..n).for_each(|other| (square[place * n + other], square[other * n + place]) = (0.0, 0.0));
                    (square[place * n + place], slope[place]) = (1.0, 0.0);
                }
            }
            let mut better = false;
            let mut largest = 0.0f64;
            for _ in 0..8 {
                let mut damped = square.clone();
                for place in 0..n {
                    damped[place * n + place] += damping * (square[place * n + place] + 1e-3);
                }
                let mut step = slope.clone();
                if !divide(&mut damped, &mut step) {
                    damping *= 8.0;
                    continue;
                }
                tried.copy_from_slice(values);
                largest = 0.0;
                for (place, at) in self.active.iter().enumerate() {
                    let (lower, upper): (f64, f64) = bounds(place);
                    tried[*at] = (values[*at] - step[place].clamp(-0.5, 0.5)).clamp(lower, upper);
                    largest = largest.max((tried[*at] - values[*at]).abs());
                }
                let found = self.cost(&tried, targets, pulls);
                if found < cost {
                    (better, cost) = (true, found);
                    values.copy_from_slice(&tried);
                    damping = (damping / 4.0).max(1e-9);
                    break;
                }
                damping *= 8.0;
            }
            if !better || largest < 1e-7 {
                break;
            }
        }
        cost
    }
}

/// Solves `square x = right` for a symmetric matrix `[n x n]` by Cholesky, in place; not where it is not positive definite.
fn divide(square: &mut [f64], right: &mut [f64]) -> bool {
    let n = right.len();
    for column in 0..n {
        for row in column..n {
            let dot: f64 = (0..column).map(|k| square[row * n + k] * square[column * n + k]).sum();
            let rest = square[row * n + column] - dot;
            if row == column {
                if rest <= 1e-15 {
                    return false;
                }
                square[row * n + column] = rest.sqrt();
            } else {
                square[row * n + column] = rest / square[column * n + column];
            }
        }
    }
    for row in 0..n {
        let dot: f64 = (0..row).map(|k| square[row * n + k] * right[k]).sum();
        right[row] = (right[row] - dot) / square[row * n + row];
    }
    for row in (0..n).rev() {
        let dot: f64 = (row + 1..n).map(|k| square[k * n + row] * right[k]).sum();
        right[row] = (right[row] - dot) / square[row * n + row];
    }
    true
}
