//! One update of a face.

use super::{FaceFrame, FaceSynth, INNER, Landmarks, POINTS};

/// Another cluster must be nearer than the present one by this factor of squared distance before a running face changes to it.
const NEARER: f32 = 0.9;
/// Inner corners of the mouth, which no shape holds, and the outer ones that they go along with.
const CORNERS: [(usize, usize); 2] = [(60, 48), (64, 54)];

/// What an update found and aimed at.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reading {
    /// Cluster of head pose.
    pub cluster: usize,
    /// Strength of the face as it is, in units of the training labels: a face labelled 0 has 0 on average, one labelled 1 has 1.
    pub strength: f32,
    /// Strength that the offsets lead to.
    pub target: f32,
}

/// What a running face remembers: its cluster, so that a head between two poses does not change to and fro, and the last
/// reading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaceState {
    last: Option<Reading>,
    /// Wanted change of strength; the user may turn it while it runs. 0 moves nothing.
    pub change: f32,
}

impl FaceState {
    /// No face seen yet, no change wanted.
    pub fn new() -> Self {
        Self { last: None, change: 0.0 }
    }

    /// Forgets the face, keeps the wanted change.
    pub fn reset(&mut self) {
        self.last = None;
    }

    /// The last reading; `None` before the first face.
    pub fn reading(&self) -> Option<Reading> {
        self.last
    }
}

impl Default for FaceState {
    fn default() -> Self {
        Self::new()
    }
}

impl<const UNITS: usize> FaceSynth<'_, UNITS> {
    /// One update: `landmarks` in, `offsets` to add to them out, in the same unit and axes. Infallible; every loop has a length
    /// fixed at load time.
    ///
    /// The target is `strength + change`, held inside the plausible strengths of the pack (a face that is outside already stays
    /// where it is rather than move the other way). A change of 0 gives offsets of exactly 0; the contour never moves.
    /// Landmarks that are no face (not finite, in one place) leave `offsets` and the state as they are: the last ones hold.
    /// Cost: [`multiply_adds`](Self::multiply_adds), about 1,000 more for the frame, two tanh a hidden unit. Chan 2019, section 6.
    pub fn step(&self, state: &mut FaceState, landmarks: &Landmarks, offsets: &mut Landmarks) {
        let Some(frame) = FaceFrame::of(landmarks) else { return };
        let index = self.nearest(state, &frame, landmarks);
        let Some(cluster) = self.cluster(index) else { return };
        let strength = cluster.strength(&frame.shape(landmarks));
        if !strength.is_finite() {
            return;
        }
        let target = self.target(strength, state.change);
        let change = cluster.move_between::<UNITS>(strength, target);
        *offsets = [[0.0; 2]; POINTS];
        for (at, change) in INNER.iter().zip(change) {
            if let Some(offset) = offsets.get_mut(usize::from(*at)) {
                *offset = frame.outward(change);
            }
        }
        for (inner, outer) in CORNERS {
            let offset = offsets.get(outer).copied().unwrap_or_default();
            if let Some(inner) = offsets.get_mut(inner) {
                *inner = offset;
            }
        }
        state.last = Some(Reading { cluster: index, strength, target });
    }

    /// How strong a single face is: its nearest cluster and its strength, which is the target too. `None` for what is no face.
    pub fn read(&self, landmarks: &Landmarks) -> Option<Reading> {
        let frame = FaceFrame::of(landmarks)?;
        let cluster = self.nearest(&FaceState::new(), &frame, landmarks);
        let strength = self.cluster(cluster)?.strength(&frame.shape(landmarks));
        strength.is_finite().then_some(Reading { cluster, strength, target: strength })
    }

    /// The nearest cluster, or the present one where that is nearly as near.
    fn nearest(&self, state: &FaceState, frame: &FaceFrame, landmarks: &Landmarks) -> usize {
        let contour = frame.contour(landmarks);
        let (mut nearest, mut least, mut present) = (0, f32::INFINITY, f32::INFINITY);
        for (index, distance) in self.distances(&contour).enumerate() {
            if distance < least {
                (nearest, least) = (index, distance);
            }
            if state.last.is_some_and(|last| last.cluster == index) {
                present = distance;
            }
        }
        match state.last {
            Some(last) if least >= NEARER * present => last.cluster,
            _ => nearest,
        }
    }

    /// Where a change leads.
    fn target(&self, strength: f32, change: f32) -> f32 {
        let [low, high] = self.meta.strength;
        let wanted = strength + change;
        if wanted.is_finite() { wanted.max(low.min(strength)).min(high.max(strength)) } else { strength }
    }
}
