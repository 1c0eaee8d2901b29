//! What the host knows of every engine: one registry, one arm per engine. `inspect`, `apply`, `view`, `export --rust` and the golden packs ask
//! it. A learned clock, what is familiar and a stored motion belong to one engine each, and `apply` asks for these by name.

use kinesic::Pack;
use kinesic::mechanics::Modulation;
use kinesic::model::{
    ComponentsMeta, EmotionMeta, FaceMeta, LimitsMeta, LoadError, MechanicsMeta, ModelMeta, TranslatorMeta,
};
use serde_json::{Value, json};

use crate::clip::Clip;
use crate::components::{self, HostComponents};
use crate::emotion::HostEmotion;
use crate::face::HostFace;
use crate::limit::{HostLimiter, LimitsModel};
use crate::mechanics::{HostMechanics, decouple, modulate};
use crate::rig::{Rig, RigError};
use crate::strength::Knobs;
use crate::translate::{self, HostTranslator};

/// Plays a clip on the pack's rig and at its frame rate, as on a live stream.
pub type Play = fn(&Pack, &Rig, &Clip, &Knobs) -> Result<Clip, LoadError>;

/// How an engine plays clips.
#[derive(Clone, Copy, Debug)]
pub struct Player {
    /// Of several engines the one with the least order plays; `kinesic::engine::live::keep_first` has the same order for the page.
    pub order: u8,
    /// Strengths at which it stays plausible.
    pub plausible: [f32; 2],
    /// Whether `kinesic apply` plays it; body mechanics have commands of their own.
    pub applies: bool,
    /// Plays.
    pub play: Play,
}

/// A constant of a pack as Rust source: what it is, its name, its value.
pub type Constant = (&'static str, &'static str, usize);

/// An engine as Rust source: its type with the constants as capacities, the type of its state, and the constants beside `JOINTS` and `ROWS`.
#[derive(Clone, Debug)]
pub struct Source {
    /// The type.
    pub model: &'static str,
    /// The state's type.
    pub state: &'static str,
    /// The capacities.
    pub constants: Vec<Constant>,
}

/// An engine's metadata, and what the host does with it. Those of a new engine may stand in its own folder.
pub trait Known {
    /// Name of the engine.
    fn name(&self) -> &'static str;
    /// Loads the model as the device would; its shape, capacity and cost: an object.
    fn figures(&self, pack: &Pack, rows: usize) -> Result<Value, RigError>;
    /// The engine as Rust source.
    fn source(&self, pack: &Pack) -> Result<Source, LoadError>;
    /// How it plays clips, if it does.
    fn player(&self) -> Option<Player> {
        None
    }
}

/// The registry.
pub fn known<'m>(meta: &'m ModelMeta) -> &'m dyn Known {
    match meta {
        ModelMeta::Translator(meta) => meta,
        ModelMeta::Mechanics(meta) => meta,
        ModelMeta::Components(meta) => meta,
        ModelMeta::Emotion(meta) => meta,
        ModelMeta::Face(meta) => meta,
        ModelMeta::Limits(meta) => meta,
    }
}

/// The engine that plays clips with a pack: its name, and how.
pub fn player(pack: &Pack, applies: bool) -> Option<(&'static str, Player)> {
    let all = pack.metadata().models.iter().filter_map(|meta| {
        let engine = known(&meta);
        engine.player().map(|player| (engine.name(), player))
    });
    all.filter(|(_, player)| player.applies || !applies).min_by_key(|(_, player)| player.order)
}

impl Known for TranslatorMeta<'_> {
    fn name(&self) -> &'static str {
        "translator"
    }

    fn figures(&self, pack: &Pack, rows: usize) -> Result<Value, RigError> {
        let translator = HostTranslator::load(pack)?;
        let states = translator.states();
        Ok(json!({
            "style": self.style,
            "form": format!("{:?}", self.form),
            "numbers": format!("{:?}", translator.number()).to_lowercase(),
            "filter_states": 2 * self.blocks,
            "drives": self.drives,
            "gated": translator.is_gated(),
            "experts": translator.experts(),
            "multiply_adds_per_frame": translator.multiply_adds(),
            "capacity": format!("Translator::<{rows}, {states}>"),
            "state_bytes": translator_state_bytes(rows, states),
            "plausible_strength": self.strength,
        }))
    }

    fn source(&self, pack: &Pack) -> Result<Source, LoadError> {
        let states = HostTranslator::load(pack)?.states();
        Ok(Source {
            model: "Translator::<ROWS, STATES>",
            state: "TranslatorState",
            constants: vec![("Filter states of the translator", "STATES", states)],
        })
    }

    fn player(&self) -> Option<Player> {
        let play: Play = |pack, rig, clip, knobs| {
            let Knobs { controls, curve } = knobs.clone();
            let settings = translate::Settings { controls, curve, live: true, ..translate::Settings::default() };
            translate::play(pack, rig, clip, &settings)
        };
        Some(Player { order: 0, plausible: self.strength, applies: true, play })
    }
}

