//! The emotion model: a checked, immutable view of a pack.

use crate::kernel::{ROWS as TILE, Tiled, dot, tanh};
use crate::model::{ATTRIBUTES, EmotionMeta, LoadError, ModelMeta, Pack};
use crate::rig::Rig;

/// Times between keyframes that a pack may ask for, s.
const DURATIONS: [f32; 2] = [1e-3, 60.0];

/// Strength of emotions in a motion of up to `ROWS` rows of coordinates and `KEYS` keyframes, borrowed from a pack. `WIDTH` holds
/// the components of a keyframe, and the network's hidden units and attributes together.
#[derive(Clone, Copy, Debug)]
pub struct Emotion<'a, const ROWS: usize, const KEYS: usize, const WIDTH: usize> {
    pub(super) meta: EmotionMeta<'a>,
    pub(super) rows: usize,
    /// True for a body: row 0 of a keyframe is the root's place, and there is a heading.
    pub(super) travels: bool,
    /// Time between two frames of the training, s.
    pub(super) dt: f32,
    attributes: usize,
    /// Units x (attributes + 1), the constant last.
    hidden: &'a [f32],
    /// `[D x (units + attributes)]` of each keyframe: of the hidden units, then of the strengths themselves.
    output: &'a [[f32; TILE]],
    output_bias: &'a [f32],
    /// Back-projection `[channels x D]`: the coordinates in order, rad or m, then the heading, rad.
    pub(super) coordinates: Tiled<'a>,
    pub(super) mean: &'a [f32],
    /// Back-projection to velocities since the keyframe before, times levers, m/s.
    pub(super) velocity: Tiled<'a>,
    pub(super) velocity_mean: &'a [f32],
    /// How far a unit of each channel moves the body, m per rad or m.
    pub(super) lever: &'a [f32],
}

impl<'a, const ROWS: usize, const KEYS: usize, const WIDTH: usize> Emotion<'a, ROWS, KEYS, WIDTH> {
    /// The emotion model of a pack, after every check that makes [`step`](Self::step) infallible.
    pub fn load(pack: &Pack<'a>) -> Result<Self, LoadError> {
        let meta = pack.metadata().models.iter().find_map(ModelMeta::emotion);
        let meta = meta.ok_or(LoadError::NoModel { expected: "emotion model" })?;
        let rig = Rig::load(pack)?;
        let (rows, travels) = (rig.rows(), rig.travels());
        let attributes = meta.attributes.iter().take_while(|attribute| attribute.is_some()).count();
        let (keys, components, units) = (meta.keyframes as usize, meta.components as usize, meta.hidden as usize);
        let inputs = units.saturating_add(attributes);
        fits("ROWS", rows, ROWS)?;
        fits("KEYS", keys, KEYS)?;
        fits("WIDTH", components.max(inputs), WIDTH)?;
        let rate = pack.metadata().frame_rate;
        if attributes == 0
            || units == 0
            || components == 0
            || !plausible(&meta, attributes)
            || rate.is_nan()
            || rate <= 0.0
        {
            return Err(LoadError::Metadata);
        }
        let tiles = components.div_ceil(TILE).saturating_mul(inputs);
        let channels = 3 * rows + usize::from(travels);
        Ok(Self {
            meta,
            rows,
            travels,
            dt: 1.0 / rate,
            attributes,
            hidden: pack.slice("emotion/hidden", units.saturating_mul(attributes + 1))?,
            output: pack.slice("emotion/output", tiles.saturating_mul(keys))?,
            output_bias: pack.slice("emotion/output_bias", keys.saturating_mul(components))?,
            coordinates: Tiled::load(pack, "emotion/coordinates", channels, components)?,
            mean: pack.slice("emotion/mean", channels)?,
            velocity: Tiled::load(pack, "emotion/velocity", channels, components)?,
            velocity_mean: pack.slice("emotion/velocity_mean", channels)?,
            lever: pack.slice("emotion/lever", channels)?,
        })
    }

