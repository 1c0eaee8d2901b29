//! Cholesky factorisation of small matrices in one workspace: thousands of joints' systems a second, without allocation.
//! For use inside [`Work`](crate::vector::Work).

/// Columns begin at multiples of this: whole vectors without a rest. What is above the diagonal is never read.
const LANES: usize = 8;

/// `A = L L'`, of a size that changes from use to use.
#[derive(Debug, Default)]
pub(super) struct Cholesky {
    size: usize,
    /// Rows from one column to the next.
    stride: usize,
    /// `L`, column-major.
    lower: Vec<f64>,
    /// One over the diagonal of `L`.
    inverse: Vec<f64>,
    /// `L^-1`, row-major, and the sums of its columns' squares.
    rows: Vec<f64>,
    squares: Vec<f64>,
}

impl Cholesky {
    /// Factorises a symmetric matrix, `entry(row, column)` for `column <= row`, plus `damping` times its mean diagonal on the
    /// diagonal, so that two rows that have become alike do not grow against each other. Cost: `size^3 / 6` multiply-adds.
    #[inline(always)]
    pub fn factorise(&mut self, size: usize, damping: f64, entry: impl Fn(usize, usize) -> f64) {
        self.size = size;
        self.stride = size.next_multiple_of(LANES);
        self.lower.clear();
        self.lower.resize(size * self.stride, 0.0);
        self.inverse.clear();
        let trace: f64 = (0..size).map(|k| entry(k, k)).sum();
        let added = damping * trace / size.max(1) as f64 + f64::MIN_POSITIVE;
        for column in 0..size {
            let (before, own) = self.lower.split_at_mut(column * self.stride);
            let own = &mut own[..self.stride];
            for (row, to) in own[..size].iter_mut().enumerate().skip(column) {
                *to = entry(row, column);
            }
            own[column] += added;
            // From the vector that holds the diagonal.
            let from = column / LANES * LANES;
            for other in before.chunks_exact(self.stride) {
                subtract(&mut own[from..], other[column], &other[from..]);
            }
            // The damping keeps it positive; what rounding leaves of a row without energy must not divide by zero.
            let pivot = own[column].max(added).sqrt();
            own[column] = pivot;
            let inverse = 1.0 / pivot;
            own[column + 1..].iter_mut().for_each(|x| *x *= inverse);
            self.inverse.push(inverse);
        }
    }

    /// `x <- L^-1 x`; `x'x` is then the quadratic form of `A^-1`.
    #[inline(always)]
    pub fn forward(&self, x: &mut [f64]) {
        for (row, (column, inverse)) in self.lower.chunks_exact(self.stride.max(1)).zip(&self.inverse).enumerate() {
            x[row] *= inverse;
            let solved = x[row];
            x[row + 1..].iter_mut().zip(&column[row + 1..]).for_each(|(x, lower)| *x -= solved * lower);
        }
    }

    /// `X <- A^-1 X` for four right sides: a row of `X` is one vector.
    #[inline(always)]
    pub fn solve(&self, x: &mut [[f64; 4]]) {
        let Self { size, stride, lower, inverse, .. } = self;
        for row in 0..*size {
            let solved = x[row].map(|x| x * inverse[row]);
            x[row] = solved;
            for (x, lower) in x[row + 1..*size].iter_mut().zip(&lower[row * stride + row + 1..]) {
                *x = less(*x, *lower, solved);
            }
        }
        for row in (0..*size).rev() {
            let solved = x[row].map(|x| x * inverse[row]);
            x[row] = solved;
            for (x, lower) in x[..row].iter_mut().zip(lower[row..].iter().step_by(*stride)) {
                *x = less(*x, *lower, solved);
            }
        }
    }