impl Known for MechanicsMeta {
    fn name(&self) -> &'static str {
        "mechanics"
    }

    fn figures(&self, pack: &Pack, _: usize) -> Result<Value, RigError> {
        let mechanics = HostMechanics::load(pack)?;
        Ok(json!({
            "hidden": self.hidden,
            "code": self.code,
            "body_height_m": centimetres(self.body_height),
            "weights": format!("{:?}", mechanics.precision()).to_lowercase(),
            "hip_height_m": centimetres(self.hip_height),
            "multiply_adds_per_frame_before_kinematics": mechanics.multiply_adds(),
        }))
    }

    fn source(&self, pack: &Pack) -> Result<Source, LoadError> {
        let units = self.hidden.next_multiple_of(4) + self.code.next_multiple_of(4);
        let window = HostMechanics::load(pack)?.features().window();
        Ok(Source {
            model: "BodyMechanics::<JOINTS, UNITS, WINDOW>",
            state: "MechanicsState",
            constants: vec![
                ("Units of the hidden layer and the code of body mechanics", "UNITS", units as usize),
                ("Frames of memory of body mechanics", "WINDOW", window),
            ],
        })
    }

    fn player(&self) -> Option<Player> {
        // `kinesic modulate` has one amount for a clip, and so has the page.
        let play: Play = |pack, rig, clip, knobs| {
            let amount = knobs.controls.strength;
            let (modulation, poses) = (Modulation { amount, ..Modulation::default() }, rig.poses(clip));
            Ok(rig.clip(&modulate(&poses, &decouple(pack, &poses)?, &modulation), clip.frame_time))
        };
        Some(Player { order: u8::MAX, plausible: [0.0, 2.0], applies: false, play })
    }
}

impl Known for ComponentsMeta<'_> {
    fn name(&self) -> &'static str {
        "components"
    }

    fn figures(&self, pack: &Pack, rows: usize) -> Result<Value, RigError> {
        let components = HostComponents::load(pack)?;
        Ok(json!({
            "style": self.style,
            "components": self.count,
            "stored_frames": self.frames,
            "multiply_adds_per_frame": components.multiply_adds(),
            "capacity": format!("Components::<{rows}, {}>", self.count),
            "plausible_strength": self.strength,
        }))
    }

    fn source(&self, _: &Pack) -> Result<Source, LoadError> {
        Ok(Source {
            model: "Components::<ROWS, COMPONENTS>",
            state: "ComponentsState",
            constants: vec![("Style components", "COMPONENTS", self.count as usize)],
        })
    }

    fn player(&self) -> Option<Player> {
        let play: Play = |pack, rig, clip, knobs| {
            let Knobs { controls, curve } = knobs.clone();
            components::play(pack, rig, clip, &components::Settings { controls, curve })
        };
        Some(Player { order: 1, plausible: self.strength, applies: true, play })
    }
}

