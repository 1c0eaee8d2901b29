//! An emotion pack: its strengths, and digests of what the host plays.

use kinesic::LoadError;
use kinesic::model::{ATTRIBUTES, EmotionMeta};
use serde::Serialize;

use super::scene::{BodyData, CHECKED, coordinates, hash, words};
use super::{ViewError, ViewPack};
use crate::emotion::HostEmotion;
use crate::emotion::play::{HostState, Strengths, pose, seconds};
use crate::rig::{HostFrame, Rig};

/// How long the last pose of a motion that ends is shown, s.
const STANDS: f32 = 1.0;

/// Frames that a page holds at most: half an hour at 60 per second.
const MOST_FRAMES: f64 = 108_000.0;

/// An emotion pack as the scripts read it.
#[derive(Serialize)]
pub(super) struct EmotionData {
    #[serde(flatten)]
    pub body: BodyData,
    motion: String,
    attributes: Vec<AttributeData>,
    /// How long to show a motion that ends, s; `None` for a cycle.
    seconds: Option<f32>,
    /// The change of strength in the comparison.
    change: ChangeData,
    /// Of what the host plays at the strengths of the start, and with the change.
    digests: [String; 2],
}

#[derive(Serialize)]
struct AttributeData {
    name: String,
    range: [f32; 2],
    /// The middle of the range: where the slider is at first.
    start: f32,
}

#[derive(Serialize)]
struct ChangeData {
    /// The first frame with the strengths below.
    frame: usize,
    strength: Vec<f32>,
}

/// The pack as the scripts read it.
pub(super) fn data(of: &ViewPack) -> Result<EmotionData, ViewError> {
    let refuse = |error: LoadError| ViewError::Pack { name: of.name.clone(), error };
    let pack = of.file.pack().map_err(refuse)?;
    let model = HostEmotion::load(&pack).map_err(refuse)?;
    let rig = Rig::from_pack(&pack).map_err(|error| ViewError::Rig { name: of.name.clone(), error })?;
    let (meta, rate) = (model.meta(), pack.metadata().frame_rate);
    let start = strengths(meta, |[low, high]| low.midpoint(high));
    let strong = strengths(meta, |[_, high]| high);
    // While it moves, however short it is.
    let frame = match meta.cycle {
        true => CHECKED / 2,
        false => CHECKED.min((seconds(&model, &start) * rate) as usize) / 2,
    };
    let seconds = (!meta.cycle).then(|| longest(&model) + STANDS);
    if let Some(frames) = seconds.map(|seconds| f64::from(seconds * rate)).filter(|frames| *frames > MOST_FRAMES) {
        return Err(ViewError::Long { name: of.name.clone(), frames, most: MOST_FRAMES });
    }
    let played = |to: &Strengths| hash(play(&model, &rig, &start, frame, to).into_iter());
    let attributes = meta.attributes.iter().flatten().zip(start);
    let attributes = attributes.map(|(attribute, start)| AttributeData {
        name: attribute.name.to_owned(),
        range: attribute.strength,
        start,
    });
    Ok(EmotionData {
        body: BodyData::new(of, &pack, &rig)?,
        motion: meta.motion.to_owned(),
        attributes: attributes.collect(),
        seconds,
        change: ChangeData { frame, strength: strong[..model.attributes()].to_vec() },
        digests: [&start, &strong].map(played),
    })
}

/// A strength of every attribute by its range; 0 past the last one.
fn strengths(meta: &EmotionMeta, choose: impl Fn([f32; 2]) -> f32) -> Strengths {
    let mut strengths = [0.0; ATTRIBUTES];
    for (to, attribute) in strengths.iter_mut().zip(meta.attributes.iter().flatten()) {
        *to = choose(attribute.strength);
    }
    strengths
}

