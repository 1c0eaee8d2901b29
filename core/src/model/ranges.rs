//! Plausible ranges of the numbers that loading reads: one table for the device, C, WebAssembly and the host.
//!
//! The checks of a model's loader make its step infallible. These make what is built on a pack bounded: a clip at its frame rate, a
//! picture of its skeleton, a slider over its strengths. `docs/pack.md` has the same table.

use core::ops::RangeInclusive;

use super::{Field, LoadError, Metadata, ModelMeta, Pack};

/// Frames a second.
const FRAME_RATE: RangeInclusive<f32> = 1.0..=1000.0;
/// Joints, units, components, keyframes, frames, filter states of a model.
const COUNT: u32 = 1 << 20;
/// Strengths of a style, an emotion, an expression, either way.
const STRENGTH: f32 = 1000.0;
/// Gain of the activity index, either way.
const GAIN: f32 = 1000.0;
/// Sizes of a body, m.
const SIZE: RangeInclusive<f32> = 0.01..=1000.0;
/// Rest position of a joint relative to its parent, m, either way.
const OFFSET: f32 = 1000.0;
/// log2 of the duration of a frame, either way.
const TIMING: f32 = 4.0;

/// Refuses metadata with a number out of its range, by the number's name.
pub(super) fn check(metadata: &Metadata) -> Result<(), LoadError> {
    let refuse = |field| Err(LoadError::Range { field });
    if !FRAME_RATE.contains(&metadata.frame_rate) {
        return refuse("frame rate, expected 1 to 1000 a second");
    }
    // A joint's index is a u16, and 65535 stands for none.
    if metadata.joints.len() >= usize::from(u16::MAX) {
        return refuse("number of joints, expected less than 65535");
    }
    let misplaced = |(index, parent): (usize, Option<u16>)| match parent {
        None => index != 0,
        Some(parent) => usize::from(parent) >= index,
    };
    if metadata.joints.iter().map(|joint| joint.parent).enumerate().any(misplaced) {
        return refuse("parent of a joint, expected none for the first joint, an earlier joint for every other one");
    }
    match metadata.models.iter().find_map(|meta| model(&meta)) {
        Some(field) => refuse(field),
        None => Ok(()),
    }
}

/// Refuses skeletons that are not those of the metadata or larger than any body, and clocks that no training learns. Tensors that are
/// missing, or have another shape, are the models' to refuse.
pub(super) fn check_tensors(pack: &Pack) -> Result<(), LoadError> {
    let joints = pack.metadata().joints;
    let value = |tensor, index: Option<usize>| match index {
        Some(index) => Err(LoadError::Value { tensor, index }),
        None => Ok(()),
    };
    if let Ok(parents) = pack.slice::<u16>("skeleton/parents", joints.len()) {
        let other = |(joint, parent): (Option<u16>, &u16)| joint.unwrap_or(0) != *parent;
        let found = joints.iter().map(|joint| joint.parent).zip(parents).position(other);
        value("skeleton/parents", found)?;
    }
    if let Ok(offsets) = pack.slice::<[f32; 3]>("skeleton/offsets", joints.len()) {
        let far = |offset: &[f32; 3]| offset.iter().any(|x| x.abs() > OFFSET);
        value("skeleton/offsets", offsets.iter().position(far))?;
    }
    if let Ok([[bias, low, high]]) = pack.slice::<[f32; 3]>("translate/timing", 1) {
        let wild = [bias, low, high].iter().position(|x| x.abs() > TIMING);
        value("translate/timing", wild.or((low > high).then_some(1)))?;
    }
    Ok(())
}

/// The first number of a model that is out of its range.
fn model(meta: &ModelMeta) -> Option<&'static str> {
    let (mut meta, mut found) = (*meta, None);
    meta.fields(&mut |field| {
        let (sound, said) = match field {
            Field::Count(count) => (*count <= COUNT, "shape of a model, expected at most 1048576 of anything"),
            Field::Strength([low, high]) => (
                *low >= -STRENGTH && *low <= *high && *high <= STRENGTH,
                "range of strengths, expected low to high within -1000 to 1000",
            ),
            Field::Size(size) => (SIZE.contains(&*size), "size of the body, expected 0.01 to 1000 m"),
            Field::Gain(gain) => {
                ((-GAIN..=GAIN).contains(&*gain), "gain of the activity index, expected -1000 to 1000")
            }
            // Such as a limiter's rates, which it checks against the frame rate.
            Field::Own(_) => (true, ""),
        };
        if !sound && found.is_none() {
            found = Some(said);
        }
    });
    found
}
