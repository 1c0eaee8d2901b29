//! What a pack says about itself: the postcard-encoded metadata.

use core::marker::PhantomData;

use serde::{Deserialize, Serialize};

/// What a pack holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[repr(u16)]
pub enum Kind {
    /// Several models for one skeleton.
    Style = 0,
    /// One style translator.
    Translator = 1,
    /// One body-mechanics model.
    Mechanics = 2,
    /// Style components.
    Components = 3,
    /// Strength of an emotion in a motion.
    Emotion = 4,
    /// Strength of a facial expression.
    Face = 5,
    /// Joint limits.
    Limits = 6,
}

impl Kind {
    /// Number in the header.
    pub fn code(self) -> u16 {
        self as u16
    }

    /// The kind with this number in the header.
    pub fn from_code(code: u16) -> Option<Self> {
        match code {
            0 => Some(Self::Style),
            1 => Some(Self::Translator),
            2 => Some(Self::Mechanics),
            3 => Some(Self::Components),
            4 => Some(Self::Emotion),
            5 => Some(Self::Face),
            6 => Some(Self::Limits),
            _ => None,
        }
    }
}

/// Everything in a pack but the tensors' numbers.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Metadata<'a> {
    /// Name of the pack.
    pub name: &'a str,
    /// Frames per second that the models were trained at and must be stepped at.
    pub frame_rate: f32,
    /// The skeleton's joints, parents first. Rest offsets are the tensor `skeleton/offsets`.
    #[serde(borrow)]
    pub joints: List<'a, JointMeta<'a>>,
    /// The models.
    #[serde(borrow)]
    pub models: List<'a, ModelMeta<'a>>,
    /// The tensors.
    #[serde(borrow)]
    pub tensors: List<'a, TensorMeta<'a>>,
    /// Where the pack comes from, for the host (postcard; the device never reads it).
    pub provenance: &'a [u8],
}

/// One joint of the skeleton.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct JointMeta<'a> {
    /// Name as in the training clips.
    pub name: &'a str,
    /// Index of the parent; `None` for the root, joint 0.
    pub parent: Option<u16>,
}

/// One model.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum ModelMeta<'a> {
    /// A style translator; its tensors are `translate/...`.
    Translator(#[serde(borrow)] TranslatorMeta<'a>),
    /// Body mechanics; its tensors are `mechanics/...`.
    Mechanics(MechanicsMeta),
    /// Style components; their tensors are `components/...`.
    Components(#[serde(borrow)] ComponentsMeta<'a>),
    /// Strength of a facial expression; its tensors are `face/...`.
    Face(#[serde(borrow)] FaceMeta<'a>),
    /// Joint limits; their tensors are `limit/...`.
    Limits(LimitsMeta),
    /// Strength of an emotion in a motion; its tensors are `emotion/...`.
    Emotion(#[serde(borrow)] EmotionMeta<'a>),
}

impl<'a> ModelMeta<'a> {
    /// The translator's shape, if it is one.
    pub fn translator(self) -> Option<TranslatorMeta<'a>> {
        if let Self::Translator(meta) = self { Some(meta) } else { None }
    }

    /// The body mechanics' shape, if it is one.
    pub fn mechanics(self) -> Option<MechanicsMeta> {
        if let Self::Mechanics(meta) = self { Some(meta) } else { None }
    }

    /// The components' shape, if it is such a model.
    pub fn components(self) -> Option<ComponentsMeta<'a>> {
        if let Self::Components(meta) = self { Some(meta) } else { None }
    }

    /// The face model's shape, if it is one.
    pub fn face(self) -> Option<FaceMeta<'a>> {
        if let Self::Face(meta) = self { Some(meta) } else { None }
    }

    /// The joint limits' rates and times, if it is such a table.
    pub fn limits(self) -> Option<LimitsMeta> {
        if let Self::Limits(meta) = self { Some(meta) } else { None }
    }

    /// The emotion model's shape, if it is one.
    pub fn emotion(self) -> Option<EmotionMeta<'a>> {
        if let Self::Emotion(meta) = self { Some(meta) } else { None }
    }
}

