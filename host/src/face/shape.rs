//! Regions of the face, and the numbers that a ranking function sees.

use std::ops::Range;

use kinesic::face::{FEATURES, INNER, MOVING, Shape};

/// Regions in the order of [`INNER`]: right eye with brow, left eye with brow, nose, mouth.
pub const REGIONS: [Range<usize>; 4] = [0..11, 11..22, 22..31, 31..MOVING];

const _: () = assert!(INNER.len() == MOVING && FEATURES == 2 * MOVING);

/// The shape in double precision, `x, y` of every moving landmark.
pub fn numbers(shape: &Shape) -> Vec<f64> {
    shape.as_flattened().iter().map(|x| f64::from(*x)).collect()
}

/// Subtracts from every region its mean: where a region is says who somebody is, its form says what they show. Applied to the
/// weights of a ranking function it has the same effect as applied to the shape.
pub fn region_local(values: &mut [f64]) {
    for region in REGIONS {
        let region = &mut values[2 * region.start..2 * region.end];
        for axis in 0..2 {
            let count = region.len() as f64 / 2.0;
            let mean = region.iter().skip(axis).step_by(2).sum::<f64>() / count;
            region.iter_mut().skip(axis).step_by(2).for_each(|x| *x -= mean);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_region_that_moves_as_a_whole_is_not_seen() {
        let mut values: Vec<f64> = (0..FEATURES).map(|i| (i * i % 17) as f64).collect();
        let mut moved = values.clone();
        moved[2 * REGIONS[1].start..2 * REGIONS[1].end].iter_mut().for_each(|x| *x += 3.0);
        region_local(&mut values);
        region_local(&mut moved);
        assert!(values.iter().zip(&moved).all(|(a, b)| (a - b).abs() < 1e-12));
        for region in REGIONS {
            let sum: f64 = values[2 * region.start..2 * region.end].iter().step_by(2).sum();
            assert!(sum.abs() < 1e-12);
        }
    }
}
