//! Expression of a whole clip as a smooth motion: what the network's jitter and single lost frames leave alone.
//!
//! The device splits every frame by itself. On foreign bodies its network jumps where a contact begins or a posture is unlike its training, and
//! the activity index, steep at 20 to 30 degrees, makes these jumps three times as large. A clip is known before and after a frame, so here the
//! difference `E = O B^-1` and its activity are smoothed without delay, and `E*` is the one times the other. What is fast in the clip stays
//! its own: `B' = E*^-1 O` holds it, and it is never scaled.

use kinesic::mechanics::{FEATURES, MechanicsState};
use kinesic::{LoadError, Pack, Pose};
use nalgebra::{UnitQuaternion, Vector3};

use super::dataset::MAX_WINDOW;
use super::play::HostMechanics;
use crate::rig::MAX_JOINTS;
use crate::steady::{medians, under_bell, vectors};

/// Standard deviation of the bell over the difference, s: a movement of 3 a second keeps half its size.
const WIDTH: f64 = 0.062;
/// Standard deviation of the bell over the activity, s: slow, so that a swing through the threshold does not switch it.
const ACTIVITY: f64 = 0.3;
/// Frames to either side of the median, at least; and how many frames of a slower clip it spans.
const NEIGHBOURS: f64 = 3.0;
/// Deviations from the training's mean beyond which a feature is new to the network.
pub const NEW: f32 = 3.0;

/// What expression adds to each joint of a clip on the pack's rig, at any time.
#[derive(Clone, Debug)]
pub struct Expressive {
    fps: f64,
    joints: usize,
    /// Rotation vectors of `E`, `[frames x joints]`.
    differences: Vec<Vector3<f64>>,
    /// Activity of each, 0..1.
    activity: Vec<f64>,
    new_percent: f64,
    /// Standard deviation of the bell over the difference, s.
    width: f64,
}

impl Expressive {
    /// What a clip expresses. `poses` are at the pack's rate and on its rig; `source_fps` is the rate at which they were recorded.
    pub fn of(pack: &Pack, poses: &[Pose<MAX_JOINTS>], joints: usize, source_fps: f64) -> Result<Self, LoadError> {
        let model = HostMechanics::load(pack)?;
        let mean = pack.slice::<f32>("mechanics/feature_mean", FEATURES)?;
        let scale = pack.slice::<f32>("mechanics/feature_inverse_deviation", FEATURES)?;
        let fps = f64::from(pack.metadata().frame_rate);
        let mut state = Box::new(MechanicsState::<MAX_JOINTS, MAX_WINDOW>::new());
        let mut asked = Pose::identity();
        let (mut differences, mut activity) = (Vec::<UnitQuaternion<f64>>::new(), Vec::new());
        let mut new = 0;
        for pose in poses {
            model.features().step(&mut state, pose);
            let features = state.features();
            let far = features.iter().zip(mean).zip(scale).map(|((x, mean), scale)| ((x - mean) * scale).abs());
            new += far.filter(|far| *far > NEW).count();
            model.predict(features, pose, &mut asked);
            for (observed, asked) in pose.rotations.iter().zip(&asked.rotations).take(joints) {
                let whole = observed.cast::<f64>() * asked.cast::<f64>().inverse();
                differences.push(whole);
                activity.push(f64::from(model.decoupler.activity(whole.angle() as f32)));
            }
        }
        let reach = NEIGHBOURS.max((1.5 * fps / source_fps).ceil() + 1.0) as usize;
        let new_percent = 100.0 * new as f64 / (poses.len() * FEATURES).max(1) as f64;
        let column = |joint: usize| medians(&vectors(differences.iter().skip(joint).step_by(joints).copied()), reach);
        let columns: Vec<_> = (0..joints).map(column).collect();
        let differences = (0..poses.len()).flat_map(|frame| columns.iter().map(move |column| column[frame])).collect();
        Ok(Self { fps, joints, differences, activity, new_percent, width: WIDTH })
    }

    /// Standard deviation of its bell, s.
    pub fn width(&self) -> f64 {
        self.width
    }

    /// The same under a bell that is so many times as wide.
    pub fn slower(&self, times: f64) -> Self {
        Self { width: times * self.width, ..self.clone() }
    }

    /// Movements a second that keep half their size.
    pub fn cut_off(&self) -> f64 {
        0.5 * (2.0 * std::f64::consts::LN_2).sqrt() / (std::f64::consts::PI * self.width)
    }

    /// Part of the numbers that the network saw which are further from its training than [`NEW`] deviations, percent. Past
    /// [`FARTHEST`](kinesic::mechanics::FARTHEST) deviations they are cut.
    pub fn new_percent(&self) -> f64 {
        self.new_percent
    }

    /// `E*` of every joint at a time, s, as rotation vectors in the parent's frame. The root has none.
    pub fn at(&self, time: f64) -> Vec<Vector3<f64>> {
        let mut turns = vec![Vector3::zeros(); self.joints];
        self.near(time, self.width, |weight, frame| {
            let row = self.differences.iter().skip(frame * self.joints);
            turns.iter_mut().zip(row).for_each(|(turn, of)| *turn += weight * of);
        });
        let mut active = vec![0.0; self.joints];
        self.near(time, ACTIVITY.max(self.width), |weight, frame| {
            let row = self.activity.iter().skip(frame * self.joints);
            active.iter_mut().zip(row).for_each(|(active, of)| *active += weight * of);
        });
        turns.iter_mut().zip(&active).for_each(|(turn, active)| *turn *= *active);
        turns.first_mut().into_iter().for_each(|root| *root = Vector3::zeros());
        turns
    }

    /// Frames near a time under a bell, with their weights.
    fn near(&self, time: f64, width: f64, each: impl FnMut(f64, usize)) {
        let frames = self.differences.len() / self.joints.max(1);
        under_bell(time * self.fps, width * self.fps, frames, each);
    }
}
