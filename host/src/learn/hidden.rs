//! The hidden layer: tanh units of a few inputs, in f64 but with the device's own formula, and their slopes.

use super::samples::Samples;
use crate::vector::{Work, vectorised};

/// Where the device's tanh reaches 1.
const END: f64 = 4.97;

/// Units `tanh(w z + b)`; parameters `[units x (inputs + 1)]`, the constant last.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Hidden {
    pub inputs: usize,
    pub parameters: Vec<f64>,
}

impl Hidden {
    pub fn units(&self) -> usize {
        self.parameters.len() / (self.inputs + 1)
    }

    /// Unit by unit: values `[units x samples]`, and their slopes by what goes into the unit.
    pub fn values(&self, samples: &Samples) -> (Vec<f64>, Vec<f64>) {
        let mut values = Vec::with_capacity(self.units() * samples.rows());
        for p in self.parameters.chunks_exact(self.inputs + 1) {
            values.extend(samples.iter().map(|z| sum(p, z)));
        }
        let mut slopes = vec![0.0; values.len()];
        vectorised(Bend { values: &mut values, slopes: &mut slopes });
        (values, slopes)
    }

    /// Parameter by parameter: slopes of its unit's values `[units (inputs + 1) x samples]`, from those that `values` returned.
    pub fn slopes(&self, samples: &Samples, by_sum: &[f64]) -> Vec<f64> {
        let mut slopes = Vec::with_capacity(self.parameters.len() * samples.rows());
        for by_sum in by_sum.chunks_exact(samples.rows().max(1)) {
            for input in 0..self.inputs {
                slopes.extend(samples.iter().zip(by_sum).map(|(z, slope)| z[input] * slope));
            }
            slopes.extend(by_sum);
        }
        slopes
    }
}

/// Sums into their tanh and its slope.
struct Bend<'a> {
    values: &'a mut [f64],
    slopes: &'a mut [f64],
}

impl Work for Bend<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        for (value, slope) in self.values.iter_mut().zip(self.slopes) {
            (*value, *slope) = tanh(*value);
        }
    }
}

fn sum(parameters: &[f64], input: &[f64]) -> f64 {
    let (weights, constant) = parameters.split_at(input.len());
    constant.first().copied().unwrap_or(0.0) + weights.iter().zip(input).map(|(w, z)| w * z).sum::<f64>()
}

/// [`kinesic::kernel::tanh`] in f64, and the slope of that very formula.
#[inline(always)]
pub(super) fn tanh(x: f64) -> (f64, f64) {
    let beyond = x.abs() >= END;
    let x = if beyond { 0.999_999 * END.copysign(x) } else { x };
    let t = x * x;
    let up = x * (135_135.0 + t * (17_325.0 + t * (378.0 + t)));
    let down = 135_135.0 + t * (62_370.0 + t * (3_150.0 + t * 28.0));
    let up_slope = 135_135.0 + t * (3.0 * 17_325.0 + t * (5.0 * 378.0 + t * 7.0));
    let down_slope = x * (2.0 * 62_370.0 + t * (4.0 * 3_150.0 + t * 6.0 * 28.0));
    let value = up / down;
    let slope = (up_slope - value * down_slope) / down;
    (value, if beyond { 0.0 } else { slope })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_the_devices_tanh_and_its_slope() {
        for step in -600..=600 {
            let x = f64::from(step) * 0.01;
            let (value, slope) = tanh(x);
            assert!((value - f64::from(kinesic::kernel::tanh(x as f32))).abs() < 1e-5, "{x}");
            let numeric = (tanh(x + 1e-6).0 - tanh(x - 1e-6).0) / 2e-6;
            // At the end itself the formula has a corner.
            let corner = (x.abs() - END).abs() < 1e-3;
            assert!(corner || (slope - numeric).abs() < 1e-4, "{x}: {slope} {numeric}");
        }
    }
}