/// An f32 or u32 of a model's metadata, and what is plausible for it.
#[derive(Debug)]
pub enum Field<'m> {
    /// How many of something; [`Pack::load`](super::Pack::load) refuses more than 1,048,576.
    Count(&'m mut u32),
    /// Least and greatest strength, within -1000 to 1000.
    Strength(&'m mut [f32; 2]),
    /// A size of the body, 0.01 to 1000 m.
    Size(&'m mut f32),
    /// A gain, within -1000 to 1000.
    Gain(&'m mut f32),
    /// The engine's own loader says what it may be.
    Own(&'m mut f32),
}

impl ModelMeta<'_> {
    /// Every f32 and u32 in it, in order. Loading checks them by this list, and tests change them by it.
    pub fn fields(&mut self, visit: &mut dyn FnMut(Field)) {
        use Field::{Count, Gain, Own, Size, Strength};
        match self {
            Self::Translator(meta) => {
                [&mut meta.blocks, &mut meta.drives].into_iter().for_each(|count| visit(Count(count)));
                visit(Strength(&mut meta.strength));
            }
            Self::Mechanics(meta) => {
                [&mut meta.body_height, &mut meta.hip_height].into_iter().for_each(|size| visit(Size(size)));
                visit(Gain(&mut meta.gain));
                [&mut meta.hidden, &mut meta.code].into_iter().for_each(|count| visit(Count(count)));
            }
            Self::Components(meta) => {
                [&mut meta.count, &mut meta.frames].into_iter().for_each(|count| visit(Count(count)));
                visit(Strength(&mut meta.strength));
            }
            Self::Face(meta) => {
                [&mut meta.clusters, &mut meta.hidden].into_iter().for_each(|count| visit(Count(count)));
                visit(Strength(&mut meta.strength));
            }
            Self::Limits(meta) => {
                let rates = [&mut meta.root_velocity, &mut meta.root_acceleration];
                let turns = [&mut meta.heading_velocity, &mut meta.heading_acceleration];
                let times = [&mut meta.hold, &mut meta.decay];
                rates.into_iter().chain(turns).chain(times).for_each(|number| visit(Own(number)));
            }
            Self::Emotion(meta) => {
                let counts = [&mut meta.keyframes, &mut meta.components, &mut meta.hidden];
                counts.into_iter().for_each(|count| visit(Count(count)));
                meta.attributes.iter_mut().flatten().for_each(|attribute| visit(Strength(&mut attribute.strength)));
                meta.duration.iter_mut().for_each(|time| visit(Own(time)));
            }
        }
    }
}

/// How a translator's states are shared among the joints.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Form {
    /// A model of its own for every joint, 3 inputs and 3 outputs (Dong 2018).
    PerJoint,
    /// One model for all joints, driven by a few principal coordinates (Hsu 2005).
    WholeBody,
}

/// A translator's shape.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct TranslatorMeta<'a> {
    /// Name of the style.
    pub style: &'a str,
    /// Per joint or whole body.
    pub form: Form,
    /// 2 x 2 blocks of the transition matrix, all joints together.
    pub blocks: u32,
    /// Inputs of the shared model: principal coordinates of the pose (0 in the per-joint form).
    pub drives: u32,
    /// Range of strengths in which the poses of the training clips stayed plausible.
    pub strength: [f32; 2],
}

/// The shape of a body-mechanics model, and the sizes of the body that its features are measured by.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct MechanicsMeta {
    /// Units of the layer between the features and the code.
    pub hidden: u32,
    /// Units of the code, the autoencoder's hidden layer.
    pub code: u32,
    /// Height of the body standing straight, m.
    pub body_height: f32,
    /// Height of the hips standing straight, m.
    pub hip_height: f32,
    /// Gain `g` of the activity index.
    pub gain: f32,
    /// Exponent `b` of the activity index, 1..16.
    pub exponent: u8,
}

/// Shape of a model of style components.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ComponentsMeta<'a> {
    /// Name of the style.
    pub style: &'a str,
    /// Number of components, K.
    pub count: u32,
    /// Frames of the stored stream of weights; 0 if the pack holds none.
    pub frames: u32,
    /// Range of strengths in which the poses of the content clip stayed plausible.
    pub strength: [f32; 2],
}

/// Shape of a model of the strength of a facial expression.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FaceMeta<'a> {
    /// Name of the expression, as the training table called it.
    pub attribute: &'a str,
    /// Clusters of head pose, each with a model of its own.
    pub clusters: u32,
    /// Hidden units of a cluster's network.
    pub hidden: u32,
    /// Strengths that nearly all training faces lie between; targets are held inside.
    pub strength: [f32; 2],
}

/// Attributes that one emotion model mixes at most.
pub const ATTRIBUTES: usize = 4;

