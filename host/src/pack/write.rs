//! From models to bytes.

use kinesic::Pack;
use kinesic::kernel::{ROWS, TILE};
use kinesic::model::{
    ALIGNMENT, HEADER_LEN, JointMeta, Kind, List, LoadError, MAGIC, Metadata, ModelMeta, TensorMeta, TensorType,
    VERSION, checksum,
};
use serde::Serialize;

use super::Provenance;
use super::layout::{IntegerLayer, tile};

/// Collects joints, models and tensors, and lays them out as a pack.
#[derive(Debug)]
pub struct PackWriter {
    kind: Kind,
    name: String,
    frame_rate: f32,
    joints: Encoded,
    models: Encoded,
    tensors: Encoded,
    payload: Vec<u8>,
}

#[derive(Debug, Default)]
struct Encoded {
    len: u32,
    bytes: Vec<u8>,
}

impl Encoded {
    fn push(&mut self, value: &impl Serialize) {
        self.bytes.extend(encode(value));
        self.len += 1;
    }
}

fn encode(value: &impl Serialize) -> Vec<u8> {
    // Writing to a growing vector has no way to fail, and the metadata holds no type that postcard refuses.
    postcard::to_allocvec(value).unwrap_or_default()
}

impl PackWriter {
    /// An empty pack for models that run at `frame_rate` frames per second.
    pub fn new(kind: Kind, name: &str, frame_rate: f32) -> Self {
        Self {
            kind,
            name: name.to_owned(),
            frame_rate,
            joints: Encoded::default(),
            models: Encoded::default(),
            tensors: Encoded::default(),
            payload: Vec::new(),
        }
    }

    /// Adds a joint; parents before children.
    pub fn joint(&mut self, name: &str, parent: Option<u16>) {
        self.joints.push(&JointMeta { name, parent });
    }

    /// Adds a model.
    pub fn model(&mut self, model: &ModelMeta) {
        self.models.push(model);
    }

    /// Adds an f32 tensor of `values.len() / columns` rows.
    pub fn f32s(&mut self, name: &str, columns: usize, values: &[f32]) {
        self.tensor(name, TensorType::F32, columns, values.len(), bytemuck::cast_slice(values));
    }

    /// Adds a u16 tensor of `values.len() / columns` rows.
    pub fn u16s(&mut self, name: &str, columns: usize, values: &[u16]) {
        self.tensor(name, TensorType::U16, columns, values.len(), bytemuck::cast_slice(values));
    }

    /// Adds an i8 tensor of `values.len() / columns` rows.
    pub fn i8s(&mut self, name: &str, columns: usize, values: &[i8]) {
        self.tensor(name, TensorType::I8, columns, values.len(), bytemuck::cast_slice(values));
    }

    /// Adds an i16 tensor of `values.len() / columns` rows.
    pub fn i16s(&mut self, name: &str, columns: usize, values: &[i16]) {
        self.tensor(name, TensorType::I16, columns, values.len(), bytemuck::cast_slice(values));
    }

    /// Adds an i32 tensor of `values.len() / columns` rows.
    pub fn i32s(&mut self, name: &str, columns: usize, values: &[i32]) {
        self.tensor(name, TensorType::I32, columns, values.len(), bytemuck::cast_slice(values));
    }

    /// Adds a layer with int8 weights, an i32 scale and an i32 bias a row: names of weights, scale, bias.
    pub fn integer_layer(&mut self, [weights, scale, bias]: [&str; 3], layer: &IntegerLayer) {
        let bytes = bytemuck::cast_slice(&layer.weights);
        self.tensor(weights, TensorType::I8, TILE * TILE, layer.weights.len(), bytes);
        for (name, values) in [(scale, &layer.multipliers), (bias, &layer.bias)] {
            self.tensor(name, TensorType::I32, 1, values.len(), bytemuck::cast_slice(values));
        }
    }

    /// Adds a tensor of another pack as it is there.
    pub fn copy(&mut self, tensor: &TensorMeta, bytes: &[u8]) {
        let [_, columns] = tensor.shape;
        self.tensor(tensor.name, tensor.kind, columns as usize, tensor.len().unwrap_or(0), bytes);
    }

    /// Adds the models of another pack on the same skeleton, and their tensors; joint limits are left out, a pack has one table.
    pub fn copy_models(&mut self, pack: &Pack) -> Result<(), LoadError> {
        let metadata = pack.metadata();
        metadata.models.iter().filter(|model| model.limits().is_none()).for_each(|model| self.model(&model));
        let kept = |name: &str| !["skeleton/", "rig/", "limit/"].iter().any(|part| name.starts_with(part));
        for tensor in metadata.tensors.iter().filter(|tensor| kept(tensor.name)) {
            self.copy(&tensor, pack.bytes(&tensor).ok_or(LoadError::Metadata)?);
        }
        Ok(())
    }

    /// Adds a row-major matrix in the tiled order of [`kinesic::kernel::Tiled`].
    pub fn tiled(&mut self, name: &str, columns: usize, row_major: &[f32]) {
        self.f32s(name, ROWS, &tile(columns, row_major));
    }

    fn tensor(&mut self, name: &str, kind: TensorType, columns: usize, len: usize, bytes: &[u8]) {
        self.payload.resize(self.payload.len().next_multiple_of(ALIGNMENT), 0);
        let rows = len.checked_div(columns).unwrap_or(0);
        let offset = self.payload.len() as u32;
        self.tensors.push(&TensorMeta { name, kind, shape: [rows as u32, columns as u32], offset });
        self.payload.extend_from_slice(bytes);
    }

    /// The finished file.
    pub fn finish(self, provenance: &Provenance) -> Vec<u8> {
        let provenance = encode(provenance);
        let metadata = encode(&Metadata {
            name: &self.name,
            frame_rate: self.frame_rate,
            joints: List::<JointMeta>::new(self.joints.len, &self.joints.bytes),
            models: List::<ModelMeta>::new(self.models.len, &self.models.bytes),
            tensors: List::<TensorMeta>::new(self.tensors.len, &self.tensors.bytes),
            provenance: &provenance,
        });
        let mut header = [0u8; 16];
        header[0..4].copy_from_slice(&MAGIC);
        header[4..6].copy_from_slice(&VERSION.to_le_bytes());
        header[6..8].copy_from_slice(&self.kind.code().to_le_bytes());
        header[8..12].copy_from_slice(&(metadata.len() as u32).to_le_bytes());
        header[12..16].copy_from_slice(&(self.payload.len() as u32).to_le_bytes());
        let padding = (HEADER_LEN + metadata.len()).next_multiple_of(ALIGNMENT) - HEADER_LEN - metadata.len();
        let body = [&metadata[..], &vec![0; padding], &self.payload].concat();
        [&header[..], &checksum(&header, &body).to_le_bytes(), &body].concat()
    }
}
