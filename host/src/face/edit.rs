//! One face, changed through the device's code.

use kinesic::Pack;
use kinesic::face::{FaceState, Landmarks, POINTS, Reading};
use kinesic::model::LoadError;

use super::model::HostFace;

/// What is wanted of a face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Wish {
    /// So much more (or less, if negative).
    Change(f32),
    /// So strong.
    Strength(f32),
}

/// A changed face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Edit {
    /// What the device read and aimed at.
    pub reading: Reading,
    /// What it adds to the landmarks.
    pub offsets: Landmarks,
    /// The landmarks with the offsets.
    pub landmarks: Landmarks,
    /// What it reads from the changed landmarks.
    pub strength_after: f32,
}

/// One update of the device, and what it reads from the result. `None` if the landmarks are no face.
pub fn edit(pack: &Pack, landmarks: &Landmarks, wish: Wish) -> Result<Option<Edit>, LoadError> {
    let model = HostFace::load(pack)?;
    let Some(before) = model.read(landmarks) else { return Ok(None) };
    let mut state = FaceState::new();
    state.change = match wish {
        Wish::Change(change) => change,
        Wish::Strength(strength) => strength - before.strength,
    };
    let mut offsets = [[0.0; 2]; POINTS];
    model.step(&mut state, landmarks, &mut offsets);
    let mut changed = *landmarks;
    changed.as_flattened_mut().iter_mut().zip(offsets.as_flattened()).for_each(|(to, by)| *to += by);
    let after = model.read(&changed);
    Ok(state.reading().zip(after).map(|(reading, after)| Edit {
        reading,
        offsets,
        landmarks: changed,
        strength_after: after.strength,
    }))
}
