//! What a ranking function sees of a motion: positions and velocities at its keyframes, in principal components.

use faer::{Mat, Side};

use super::keyframes::Keyframes;
use super::segment::Segment;
use crate::learn::Samples;
use crate::vector::oriented;

/// Positions, m, then velocities since the keyframe before, m/s, keyframe by keyframe: `[keyframes x 6 joints]`. The first
/// keyframe has the second's velocity. `None` if the motion has fewer frames than keyframes.
pub fn features(motion: &Segment, keyframes: &Keyframes) -> Option<Vec<f64>> {
    Some(at_frames(motion, &keyframes.find(motion)?))
}

/// The same at given frames.
pub fn at_frames(motion: &Segment, frames: &[usize]) -> Vec<f64> {
    let mut features = Vec::with_capacity(2 * frames.len() * motion.channels());
    for k in 0..frames.len() {
        features.extend_from_slice(motion.frame(frames[k]));
        let (from, to) = (frames[k.max(1) - 1], frames[k.max(1)]);
        let seconds = (to - from) as f64 * motion.frame_time;
        features.extend(motion.frame(to).iter().zip(motion.frame(from)).map(|(b, a)| (b - a) / seconds));
    }
    features
}

/// Principal components of the keyframes of all motions; velocities divided so that they vary as much as positions.
#[derive(Clone, Debug, PartialEq)]
pub struct Projection {
    /// Mean keyframe, m and m/s, `[6 joints]`.
    pub mean: Vec<f64>,
    /// What velocities are divided by, 1/s.
    pub scale: f64,
    /// Directions of length one, in scaled numbers, strongest first, `[components x 6 joints]`.
    pub components: Vec<f64>,
    /// Share of the scaled variance that they hold.
    pub explained: f64,
}

impl Projection {
    /// The `count` strongest components of keyframes `[rows x 6 joints]`. Cost: `rows (6 joints)^2` multiply-adds and an
    /// eigendecomposition.
    pub fn learn(keyframes: &Samples, count: usize) -> Self {
        let (channels, mean) = (keyframes.columns(), keyframes.mean());
        let half = channels / 2;
        let mut squares = [0.0f64; 2];
        for row in keyframes.iter() {
            for (c, (x, m)) in row.iter().zip(&mean).enumerate() {
                squares[usize::from(c >= half)] += (x - m) * (x - m);
            }
        }
        let scale = if squares[0] > 0.0 && squares[1] > 0.0 { (squares[1] / squares[0]).sqrt() } else { 1.0 };
        let mut projection = Self { mean, scale, components: Vec::new(), explained: 0.0 };
        let centred = Mat::from_fn(keyframes.rows(), channels, |i, c| {
            (keyframes.row(i)[c] - projection.mean[c]) / if c < half { 1.0 } else { scale }
        });
        let covariance = centred.transpose() * &centred;
        let total: f64 = (0..channels).map(|c| covariance[(c, c)]).sum();
        if let Ok(eigen) = covariance.self_adjoint_eigen(Side::Lower) {
            let count = count.min(channels);
            let mut kept = 0.0;
            // Ascending in faer.
            for k in (channels - count..channels).rev() {
                kept += eigen.S()[k].max(0.0);
                projection.components.extend(oriented((0..channels).map(|c| eigen.U()[(c, k)]).collect()));
            }
            projection.explained = if total > 0.0 { kept / total } else { 1.0 };
        }
        projection
    }

    /// Every number by itself, scaled: what components are compared with.
    pub fn identity(keyframes: &Samples) -> Self {
        let mut projection = Self::learn(keyframes, 0);
        let channels = keyframes.columns();
        projection.components = (0..channels * channels).map(|at| f64::from(at / channels == at % channels)).collect();
        projection.explained = 1.0;
        projection
    }

    /// Number of components.
    pub fn count(&self) -> usize {
        self.components.len() / self.mean.len()
    }

