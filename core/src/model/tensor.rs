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
    /// What the file says of the tensor `name`.
    #[inline(never)]
    fn meta(&self, name: &'static str) -> Result<TensorMeta<'a>, LoadError> {
        self.metadata.tensors.iter().find(|t| t.name == name).ok_or(LoadError::NoTensor { tensor: name })
    }

    /// Rows of the tensor `name`, where the file decides how many there are.
    pub fn rows(&self, name: &'static str) -> Result<usize, LoadError> {
        Ok(self.meta(name)?.shape[0] as usize)
    }

    /// The bytes of a tensor of this pack's metadata; `None` for one that is not in it.
    pub fn bytes(&self, tensor: &TensorMeta) -> Option<&'a [u8]> {
        bytes(tensor, self.payload)
    }

    /// Number type of the tensor `name`.
    pub fn number(&self, name: &'static str) -> Result<TensorType, LoadError> {
        Ok(self.meta(name)?.kind)
    }

    /// The int8 tensor `name` as `expected` tile groups of sixteen weights, four words each: see
    /// [`Quantised`](crate::kernel::Quantised).
    pub(crate) fn packed(&self, name: &'static str, expected: usize) -> Result<&'a [[u32; 4]], LoadError> {
        self.cast(name, TensorType::I8, expected)
    }

    /// The tensor `name` as a slice of `T` (`f32`, `u16`, `i16`, `i32` or arrays of them), which must have `expected` elements.
    ///
    /// Numbers are checked to be finite, so that no step can meet a NaN that came from the file.
    pub fn slice<T: Element>(&self, name: &'static str, expected: usize) -> Result<&'a [T], LoadError> {
        self.cast(name, T::TYPE, expected)
    }

    fn cast<T: Pod>(&self, name: &'static str, kind: TensorType, expected: usize) -> Result<&'a [T], LoadError> {
        let bytes = self.checked(name, kind, expected, size_of::<T>())?;
        bytemuck::try_cast_slice(bytes).map_err(|_| LoadError::Shape { tensor: name, found: 0, expected })
    }

    /// The bytes of `expected` elements of a size. One function for all types, instead of one each.
    #[inline(never)]
    fn checked(
        &self,
        name: &'static str,
        kind: TensorType,
        expected: usize,
        size: usize,
    ) -> Result<&'a [u8], LoadError> {
        let meta = self.meta(name)?;
        let shape = |found| LoadError::Shape { tensor: name, found, expected };
        let bytes = bytes(&meta, self.payload)
            .filter(|bytes| meta.kind == kind && bytes.len().is_multiple_of(size))
            .ok_or(shape(meta.len().unwrap_or(usize::MAX)))?;
        let found = bytes.len().checked_div(size).unwrap_or(0);
        if found != expected {
            return Err(shape(found));
        }
        let numbers: &[f32] =
            if kind == TensorType::F32 { bytemuck::try_cast_slice(bytes).unwrap_or(&[f32::NAN]) } else { &[] };
        match numbers.iter().position(|number| !number.is_finite()) {
            Some(at) => Err(LoadError::Value { tensor: name, index: (4 * at).checked_div(size).unwrap_or(0) }),
            None => Ok(bytes),
        }
    }
}

/// What a tensor can be read as.
pub trait Element: Pod {
    /// Number type in the file.
    const TYPE: TensorType;
}

impl Element for f32 {
    const TYPE: TensorType = TensorType::F32;
}

impl Element for u16 {
    const TYPE: TensorType = TensorType::U16;
}

impl Element for i16 {
    const TYPE: TensorType = TensorType::I16;
}

impl Element for i32 {
    const TYPE: TensorType = TensorType::I32;
}

impl<T: Element, const N: usize> Element for [T; N]
where
    [T; N]: Pod,
{
    const TYPE: TensorType = T::TYPE;
}
