//! Loops compiled for the widest vectors that the machine has.

pub use pulp::NullaryFnOnce as Work;

/// Runs `work` with the vector instructions of this machine. Loops in it are compiled for each kind of machine and chosen when
/// the program runs; every operation is rounded as elsewhere, so that results have the same bits.
///
/// A short closure will do. What is longer than the compiler inlines by itself is a type with an `inline(always)` [`Work::call`]:
/// a closure that is called and not inlined is compiled for any machine, and so are the closures of iterators in it
/// (`perf report` shows them as `call_once` and `fold`).
#[inline(always)]
pub fn vectorised<W: Work>(work: W) -> W::Output {
    pulp::Arch::new().dispatch(work)
}

/// An eigenvector with the sign by which its largest entry is positive. Either sign is one; which one a library finds depends on the
/// instructions of the machine.
pub fn oriented(mut vector: Vec<f64>) -> Vec<f64> {
    let largest = vector.iter().fold(0.0f64, |largest, x| if x.abs() > largest.abs() { *x } else { largest });
    if largest < 0.0 {
        vector.iter_mut().for_each(|x| *x = -*x);
    }
    vector
}

/// `a' b` over the shorter length, summed in eight lanes: the same bits with vectors of any width.
#[inline(always)]
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    let (wide_a, rest_a) = a.as_chunks::<8>();
    let (wide_b, rest_b) = b.as_chunks::<8>();
    let mut lanes = [0.0; 8];
    for (a, b) in wide_a.iter().zip(wide_b) {
        for ((lane, a), b) in lanes.iter_mut().zip(a).zip(b) {
            *lane += a * b;
        }
    }
    let rest: f64 = rest_a.iter().zip(rest_b).map(|(a, b)| a * b).sum();
    // Without the box the order of this sum decides the order of the lanes: vectors of two, shuffled at every step.
    let [a, b, c, d, e, f, g, h] = std::hint::black_box(lanes);
    ((a + b) + (c + d)) + ((e + f) + (g + h)) + rest
}

/// Offset and slope of the regression of the second number on the first; `None` where the first is always the same.
pub fn line(points: &[(f64, f64)]) -> Option<(f64, f64)> {
    let count = points.len() as f64;
    let [x, y] = points.iter().fold([0.0; 2], |[a, b], (x, y)| [a + x / count, b + y / count]);
    let squares: f64 = points.iter().map(|(a, _)| (a - x) * (a - x)).sum();
    let slope = points.iter().map(|(a, b)| (a - x) * (b - y)).sum::<f64>() / squares;
    (squares > 0.0).then_some((y - slope * x, slope))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_signs_of_a_vector_become_one() {
        let vector = vec![0.1, -0.7, 0.3];
        assert_eq!(oriented(vector.clone()), [-0.1, 0.7, -0.3]);
        assert_eq!(oriented(vector.iter().map(|x| -x).collect()), oriented(vector));
    }

    #[test]
    fn a_line_through_points() {
        let (offset, slope) = line(&[(0.0, 1.0), (1.0, 3.0), (2.0, 5.0)]).unwrap();
        assert!((offset - 1.0).abs() < 1e-12 && (slope - 2.0).abs() < 1e-12);
        assert_eq!(line(&[(1.0, 1.0), (1.0, 3.0)]), None);
    }
}
