//! Strength of a facial expression, one picture at a time: what `kinesic_host::face::edit` does.

use kinesic::face::{FaceState, FaceSynth, Landmarks, POINTS, Reading};

/// The face model at the host's capacity.
pub type HostFace = FaceSynth<'static, 64>;

/// The landmarks with their offsets, and cluster, strength, target, strength after.
pub fn change(model: &HostFace, landmarks: &Landmarks, by: f32) -> (Landmarks, [f32; 4]) {
    let mut state = FaceState::new();
    state.change = by;
    let mut offsets = [[0.0; 2]; POINTS];
    model.step(&mut state, landmarks, &mut offsets);
    let mut changed = *landmarks;
    for (to, by) in changed.as_flattened_mut().iter_mut().zip(offsets.as_flattened()) {
        *to += by;
    }
    let Reading { cluster, strength, target } = state.reading().unwrap_or_default();
    let after = model.read(&changed).unwrap_or_default().strength;
    (changed, [cluster as f32, strength, target, after])
}