    /// Coordinates of the keyframes of a motion, `[keyframes x components]`.
    pub fn coordinates(&self, features: &[f64]) -> Vec<f64> {
        let (channels, half) = (self.mean.len(), self.mean.len() / 2);
        let mut coordinates = Vec::with_capacity(features.len() / channels * self.count());
        for row in features.chunks_exact(channels) {
            let scaled: Vec<f64> = (row.iter().zip(&self.mean).enumerate())
                .map(|(c, (x, m))| (x - m) / if c < half { 1.0 } else { self.scale })
                .collect();
            coordinates.extend(self.components.chunks_exact(channels).map(|b| crate::vector::dot(b, &scaled)));
        }
        coordinates
    }

    /// Keyframes from their coordinates.
    pub fn features(&self, coordinates: &[f64]) -> Vec<f64> {
        let (channels, half) = (self.mean.len(), self.mean.len() / 2);
        let mut features = Vec::new();
        for row in coordinates.chunks_exact(self.count().max(1)) {
            let mut sum = vec![0.0; channels];
            for (x, b) in row.iter().zip(self.components.chunks_exact(channels)) {
                crate::learn::samples::add_scaled(&mut sum, *x, b);
            }
            let unscaled = sum.iter().zip(&self.mean).enumerate();
            features.extend(unscaled.map(|(c, (x, m))| m + x * if c < half { 1.0 } else { self.scale }));
        }
        features
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clip::JointMap;
    use crate::emotion::segment::{Cut, FRAME_RATE, cut};
    use crate::gait::{Manner, skeleton, walk};
    use crate::rig::Rig;

    fn rig() -> Rig {
        let skeleton = skeleton();
        Rig::new(&skeleton, &JointMap::detect(&skeleton).unwrap()).unwrap()
    }

    fn walks() -> Vec<Segment> {
        let rig = rig();
        let clips = [walk(&Manner::NEUTRAL, 8.0, FRAME_RATE, 0.2, 2), walk(&Manner::WEARY, 8.0, FRAME_RATE, 0.7, 4)];
        clips.iter().flat_map(|clip| cut(&rig, clip, Cut::Cycles)).collect()
    }

    #[test]
    fn velocities_are_what_the_positions_travel_in_the_time_between() {
        let walks = walks();
        let keyframes = Keyframes::learn(&rig(), &walks.iter().collect::<Vec<_>>(), 7);
        let (motion, channels) = (&walks[1], walks[1].channels());
        let rows = features(motion, &keyframes).unwrap();
        let frames = keyframes.find(motion).unwrap();
        let rows: Vec<&[f64]> = rows.chunks_exact(2 * channels).collect();
        assert_eq!(rows.len(), 7);
        assert_eq!(rows[0][channels..], rows[1][channels..]);
        for k in 1..7 {
            let seconds = (frames[k] - frames[k - 1]) as f64 / FRAME_RATE;
            for c in 0..channels {
                assert!((rows[k - 1][c] + seconds * rows[k][channels + c] - rows[k][c]).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn all_components_give_the_keyframes_back_and_few_nearly() {
        let walks = walks();
        let keyframes = Keyframes::learn(&rig(), &walks.iter().collect::<Vec<_>>(), 7);
        let rows: Vec<f64> = walks.iter().flat_map(|motion| features(motion, &keyframes).unwrap()).collect();
        let columns = 2 * walks[0].channels();
        let samples = Samples::new(&rows, columns);
        let error = |projection: &Projection| {
            let back = projection.features(&projection.coordinates(&rows));
            (back.iter().zip(&rows).map(|(a, b)| (a - b) * (a - b)).sum::<f64>() / rows.len() as f64).sqrt()
        };
        let all = Projection::learn(&samples, columns);
        let still =
            samples.iter().flat_map(|row| row.iter().zip(&all.mean)).map(|(x, m)| (x - m) * (x - m)).sum::<f64>();
        let still = (still / rows.len() as f64).sqrt();
        assert!(error(&all) < 1e-9 && (all.explained - 1.0).abs() < 1e-9);
        assert!(error(&Projection::identity(&samples)) < 1e-9);
        let few = Projection::learn(&samples, 10);
        assert!(few.count() == 10 && few.explained > 0.98 && few.explained < 1.0, "{}", few.explained);
        assert!(error(&few) < 0.2 * still, "{} {still}", error(&few));
    }
}
