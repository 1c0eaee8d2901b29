//! Cholesky factorisation of small matrices in one workspace: thousands of joints' systems a second, without allocation.
//! For use inside [`Work`](crate::vector::Work).

use crate::vector::dot;

/// `A = L L'`, row-major, of a size that changes from use to use.
#[derive(Debug, Default)]
pub(super) struct Cholesky {
    size: usize,
    lower: Vec<f64>,
}

impl Cholesky {
    /// Factorises a symmetric matrix, `entry(row, column)` for `column <= row`, plus `damping` times its mean diagonal on the
    /// diagonal, so that two rows that have become alike do not grow against each other. Cost: `size^3 / 6` multiply-adds.
    #[inline(always)]
    pub fn factorise(&mut self, size: usize, damping: f64, entry: impl Fn(usize, usize) -> f64) {
        self.size = size;
        self.lower.clear();
        self.lower.resize(size * size, 0.0);
        let trace: f64 = (0..size).map(|k| entry(k, k)).sum();
        let added = damping * trace / size.max(1) as f64 + f64::MIN_POSITIVE;
        for row in 0..size {
            let (above, own) = self.lower.split_at_mut(row * size);
            for column in 0..row {
                let other = &above[column * size..][..size];
                own[column] = (entry(row, column) - dot(&own[..column], &other[..column])) / other[column];
            }
            let pivot = entry(row, row) + added - dot(&own[..row], &own[..row]);
            // The damping keeps it positive; what rounding leaves of a row without energy must not divide by zero.
            own[row] = pivot.max(added).sqrt();
        }
    }

    /// `x <- L^-1 x`; `x'x` is then the quadratic form of `A^-1`.
    #[inline(always)]
    pub fn forward(&self, x: &mut [f64]) {
        for row in 0..self.size {
            let lower = &self.lower[row * self.size..][..=row];
            x[row] = (x[row] - dot(&lower[..row], &x[..row])) / lower[row];
        }
    }

    /// `x <- A^-1 x`.
    #[inline(always)]
    pub fn solve(&self, x: &mut [f64]) {
        self.forward(x);
        for row in (0..self.size).rev() {
            x[row] /= self.lower[row * self.size + row];
            let solved = x[row];
            for (x, lower) in x[..row].iter_mut().zip(&self.lower[row * self.size..]) {
                *x -= lower * solved;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solves_what_it_factorised() {
        let matrix = [[4.0, 1.0, -0.5], [1.0, 3.0, 0.2], [-0.5, 0.2, 2.0]];
        let mut cholesky = Cholesky::default();
        // A larger one first: nothing of it may stay behind.
        cholesky.factorise(5, 0.0, |r, c| if r == c { 9.0 } else { 1.0 });
        cholesky.factorise(3, 0.0, |r, c| matrix[r][c]);
        let mut x = [1.0, -2.0, 3.0];
        cholesky.solve(&mut x);
        for (row, right) in matrix.iter().zip([1.0, -2.0, 3.0]) {
            assert!((dot(row, &x) - right).abs() < 1e-14);
        }
        let mut unit = [0.0, 1.0, 0.0];
        let mut inverse = unit;
        cholesky.solve(&mut inverse);
        cholesky.forward(&mut unit);
        assert!((dot(&unit, &unit) - inverse[1]).abs() < 1e-15, "entry (1, 1) of the inverse");
    }

    #[test]
    fn alike_and_empty_rows_stay_finite() {
        let mut cholesky = Cholesky::default();
        cholesky.factorise(3, 1e-5, |r, c| if r == 2 || c == 2 { 0.0 } else { 1.0 });
        let mut x = [1.0, 1.0, 0.0];
        cholesky.solve(&mut x);
        assert!(x.iter().all(|x| x.is_finite()) && (x[0] + x[1] - 1.0).abs() < 1e-3, "{x:?}");
    }
}