impl Known for EmotionMeta<'_> {
    fn name(&self) -> &'static str {
        "emotion"
    }

    fn figures(&self, pack: &Pack, rows: usize) -> Result<Value, RigError> {
        let emotion = HostEmotion::load(pack)?;
        let width = self.components.max(self.hidden + emotion.attributes() as u32);
        let strengths: serde_json::Map<String, Value> =
            self.attributes.iter().flatten().map(|a| (a.name.to_owned(), json!(a.strength))).collect();
        Ok(json!({
            "motion": self.motion,
            "cycle": self.cycle,
            "keyframes": self.keyframes,
            "components": self.components,
            "hidden": self.hidden,
            "multiply_adds_per_change_of_strength": emotion.multiply_adds(),
            "capacity": format!("Emotion::<{rows}, {}, {width}>", self.keyframes),
            "plausible_strengths": strengths,
        }))
    }

    fn source(&self, _: &Pack) -> Result<Source, LoadError> {
        let inputs = self.hidden + self.attributes.iter().flatten().count() as u32;
        let width = self.components.max(inputs) as usize;
        Ok(Source {
            model: "Emotion::<ROWS, KEYS, WIDTH>",
            state: "EmotionState",
            constants: vec![
                ("Keyframes of the motion", "KEYS", self.keyframes as usize),
                ("Components of a keyframe, or inputs of the output layer", "WIDTH", width),
            ],
        })
    }
}

impl Known for FaceMeta<'_> {
    fn name(&self) -> &'static str {
        "face"
    }

    fn figures(&self, pack: &Pack, _: usize) -> Result<Value, RigError> {
        let face = HostFace::load(pack)?;
        Ok(json!({
            "attribute": self.attribute,
            "clusters": self.clusters,
            "hidden": self.hidden,
            "multiply_adds_per_update_before_the_frame": face.multiply_adds(),
            "capacity": format!("FaceSynth::<{}>", self.hidden),
            "state_bytes": size_of::<kinesic::FaceState>(),
            "plausible_strength": self.strength,
        }))
    }

    fn source(&self, pack: &Pack) -> Result<Source, LoadError> {
        // Beside body mechanics, whose constant has the name.
        let shared = pack.metadata().models.iter().any(|meta| meta.mechanics().is_some());
        let (model, name) =
            if shared { ("FaceSynth::<FACE_UNITS>", "FACE_UNITS") } else { ("FaceSynth::<UNITS>", "UNITS") };
        let constants = vec![("Hidden units of a cluster of head pose", name, self.hidden as usize)];
        Ok(Source { model, state: "FaceState", constants })
    }
}

impl Known for LimitsMeta {
    fn name(&self) -> &'static str {
        "limits"
    }

    fn figures(&self, pack: &Pack, rows: usize) -> Result<Value, RigError> {
        let limiter = HostLimiter::load(pack)?;
        let joints = LimitsModel::from_pack(pack)?.joints;
        Ok(json!({
            "limited_joints": joints.iter().filter(|joint| joint.count() > 0 && !joint.is_free()).count(),
            "root_velocity_m_s": f64::from(self.root_velocity),
            "root_acceleration_m_s2": f64::from(self.root_acceleration),
            "heading_velocity_rad_s": f64::from(self.heading_velocity),
            "heading_acceleration_rad_s2": f64::from(self.heading_acceleration),
            "hold_s": f64::from(self.hold),
            "decay_s": f64::from(self.decay),
            "recovery_frames": limiter.recovery_frames(),
            "capacity": format!("{}::<{rows}>", if limits_jerk(pack) { "SmoothLimiter" } else { "Limiter" }),
        }))
    }

    fn source(&self, pack: &Pack) -> Result<Source, LoadError> {
        // As many rows as a frame.
        let (model, state) = match limits_jerk(pack) {
            true => ("SmoothLimiter::<ROWS>", "SmoothLimitState"),
            false => ("Limiter::<ROWS>", "LimitState"),
        };
        Ok(Source { model, state, constants: Vec::new() })
    }
}

fn limits_jerk(pack: &Pack) -> bool {
    pack.rows("limit/jerk").is_ok()
}

/// A length in m to the centimetre, as a double that prints so.
fn centimetres(length: f32) -> f64 {
    (100.0 * f64::from(length)).round() / 100.0
}

/// `size_of::<TranslatorState<JOINTS, STATES>>()`, whose parameters are known only now.
fn translator_state_bytes(rows: usize, states: usize) -> usize {
    // Filters and gate, mask, strength, and whether and how much the style fades.
    4 * (states + 3 * rows + 3)
}

#[cfg(test)]
mod tests {
    use kinesic::TranslatorState;

    #[test]
    fn state_bytes_are_the_type_s() {
        assert_eq!(super::translator_state_bytes(31, 48), size_of::<TranslatorState<31, 48>>());
        assert_eq!(super::translator_state_bytes(25, 1000), size_of::<TranslatorState<25, 1000>>());
    }
}
