//! The keys of an animation: which node, when, what.

use std::collections::BTreeMap;

use gltf::accessor::{DataType, Dimensions};
use gltf::animation::{Interpolation, Property};
use gltf::json::validation::Checked;

use super::numbers::rows;

/// Keys of one property of one node: times in s, values of 3 or 4 numbers.
pub(super) struct Track {
    times: Vec<f32>,
    values: Vec<[f32; 4]>,
    kind: Interpolation,
}

impl Track {
    /// Values before and after a time, and how far it is between them.
    pub(super) fn at(&self, time: f64) -> ([f32; 4], [f32; 4], f32) {
        let after = self.times.partition_point(|t| f64::from(*t) <= time).min(self.times.len() - 1);
        let before = after.saturating_sub(1);
        // A cubic key is tangent, value, tangent; between frames a straight line does.
        let value = |key: usize| match self.kind {
            Interpolation::CubicSpline => self.values.get(3 * key + 1),
            _ => self.values.get(key),
        };
        let (a, b) = (value(before).copied().unwrap_or_default(), value(after).copied().unwrap_or_default());
        let span = f64::from(self.times[after]) - f64::from(self.times[before]);
        let part = if span > 0.0 { ((time - f64::from(self.times[before])) / span).clamp(0.0, 1.0) } else { 1.0 };
        let part = if matches!(self.kind, Interpolation::Step) { part.floor() } else { part };
        (a, b, part as f32)
    }
}

/// The tracks by node. In order of nodes: which of two equally long tracks gives the rate must not change from run to run.
#[derive(Default)]
pub(super) struct Tracks {
    pub places: BTreeMap<usize, Track>,
    pub turns: BTreeMap<usize, Track>,
}

impl Tracks {
    /// All times of the longest track, and the last time of any.
    pub(super) fn times(&self) -> (Vec<f32>, f64) {
        let all = || self.places.values().chain(self.turns.values());
        let longest = all().max_by_key(|t| t.times.len()).map(|t| t.times.clone()).unwrap_or_default();
        let end = all().filter_map(|t| t.times.last()).fold(0.0, |a: f64, b| a.max(f64::from(*b)));
        (longest, end)
    }
}

/// Reads the keys of an animation; at most `room` of them: many channels may share the same bytes.
pub(super) fn tracks(
    file: &gltf::Gltf,
    animation: &gltf::Animation,
    buffers: &[Vec<u8>],
    room: usize,
) -> Result<Tracks, String> {
    let root = file.document.as_json();
    let targets = root.animations.get(animation.index()).into_iter().flat_map(|a| &a.channels).map(|c| &c.target);
    let nodes = root.nodes.len();
    let mut tracks = Tracks::default();
    let mut keys = 0usize;
    for (channel, target) in animation.channels().zip(targets) {
        // The crate does not check targets, and panics at what it does not know.
        let Checked::Valid(property) = &target.path else { continue };
        if target.node.value() >= nodes {
            return Err(format!("a channel moves node {}, and there are {nodes} nodes", target.node.value()));
        }
        let rotation = match property {
            Property::Translation => false,
            Property::Rotation => true,
            _ => continue,
        };
        let sampler = channel.sampler();
        let (input, output) = (sampler.input(), sampler.output());
        if input.data_type() != DataType::F32 || (!rotation && output.data_type() != DataType::F32) {
            return Err("times and places are no floating-point numbers. Export it again".into());
        }
        let shape = if rotation { Dimensions::Vec4 } else { Dimensions::Vec3 };
        if (input.dimensions(), output.dimensions()) != (Dimensions::Scalar, shape) {
            return Err("a channel's keys are no times, places or quaternions. Export it again".into());
        }
        keys = keys.saturating_add(input.count()).saturating_add(output.count());
        if keys > room {
            return Err(format!(
                "its channels have more than {room} keys together, more than a file of this size holds"
            ));
        }
        let times: Vec<f32> = rows(&input, buffers)?.into_iter().map(|row| row[0]).collect();
        let values = rows(&output, buffers)?;
        let kind = sampler.interpolation();
        let each = if matches!(kind, Interpolation::CubicSpline) { 3 } else { 1 };
        if times.is_empty()
            || values.len() != each * times.len()
            || times.windows(2).any(|w| w[0].partial_cmp(&w[1]) != Some(std::cmp::Ordering::Less))
        {
            return Err("the keys of a channel are not in order of time, or not one value each. Export it again".into());
        }
        let of = if rotation { &mut tracks.turns } else { &mut tracks.places };
        of.insert(target.node.value(), Track { times, values, kind });
    }
    Ok(tracks)
}

/// The rate of the keys where they are even, else 30.
pub(super) fn rate(times: &[f32], notes: &mut Vec<String>) -> f64 {
    let mut steps: Vec<f64> = times.windows(2).map(|w| f64::from(w[1]) - f64::from(w[0])).collect();
    steps.sort_by(f64::total_cmp);
    let step = steps.get(steps.len() / 2).copied().unwrap_or(1.0 / 30.0);
    let even = steps.iter().filter(|s| (*s / step - 1.0).abs() < 0.05).count() * 10 >= steps.len() * 9;
    let fps = 1.0 / step;
    let fps = if (fps - fps.round()).abs() < 2e-3 * fps { fps.round() } else { fps };
    if even && (1.0..=1000.0).contains(&fps) {
        return fps;
    }
    notes.push("The keys are not evenly spaced: sampled at 30 frames per second.".into());
    30.0
}
