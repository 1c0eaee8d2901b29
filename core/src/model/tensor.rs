//! Typed views of a pack's tensors.

use bytemuck::Pod;

use super::{ALIGNMENT, LoadError, Metadata, Pack, TensorMeta, TensorType};

/// Every tensor aligned and inside the payload.
pub(super) fn payload_in_bounds(metadata: &Metadata, payload: &[u8]) -> Result<(), LoadError> {
    for (index, tensor) in metadata.tensors.iter().enumerate() {
        bytes(&tensor, payload).ok_or(LoadError::Bounds { tensor: index })?;
    }
    Ok(())
}

fn bytes<'a>(tensor: &TensorMeta, payload: &'a [u8]) -> Option<&'a [u8]> {
    let start = tensor.offset as usize;
    let end = start.checked_add(tensor.len()?.checked_mul(tensor.kind.size())?)?;
    if start.is_multiple_of(ALIGNMENT) { payload.get(start..end) } else { None }
}

impl<'a> Pack<'a> {
    /// Rows of the tensor `name`, where the file decides how many there are.
    pub fn rows(&self, name: &'static str) -> Result<usize, LoadError> {
        let meta = self.metadata.tensors.iter().find(|t| t.name == name).ok_or(LoadError::NoTensor { tensor: name })?;
        Ok(meta.shape[0] as usize)
    }

    /// The bytes of a tensor of this pack's metadata; `None` for one that is not in it.
    pub fn bytes(&self, tensor: &TensorMeta) -> Option<&'a [u8]> {
        bytes(tensor, self.payload)
    }

    /// Number type of the tensor `name`.
    pub fn number(&self, name: &'static str) -> Result<TensorType, LoadError> {
        let meta = self.metadata.tensors.iter().find(|t| t.name == name).ok_or(LoadError::NoTensor { tensor: name })?;
        Ok(meta.kind)
    }

    /// The int8 tensor `name` as `expected` tile groups of sixteen weights, four words each: see
    /// [`Quantised`](crate::kernel::Quantised).
    pub(crate) fn packed(&self, name: &'static str, expected: usize) -> Result<&'a [[u32; 4]], LoadError> {
        let meta = self.metadata.tensors.iter().find(|t| t.name == name).ok_or(LoadError::NoTensor { tensor: name })?;
        let groups: Option<&'a [[u32; 4]]> = bytes(&meta, self.payload)
            .filter(|_| meta.kind == TensorType::I8)
            .and_then(|bytes| bytemuck::try_cast_slice(bytes).ok());
        let found = groups.map_or(meta.len().unwrap_or(usize::MAX) / 16, <[_]>::len);
        groups.filter(|groups| groups.len() == expected).ok_or(LoadError::Shape { tensor: name, found, expected })
    }

    /// The tensor `name` as a slice of `T` (`f32`, `u16`, `i16`, `i32` or arrays of them), which must have `expected` elements.
    ///
    /// Numbers are checked to be finite, so that no step can meet a NaN that came from the file.
    pub fn slice<T: Element>(&self, name: &'static str, expected: usize) -> Result<&'a [T], LoadError> {
        let meta = self.metadata.tensors.iter().find(|t| t.name == name).ok_or(LoadError::NoTensor { tensor: name })?;
        let values: &'a [T] = bytes(&meta, self.payload)
            .filter(|_| meta.kind == T::TYPE)
            .and_then(|bytes| bytemuck::try_cast_slice(bytes).ok())
            .ok_or(LoadError::Shape { tensor: name, found: meta.len().unwrap_or(usize::MAX), expected })?;
        if values.len() != expected {
            return Err(LoadError::Shape { tensor: name, found: values.len(), expected });
        }
        match values.iter().position(|value| !value.is_valid()) {
            Some(index) => Err(LoadError::Value { tensor: name, index }),
            None => Ok(values),
        }
    }
}

/// What a tensor can be read as.
pub trait Element: Pod {
    /// Number type in the file.
    const TYPE: TensorType;
    /// True for every number that a model can work with.
    fn is_valid(&self) -> bool;
}

impl Element for f32 {
    const TYPE: TensorType = TensorType::F32;
    fn is_valid(&self) -> bool {
        self.is_finite()
    }
}

impl Element for u16 {
    const TYPE: TensorType = TensorType::U16;
    fn is_valid(&self) -> bool {
        true
    }
}

impl Element for i16 {
    const TYPE: TensorType = TensorType::I16;
    fn is_valid(&self) -> bool {
        true
    }
}

impl Element for i32 {
    const TYPE: TensorType = TensorType::I32;
    fn is_valid(&self) -> bool {
        true
    }
}

impl<T: Element, const N: usize> Element for [T; N]
where
    [T; N]: Pod,
{
    const TYPE: TensorType = T::TYPE;
    fn is_valid(&self) -> bool {
        self.iter().all(T::is_valid)
    }
}