    /// The diagonal of `A^-1`. Cost: `size^3 / 6` multiply-adds.
    #[inline(always)]
    pub fn inverse_diagonal(&mut self) -> &[f64] {
        let Self { size, stride, lower, inverse, rows, squares } = self;
        rows.clear();
        rows.resize(*size * *stride, 0.0);
        squares.clear();
        squares.resize(*stride, 0.0);
        for row in 0..*size {
            let (before, own) = rows.split_at_mut(row * *stride);
            // Up to the vector that holds the diagonal.
            let own = &mut own[..(row + 1).next_multiple_of(LANES)];
            for (k, other) in before.chunks_exact(*stride).enumerate() {
                let until = (k + 1).next_multiple_of(LANES);
                subtract(&mut own[..until], lower[k * *stride + row], &other[..until]);
            }
            own[row] = 1.0;
            let factor = inverse[row];
            own.iter_mut().for_each(|x| *x *= factor);
            squares.iter_mut().zip(own.iter()).for_each(|(sum, x)| *sum += x * x);
        }
        &squares[..*size]
    }
}

/// `to -= factor from`, in whole vectors.
#[inline(always)]
fn subtract(to: &mut [f64], factor: f64, from: &[f64]) {
    for (to, from) in to.as_chunks_mut::<LANES>().0.iter_mut().zip(from.as_chunks::<LANES>().0) {
        *to = less(*to, factor, *from);
    }
}

/// `to - factor from`. By value: a vector is read, changed and written as one.
#[inline(always)]
fn less<const N: usize>(to: [f64; N], factor: f64, from: [f64; N]) -> [f64; N] {
    std::array::from_fn(|lane| to[lane] - factor * from[lane])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vector::dot;

    /// Four times the same.
    fn four(x: &[f64]) -> Vec<[f64; 4]> {
        x.iter().map(|x| [*x; 4]).collect()
    }

    #[test]
    fn solves_what_it_factorised() {
        let matrix = [[4.0, 1.0, -0.5], [1.0, 3.0, 0.2], [-0.5, 0.2, 2.0]];
        let mut cholesky = Cholesky::default();
        // A larger one first: nothing of it may stay behind.
        cholesky.factorise(5, 0.0, |r, c| if r == c { 9.0 } else { 1.0 });
        cholesky.factorise(3, 0.0, |r, c| matrix[r][c]);
        let mut x = four(&[1.0, -2.0, 3.0]);
        cholesky.solve(&mut x);
        for (row, right) in matrix.iter().zip([1.0, -2.0, 3.0]) {
            assert!((0..4).all(|side| (dot(row, &[0, 1, 2].map(|k| x[k][side])) - right).abs() < 1e-14));
        }
        let mut unit = [0.0, 1.0, 0.0];
        let mut inverse = four(&unit);
        cholesky.solve(&mut inverse);
        cholesky.forward(&mut unit);
        assert!((dot(&unit, &unit) - inverse[1][0]).abs() < 1e-15, "entry (1, 1) of the inverse");
    }

    #[test]
    fn the_diagonal_of_the_inverse_at_any_size() {
        let mut cholesky = Cholesky::default();
        for size in [1, 7, 8, 9, 25] {
            cholesky.factorise(size, 0.0, |r, c| 1.0 / (1.0 + (r - c) as f64) + if r == c { 1.0 } else { 0.0 });
            let diagonal = cholesky.inverse_diagonal().to_vec();
            assert_eq!(diagonal.len(), size);
            for (at, entry) in diagonal.iter().enumerate() {
                let mut unit = vec![[0.0; 4]; size];
                unit[at] = [1.0; 4];
                cholesky.solve(&mut unit);
                assert!((unit[at][3] - entry).abs() < 1e-14, "{size} {at}: {} {entry}", unit[at][3]);
            }
        }
    }

    #[test]
    fn alike_and_empty_rows_stay_finite() {
        let mut cholesky = Cholesky::default();
        cholesky.factorise(3, 1e-5, |r, c| if r == 2 || c == 2 { 0.0 } else { 1.0 });
        let mut x = four(&[1.0, 1.0, 0.0]);
        cholesky.solve(&mut x);
        assert!(x.as_flattened().iter().all(|x| x.is_finite()) && (x[0][0] + x[1][0] - 1.0).abs() < 1e-3, "{x:?}");
    }
}
