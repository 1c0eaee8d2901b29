//! One update of a face: landmarks in, offsets out, through the very `FaceSynth` of the product.

use kinesic::Pack;
use kinesic::face::{FaceState, FaceSynth, Landmarks, POINTS};

use crate::{Digest, Refused, Workload};

/// Clusters of head pose, the paper's.
pub const CLUSTERS: usize = 12;
/// Hidden units of a cluster, the paper's.
pub const UNITS: usize = 10;

/// `FaceSynth::step` with room for `UNITS` hidden units.
#[derive(Clone, Copy, Debug)]
pub struct Face;

/// RAM of a face and its caller: the state, the landmarks that come in and the offsets that go out.
#[derive(Clone, Debug)]
pub struct Running {
    state: FaceState,
    landmarks: Landmarks,
    offsets: Landmarks,
}

/// An input frame is the wanted change, then `x y` of every landmark.
impl Workload for Face {
    type Model<'p> = FaceSynth<'p, UNITS>;
    type State = Running;

    fn open(pack: &[u8]) -> Result<Self::Model<'_>, Refused> {
        let pack = Pack::load(pack).map_err(|_| Refused)?;
        FaceSynth::load(&pack).map_err(|_| Refused)
    }

    fn power_on(_: &Self::Model<'_>) -> Self::State {
        Running { state: FaceState::new(), landmarks: [[0.0; 2]; POINTS], offsets: [[0.0; 2]; POINTS] }
    }

    fn load(_: &Self::Model<'_>, running: &mut Self::State, input: &[u8]) {
        let mut numbers = input.as_chunks::<4>().0.iter().map(|bytes| f32::from_le_bytes(*bytes));
        running.state.change = numbers.next().unwrap_or(0.0);
        for (to, from) in running.landmarks.as_flattened_mut().iter_mut().zip(numbers) {
            *to = from;
        }
    }

    #[inline(always)]
    fn step(model: &Self::Model<'_>, running: &mut Self::State) {
        model.step(&mut running.state, &running.landmarks, &mut running.offsets);
    }

    fn output(_: &Self::Model<'_>, running: &Self::State, digest: &mut Digest) {
        running.offsets.as_flattened().iter().for_each(|value| digest.float(*value));
        if let Some(reading) = running.state.reading() {
            digest.word(reading.cluster as u32);
            digest.float(reading.strength);
            digest.float(reading.target);
        }
    }
}
