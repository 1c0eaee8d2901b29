//! The kernel's elementary functions against f64, over every f32 of their range: the allowed errors are a table.
//!
//! The short version takes every 4099th bit pattern, both ends of every row and their neighbours. The long one takes all of them:
//! `cargo test --release -p kinesic --test exhaustive -- --ignored --nocapture` (about two minutes on two cores).

use kinesic::kernel::{quadrant_angle, sin_cos, tanh};

/// A function, the exact one, a range, and the largest absolute error in it.
struct Row {
    name: &'static str,
    found: fn(f32) -> f32,
    exact: fn(f64) -> f64,
    /// Magnitudes, first and last included; both signs are taken where `signs` says so.
    from: f32,
    to: f32,
    signs: bool,
    allowed: f64,
}

/// Cosine that belongs to a sine of the first quadrant, rounded once.
fn other(x: f32) -> f32 {
    (1.0 - f64::from(x) * f64::from(x)).sqrt() as f32
}

const ALLOWED: [Row; 10] = [
    Row { name: "tanh, to 2", found: tanh, exact: f64::tanh, from: 0.0, to: 2.0, signs: true, allowed: 1e-6 },
    Row { name: "tanh, to 5", found: tanh, exact: f64::tanh, from: 2.0, to: 5.0, signs: true, allowed: 1e-4 },
    Row { name: "tanh, beyond", found: tanh, exact: f64::tanh, from: 5.0, to: f32::MAX, signs: true, allowed: 1e-4 },
    Row {
        name: "sin, to pi",
        found: |x| sin_cos(x).0,
        exact: f64::sin,
        from: 0.0,
        to: 3.2,
        signs: true,
        allowed: 3e-7,
    },
    Row {
        name: "sin, to 100",
        found: |x| sin_cos(x).0,
        exact: f64::sin,
        from: 3.2,
        to: 100.0,
        signs: true,
        allowed: 3e-7,
    },
    Row {
        name: "cos, to pi",
        found: |x| sin_cos(x).1,
        exact: f64::cos,
        from: 0.0,
        to: 3.2,
        signs: true,
        allowed: 3e-7,
    },
    Row {
        name: "cos, to 100",
        found: |x| sin_cos(x).1,
        exact: f64::cos,
        from: 3.2,
        to: 100.0,
        signs: true,
        allowed: 3e-7,
    },
    Row {
        name: "angle, by its sine",
        found: |x| quadrant_angle(x, other(x), 1.0),
        // Of the vector as it is rounded, which need not be of length one.
        exact: |x| x.atan2(f64::from(other(x as f32))),
        from: 0.0,
        to: 1.0,
        signs: false,
        allowed: 1e-6,
    },
    Row {
        name: "angle, by its cosine",
        found: |x| quadrant_angle(other(x), x, 1.0),
        exact: |x| f64::from(other(x as f32)).atan2(x),
        from: 0.0,
        to: 1.0,
        signs: false,
        allowed: 1e-6,
    },
    Row {
        name: "sin^2 + cos^2, to 100",
        found: |x| {
            let (sin, cos) = sin_cos(x);
            sin * sin + cos * cos
        },
        exact: |_| 1.0,
        from: 0.0,
        to: 100.0,
        signs: true,
        allowed: 5e-7,
    },
];

/// Largest error, where it is, and how many values were taken.
fn worst(row: &Row, bits: impl Iterator<Item = u32>) -> (f64, f32, u64) {
    let mut worst = (0.0, 0.0, 0);
    for bits in bits {
        let x = f32::from_bits(bits);
        for x in [Some(x), row.signs.then_some(-x)].into_iter().flatten() {
            let error = (f64::from((row.found)(x)) - (row.exact)(f64::from(x))).abs();
            // A NaN is the worst of all.
            if error > worst.0 || error.is_nan() {
                (worst.0, worst.1) = (error, x);
            }
            worst.2 += 1;
        }
    }
    worst
}

fn judge(row: &Row, (error, at, count): (f64, f32, u64)) {
    println!("{:24} {count:>11} values: {error:.2e} at {at:e}, {:.0e} allowed", row.name, row.allowed);
    assert!(error <= row.allowed, "{}: {error:e} at {at:e}, {:e} allowed", row.name, row.allowed);
    assert!(error > 0.0 || row.name.contains("beyond"), "{}: nothing was compared", row.name);
}

#[test]
fn errors_are_within_the_table() {
    for row in &ALLOWED {
        let (first, last) = (row.from.to_bits(), row.to.to_bits());
        let near = (first..first + 1000).chain(last - 1000..=last);
        judge(row, worst(row, (first..=last).step_by(4099).chain(near)));
    }
}

#[test]
#[ignore = "every f32 of every row: minutes"]
fn errors_are_within_the_table_everywhere() {
    for row in &ALLOWED {
        let (first, last) = (row.from.to_bits(), row.to.to_bits());
        let threads = std::thread::available_parallelism().map_or(1, |n| n.get());
        let found = std::thread::scope(|scope| {
            let work = |start| scope.spawn(move || worst(row, (first + start as u32..=last).step_by(threads)));
            let running: Vec<_> = (0..threads).map(work).collect();
            let parts = running.into_iter().map(|thread| thread.join().unwrap());
            parts.reduce(|a, b| if a.0 >= b.0 { (a.0, a.1, a.2 + b.2) } else { (b.0, b.1, a.2 + b.2) })
        });
        judge(row, found.unwrap());
    }
}

#[test]
fn odd_arguments_give_no_surprise() {
    assert!(tanh(f32::NAN).is_nan());
    assert_eq!([tanh(f32::INFINITY), tanh(f32::NEG_INFINITY)], [tanh(f32::MAX), -tanh(f32::MAX)]);
    // Never beyond one, for any f32 there is, so that a code unit stays a code unit: tanh is monotonic up to its end.
    assert!(tanh(f32::MAX) <= 1.0 && tanh(4.97) <= 1.0);
    assert!((quadrant_angle(f32::NAN, 1.0, 1.0) - core::f32::consts::FRAC_PI_2).abs() < 1e-6);
    for x in [f32::NAN, f32::INFINITY, f32::MAX, f32::MIN_POSITIVE, 1e30] {
        // Out of range the value means nothing, but it comes, without a panic.
        let _ = (sin_cos(x), sin_cos(-x), quadrant_angle(x, x, 1.0));
    }
}
