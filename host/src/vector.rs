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
    let [a, b, c, d, e, f, g, h] = lanes;
    ((a + b) + (c + d)) + ((e + f) + (g + h)) + rest
}