/// Shape of a model of the strength of emotions in a motion.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct EmotionMeta<'a> {
    /// Name of the motion: a walk, a wave.
    pub motion: &'a str,
    /// What may be asked for, first to last; the rest is `None`.
    #[serde(borrow)]
    pub attributes: [Option<AttributeMeta<'a>>; ATTRIBUTES],
    /// Keyframes of the motion, K.
    pub keyframes: u32,
    /// Principal components of a keyframe, D.
    pub components: u32,
    /// Hidden units of the network.
    pub hidden: u32,
    /// True for a cycle: the last keyframe is the first one of the next round, farther on.
    pub cycle: bool,
    /// Shortest and longest time between two keyframes, s.
    pub duration: [f32; 2],
}

/// One attribute of a motion, in units of its ranking function.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct AttributeMeta<'a> {
    /// Name, as the training table called it.
    pub name: &'a str,
    /// Strengths that nearly all training motions lie between; what is asked for is held inside.
    pub strength: [f32; 2],
}

/// Rates of the root, and what a limiter does when frames fail to come; the coordinates' limits are tensors.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LimitsMeta {
    /// Largest speed of the root over the ground, m/s.
    pub root_velocity: f32,
    /// Largest acceleration of the root over the ground, m/s^2.
    pub root_acceleration: f32,
    /// Largest speed at which a body turns its heading, rad/s.
    pub heading_velocity: f32,
    /// Largest acceleration at which a body turns its heading, rad/s^2.
    pub heading_acceleration: f32,
    /// Time for which the last sound frame is held when none comes, s.
    pub hold: f32,
    /// Time constant with which the joints then go to rest, s.
    pub decay: f32,
}

impl Default for LimitsMeta {
    /// 5 m/s, 50 m/s^2; 10 rad/s, 100 rad/s^2; half a second, one second.
    fn default() -> Self {
        Self {
            root_velocity: 5.0,
            root_acceleration: 50.0,
            heading_velocity: 10.0,
            heading_acceleration: 100.0,
            hold: 0.5,
            decay: 1.0,
        }
    }
}

/// Number type of a tensor.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum TensorType {
    /// IEEE 754 single precision.
    F32,
    /// Unsigned 16 bit.
    U16,
    /// Signed 8 bit.
    I8,
    /// Signed 16 bit.
    I16,
    /// Signed 32 bit.
    I32,
}

impl TensorType {
    /// Bytes of one element.
    pub fn size(self) -> usize {
        match self {
            Self::F32 | Self::I32 => 4,
            Self::U16 | Self::I16 => 2,
            Self::I8 => 1,
        }
    }
}

/// Where a tensor lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct TensorMeta<'a> {
    /// Name, `engine/tensor`.
    pub name: &'a str,
    /// Number type.
    pub kind: TensorType,
    /// Rows and columns; a vector has one column.
    pub shape: [u32; 2],
    /// First byte in the payload, a multiple of 16.
    pub offset: u32,
}

impl TensorMeta<'_> {
    /// Number of elements, if it fits.
    pub fn len(&self) -> Option<usize> {
        let [rows, columns] = self.shape;
        (rows as usize).checked_mul(columns as usize)
    }

    /// True if the tensor has no elements.
    pub fn is_empty(&self) -> bool {
        self.len() == Some(0)
    }
}

/// A list that is decoded while it is walked, so that it needs neither heap nor capacity.
#[derive(Debug, Serialize, Deserialize)]
pub struct List<'a, T> {
    len: u32,
    bytes: &'a [u8],
    #[serde(skip)]
    of: PhantomData<T>,
}

impl<T> Clone for List<'_, T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T> Copy for List<'_, T> {}

impl<'a, T: Deserialize<'a>> List<'a, T> {
    /// A list of `len` elements, encoded one after the other.
    pub fn new(len: u32, bytes: &'a [u8]) -> Self {
        Self { len, bytes, of: PhantomData }
    }

    /// Number of elements.
    pub fn len(&self) -> usize {
        self.len as usize
    }

    /// True if there are none.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// The elements in order.
    pub fn iter(&self) -> impl Iterator<Item = T> + use<'a, T> {
        let mut bytes = self.bytes;
        (0..self.len).map_while(move |_| {
            let (element, rest) = Self::take(bytes)?;
            bytes = rest;
            Some(element)
        })
    }

    /// Not inlined: the decoder of a model's metadata is large, and it is called from everywhere.
    #[inline(never)]
    fn take(bytes: &'a [u8]) -> Option<(T, &'a [u8])> {
        postcard::take_from_bytes(bytes).ok()
    }

    /// True if the bytes hold exactly the announced elements.
    pub(super) fn decodes(&self) -> bool {
        let mut bytes = self.bytes;
        for _ in 0..self.len {
            match Self::take(bytes) {
                Some((_, rest)) => bytes = rest,
                None => return false,
            }
        }
        bytes.is_empty()
    }
}