/// Bits of the first [`CHECKED`] frames at the pack's rate, with other strengths from one on.
fn play(model: &HostEmotion, rig: &Rig, start: &Strengths, change: usize, to: &Strengths) -> Vec<u32> {
    let mut state = Box::new(HostState::new());
    let mut step = |at| -> Vec<u32> {
        state.strength = if at < change { *start } else { *to };
        if rig.frames().travels() {
            return words(&pose(model, &rig.frames(), &mut state, model.frame_time()), rig.joints()).collect();
        }
        let mut frame = HostFrame::new();
        model.step(&mut state, model.frame_time(), &mut frame);
        coordinates(rig, &frame).collect()
    };
    (0..CHECKED).flat_map(&mut step).collect()
}

/// The longest that the motion takes where every attribute is at an end or in the middle of its range, s.
fn longest(model: &HostEmotion) -> f32 {
    let count = 3_usize.pow(model.attributes() as u32);
    let corner = |corner: usize| {
        let mut strength = [0.0; ATTRIBUTES];
        for (k, (to, attribute)) in strength.iter_mut().zip(model.meta().attributes.iter().flatten()).enumerate() {
            let [low, high] = attribute.strength;
            *to = [low, low.midpoint(high), high][corner / 3_usize.pow(k as u32) % 3];
        }
        strength
    };
    (0..count).map(|at| seconds(model, &corner(at))).fold(0.0, f32::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::emotion::{EmotionModel, synthetic};
    use crate::models;
    use crate::pack::{PackFile, Provenance};
    use crate::view::{View, WASM, page};

    fn of(model: &EmotionModel, rig: &Rig) -> ViewPack {
        let file = PackFile::from_bytes(&model.pack(rig, &Provenance::default()));
        ViewPack { name: "made".to_owned(), file, look: None }
    }

    #[test]
    fn sliders_start_in_the_middle_and_a_change_is_seen_in_the_digest() {
        let (model, rig) = synthetic::model(2);
        let data = data(&of(&model, &rig)).unwrap();
        let sliders: Vec<_> = data.attributes.iter().map(|a| (a.name.as_str(), a.range, a.start)).collect();
        assert_eq!(sliders, [("weary", [0.0, 1.0], 0.5), ("swaying", [-1.0, 1.0], 0.0)]);
        assert_eq!((data.seconds, data.change.frame), (None, CHECKED / 2));
        assert_eq!(data.change.strength, [1.0, 1.0]);
        assert_ne!(data.digests[0], data.digests[1]);
    }

    #[test]
    fn a_motion_that_ends_is_shown_at_its_longest_and_changed_while_it_moves() {
        let (mut model, rig) = synthetic::model(1);
        model.cycle = false;
        let view = of(&model, &rig);
        let data = data(&view).unwrap();
        let pack = view.file.pack().unwrap();
        let device = HostEmotion::load(&pack).unwrap();
        let [brisk, middle, weary] = [0.0, 0.5, 1.0].map(|weary| seconds(&device, &[weary, 0.0, 0.0, 0.0]));
        assert!(brisk < weary, "{brisk} {weary}");
        assert_eq!(data.seconds, Some(brisk.max(middle).max(weary) + STANDS));
        assert_eq!(data.change.frame, (middle * 60.0) as usize / 2);
        assert_ne!(data.digests[0], data.digests[1]);
    }

    #[test]
    fn an_emotion_pack_is_a_page_without_a_clip() {
        let (model, rig) = synthetic::model(1);
        let shown = View { emotions: vec![of(&model, &rig)], ..View::default() };
        let html = page("title", "made", &shown, WASM).unwrap();
        assert!(html.contains("\"emotions\":[{\"machine\":null,\"name\":\"made\"") && html.contains(r#""clips":[]"#));
        assert!(matches!(page("title", "made", &View::default(), WASM), Err(ViewError::Empty)));
    }

    #[test]
    fn a_pack_without_emotions_is_named() {
        let weary = ViewPack { name: "weary".to_owned(), file: models::weary(), look: None };
        let error = data(&weary).err().unwrap().to_string();
        assert!(error.starts_with("weary: ") && error.contains("emotion model"), "{error}");
    }
}