    /// Names of motion and attributes, shape, plausible strengths.
    pub fn meta(&self) -> &EmotionMeta<'a> {
        &self.meta
    }

    /// Rows of the frames that come out.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Time between two frames of the training, s.
    pub fn frame_time(&self) -> f32 {
        self.dt
    }

    /// Number of attributes, 1 to [`ATTRIBUTES`].
    pub fn attributes(&self) -> usize {
        self.attributes
    }

    /// Keyframes of the motion.
    pub(super) fn keys(&self) -> usize {
        self.meta.keyframes as usize
    }

    /// Multiply-adds of a change of strength: network and back-projection.
    pub fn multiply_adds(&self) -> usize {
        let components = self.coordinates.columns();
        let network = components.next_multiple_of(TILE) * (self.meta.hidden as usize + self.attributes);
        let projection = 2 * self.mean.len().next_multiple_of(TILE) * components;
        self.keys() * (network + projection)
    }

    /// Strengths that can be played: each inside its range; where one is not finite, `last`.
    pub(super) fn held(&self, wanted: &[f32; ATTRIBUTES], last: &[f32; ATTRIBUTES]) -> [f32; ATTRIBUTES] {
        let mut held = [0.0; ATTRIBUTES];
        let asked = wanted.iter().zip(last).map(|(wanted, last)| if wanted.is_finite() { *wanted } else { *last });
        for ((held, asked), attribute) in held.iter_mut().zip(asked).zip(self.meta.attributes.iter().flatten()) {
            let [low, high] = attribute.strength;
            *held = asked.max(low).min(high);
        }
        held
    }

    /// What the output layers see: hidden units, then the strengths. Cost: a tanh per hidden unit.
    pub(super) fn inputs(&self, strength: &[f32; ATTRIBUTES]) -> [f32; WIDTH] {
        let mut inputs = [0.0; WIDTH];
        let rows = self.hidden.chunks_exact(self.attributes.saturating_add(1));
        let units = rows.map(|row| {
            let bias = row.last().copied().unwrap_or(0.0);
            tanh(bias + dot(row.get(..self.attributes).unwrap_or(&[]), strength))
        });
        let values = units.chain(strength.iter().copied().take(self.attributes));
        inputs.iter_mut().zip(values).for_each(|(input, value)| *input = value);
        inputs
    }

    /// Components of keyframe `key` for these inputs; zeros past the last one.
    pub(super) fn components(&self, key: usize, inputs: &[f32; WIDTH]) -> [f32; WIDTH] {
        let count = self.coordinates.columns();
        let columns = self.meta.hidden as usize + self.attributes;
        let tiles = count.div_ceil(TILE) * columns;
        let mut components = [0.0; WIDTH];
        let layer = self.output.get(key * tiles..).and_then(|rest| Tiled::new(count, columns, rest.get(..tiles)?));
        let bias = self.output_bias.get(key * count..).unwrap_or(&[]);
        components.iter_mut().zip(bias).take(count).for_each(|(component, bias)| *component = *bias);
        if let (Some(layer), Some(components)) = (layer, components.get_mut(..count)) {
            layer.multiply_add(inputs, components);
        }
        components
    }

    /// The motion at a strength: its components `[K x D]` to the front of `motion`, held inside the plausible strengths.
    pub fn motion(&self, strength: &[f32; ATTRIBUTES], motion: &mut [f32]) {
        let inputs = self.inputs(&self.held(strength, &[0.0; ATTRIBUTES]));
        let count = self.coordinates.columns();
        for (key, to) in motion.chunks_mut(count).enumerate().take(self.keys()) {
            to.iter_mut().zip(self.components(key, &inputs)).for_each(|(to, from)| *to = from);
        }
    }
}

fn fits(parameter: &'static str, found: usize, capacity: usize) -> Result<(), LoadError> {
    if found > capacity { Err(LoadError::Capacity { parameter, found, capacity }) } else { Ok(()) }
}

/// Ranges that are ranges, and enough keyframes for a piece, or for a cycle.
fn plausible(meta: &EmotionMeta, attributes: usize) -> bool {
    let range = |[low, high]: [f32; 2]| low.is_finite() && high.is_finite() && low < high;
    let [shortest, longest] = meta.duration;
    let [least, most] = DURATIONS;
    meta.attributes.iter().skip(attributes).all(Option::is_none)
        && meta.attributes.iter().flatten().all(|attribute| range(attribute.strength))
        && shortest >= least
        && longest <= most
        && shortest < longest
        && meta.keyframes >= if meta.cycle { 3 } else { 2 }
}
