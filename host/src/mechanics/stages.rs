//! The three fits, one after the other, from wherever an earlier run has left them.

use kinesic::mechanics::FEATURES;
use rand::rngs::ChaCha8Rng;

use super::network::{Batch, Descent, Fit, Layer, Network, twin};
use super::train::{Progress, TrainError, TrainOptions};
use crate::checkpoint::Keep;

/// Deviation of the noise on the autoencoder's inputs, by the poses' own.
const POSE_NOISE: f32 = 0.1;
/// Deviation of the noise on the features, by their own.
const FEATURE_NOISE: f32 = 0.15;
/// Samples of a step.
const BATCH: usize = 256;

/// The fitted networks, in normalised units.
pub(super) struct Networks {
    pub(super) autoencoder: Network,
    pub(super) features: Network,
    pub(super) stacked_raw: Network,
    pub(super) stacked: Network,
}

/// The data of all stages, normalised, row-major.
pub(super) struct Data<'a> {
    /// Values of a pose.
    pub(super) width: usize,
    /// Poses of all clips.
    pub(super) pool: &'a [f32],
    /// Features of the body-mechanics clips.
    pub(super) features: &'a [f32],
    /// Their poses.
    pub(super) poses: &'a [f32],
}

/// Fits all three. `random` is where the split has left it.
pub(super) fn fit_all(
    data: &Data,
    options: &TrainOptions,
    random: ChaCha8Rng,
    progress: Progress,
    keep: &mut dyn Keep,
) -> Result<Networks, TrainError> {
    let (width, code, hidden, epochs) = (data.width, options.code, options.hidden, options.epochs);
    let mut run = Run::new(progress, random, keep)?;

    let how = Fit { epochs, batch: BATCH, rate: 2e-3, noise: POSE_NOISE, decay: 0.0 };
    let start = |random: &mut ChaCha8Rng| Network {
        layers: vec![Layer::random(width, code, true, random), Layer::random(code, width, false, random)],
    };
    let batch = Batch { input: data.pool, target: data.pool };
    let autoencoder = run.stage("autoencoder", batch, &how, &start)?;

    let encoder = Network { layers: autoencoder.layers[..1].to_vec() };
    let codes = encoder.apply(data.poses);
    let how = Fit { noise: FEATURE_NOISE, decay: 1e-3, ..how };
    let start = |random: &mut ChaCha8Rng| Network {
        layers: vec![Layer::random(FEATURES, hidden, true, random), Layer::random(hidden, code, true, random)],
    };
    let batch = Batch { input: data.features, target: &codes };
    let features = run.stage("feature network", batch, &how, &start)?;

    let stacked_raw = Network { layers: features.layers.iter().chain(&autoencoder.layers[1..]).cloned().collect() };
    let how = Fit { rate: 1e-3, ..how };
    let batch = Batch { input: data.features, target: data.poses };
    let stacked = run.stage("fine-tuning", batch, &how, &|_| stacked_raw.clone())?;
    Ok(Networks { autoencoder, features, stacked_raw, stacked })
}

/// The stages under way. A checkpoint holds the descents of all stages that have begun.
struct Run<'a> {
    progress: Progress<'a>,
    random: ChaCha8Rng,
    earlier: std::vec::IntoIter<Descent>,
    done: Vec<Descent>,
    keep: &'a mut dyn Keep,
}

impl<'a> Run<'a> {
    fn new(progress: Progress<'a>, random: ChaCha8Rng, keep: &'a mut dyn Keep) -> Result<Self, TrainError> {
        let earlier: Vec<Descent> = match keep.earlier() {
            Some(bytes) => postcard::from_bytes(&bytes).map_err(|_| TrainError::Checkpoint)?,
            None => Vec::new(),
        };
        Ok(Self { progress, random, earlier: earlier.into_iter(), done: Vec::new(), keep })
    }

    fn stage(
        &mut self,
        name: &'static str,
        data: Batch,
        how: &Fit,
        start: &dyn Fn(&mut ChaCha8Rng) -> Network,
    ) -> Result<Network, TrainError> {
        let network = start(&mut self.random);
        let new = Descent::new(network, data, twin(&self.random));
        let mut descent = match self.earlier.next() {
            Some(earlier) if earlier.goes_on_from(&new, how) => earlier,
            Some(_) => return Err(TrainError::Checkpoint),
            None => new,
        };
        // What was reached before a kill is told again: curves and reports are those of the whole training.
        for (epoch, error) in descent.errors.iter().enumerate() {
            (self.progress)(name, epoch + 1, how.epochs, *error);
        }
        let Self { progress, keep, done, .. } = self;
        descent.run(data, how, &mut |now| {
            progress(name, now.errors.len(), how.epochs, now.error());
            keep.offer(&|| {
                let begun: Vec<&Descent> = done.iter().chain([now]).collect();
                // Writing to a growing vector has no way to fail.
                postcard::to_allocvec(&begun).unwrap_or_default()
            });
        });
        let network = descent.network.clone();
        self.random = twin(&descent.random);
        self.done.push(descent);
        Ok(network)
    }
}
