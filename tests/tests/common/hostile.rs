//! Packs whose numbers and names were changed, written again by the pack writer: their checksum is right.

use kinesic::model::{JointMeta, Kind, ModelMeta, TensorMeta, TensorType};
use kinesic_host::pack::{PackFile, PackWriter, Provenance};

/// A pack in parts, to be changed and put together again.
#[derive(Clone)]
pub struct Hostile {
    pub kind: Kind,
    pub name: String,
    pub frame_rate: f32,
    pub joints: Vec<(String, Option<u16>)>,
    pub models: Vec<ModelMeta<'static>>,
    pub provenance: Provenance,
    tensors: Vec<(TensorMeta<'static>, Vec<u8>)>,
}

/// The writer takes names that live as long as the models; a test's few packs may stay.
fn kept(file: &PackFile) -> kinesic::Pack<'static> {
    Box::leak(Box::new(file.clone())).pack().unwrap()
}

impl Hostile {
    /// The parts of a pack.
    pub fn of(file: &PackFile) -> Self {
        let pack = kept(file);
        let metadata = pack.metadata();
        Self {
            kind: pack.kind(),
            name: metadata.name.to_owned(),
            frame_rate: metadata.frame_rate,
            joints: metadata.joints.iter().map(|JointMeta { name, parent }| (name.to_owned(), parent)).collect(),
            models: metadata.models.iter().collect(),
            provenance: file.provenance().unwrap(),
            tensors: metadata.tensors.iter().map(|meta| (meta, pack.bytes(&meta).unwrap().to_vec())).collect(),
        }
    }

    /// Adds models and tensors of another pack on the same skeleton.
    #[allow(dead_code, reason = "not every test adds models")]
    pub fn add(&mut self, other: &PackFile) {
        let other = Self::of(other);
        self.models.extend(other.models);
        let new =
            other.tensors.into_iter().filter(|(meta, _)| self.tensors.iter().all(|(own, _)| own.name != meta.name));
        let new: Vec<_> = new.collect();
        self.tensors.extend(new);
    }

    /// Changes the numbers of a tensor of f32.
    #[allow(dead_code, reason = "not every test changes tensors")]
    pub fn f32s(&mut self, name: &str, change: impl Fn(&mut [f32])) {
        let (meta, bytes) = self.tensors.iter_mut().find(|(meta, _)| meta.name == name).unwrap();
        assert_eq!(meta.kind, TensorType::F32);
        let mut numbers: Vec<f32> = bytes.chunks_exact(4).map(|b| f32::from_le_bytes(b.try_into().unwrap())).collect();
        change(&mut numbers);
        *bytes = numbers.into_iter().flat_map(f32::to_le_bytes).collect();
    }

    /// Names of the tensors of f32.
    #[allow(dead_code, reason = "not every test changes tensors")]
    pub fn f32_tensors(&self) -> Vec<&'static str> {
        self.tensors.iter().filter(|(meta, _)| meta.kind == TensorType::F32).map(|(meta, _)| meta.name).collect()
    }

    /// The pack.
    pub fn bytes(&self) -> Vec<u8> {
        let mut out = PackWriter::new(self.kind, &self.name, self.frame_rate);
        self.joints.iter().for_each(|(name, parent)| out.joint(name, *parent));
        self.models.iter().for_each(|model| out.model(model));
        self.tensors.iter().for_each(|(meta, bytes)| out.copy(meta, bytes));
        out.finish(&self.provenance)
    }
}
