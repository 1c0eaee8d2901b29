//! The numbers of an accessor, with every length checked: the `gltf` crate's own iterators trust the file.

use gltf::accessor::sparse::IndexType;
use gltf::accessor::{DataType, Dimensions};

/// What is wrong with an accessor.
const CUT: &str = "an accessor reaches beyond its buffer. The file is cut off, or export it again";

/// Rows of up to four numbers, the missing ones 0. Whole numbers are shares of their greatest, as glTF wants it of rotations.
pub(super) fn rows(accessor: &gltf::Accessor, buffers: &[Vec<u8>]) -> Result<Vec<[f32; 4]>, String> {
    let columns = columns(accessor.dimensions()).ok_or("an accessor of keys holds matrices, expected numbers")?;
    let (kind, count) = (accessor.data_type(), accessor.count());
    let view = accessor.view();
    let mut rows = match view {
        Some(view) => {
            let bytes = Bytes { view: view_of(&view, buffers)?, at: accessor.offset(), stride: view.stride() };
            bytes.rows(kind, columns, count)?
        }
        // Without a view all is 0 but what the sparse part says; it cannot be longer than what the file holds.
        None if count <= buffers.iter().map(Vec::len).sum::<usize>() => vec![[0.0; 4]; count],
        None => return Err(CUT.into()),
    };
    let Some(sparse) = accessor.sparse() else { return Ok(rows) };
    let (indices, values) = (sparse.indices(), sparse.values());
    let (index_view, value_view) = (indices.view(), values.view());
    let kind_of_index = match indices.index_type() {
        IndexType::U8 => DataType::U8,
        IndexType::U16 => DataType::U16,
        IndexType::U32 => DataType::U32,
    };
    let places = Bytes { view: view_of(&index_view, buffers)?, at: indices.offset(), stride: index_view.stride() };
    let places = places.cells(kind_of_index, 1, sparse.count())?;
    let values = Bytes { view: view_of(&value_view, buffers)?, at: values.offset(), stride: value_view.stride() };
    let values = values.rows(kind, columns, sparse.count())?;
    for (place, value) in places.zip(values) {
        let place = place.iter().rev().fold(0, |sum, byte| (sum << 8) | usize::from(*byte));
        *rows.get_mut(place).ok_or("a sparse accessor names a key that is not there")? = value;
    }
    Ok(rows)
}

fn columns(dimensions: Dimensions) -> Option<usize> {
    match dimensions {
        Dimensions::Scalar => Some(1),
        Dimensions::Vec2 => Some(2),
        Dimensions::Vec3 => Some(3),
        Dimensions::Vec4 => Some(4),
        _ => None,
    }
}

fn view_of<'a>(view: &gltf::buffer::View, buffers: &'a [Vec<u8>]) -> Result<&'a [u8], String> {
    let bytes = buffers.get(view.buffer().index()).ok_or(CUT)?;
    let end = view.offset().checked_add(view.length()).ok_or(CUT)?;
    Ok(bytes.get(view.offset()..end).ok_or(CUT)?)
}

/// Where the cells of an accessor are.
struct Bytes<'a> {
    view: &'a [u8],
    at: usize,
    stride: Option<usize>,
}

impl<'a> Bytes<'a> {
    /// The bytes of each row.
    fn cells(&self, kind: DataType, columns: usize, count: usize) -> Result<impl Iterator<Item = &'a [u8]>, String> {
        let size = kind.size() * columns;
        let stride = self.stride.unwrap_or(size);
        if stride < size {
            return Err(format!("an accessor has a row every {stride} bytes, each of {size}. Export it again"));
        }
        let length = count.checked_sub(1).map_or(Some(0), |n| n.checked_mul(stride)?.checked_add(size)).ok_or(CUT)?;
        let end = self.at.checked_add(length).ok_or(CUT)?;
        let bytes = self.view.get(self.at..end).ok_or(CUT)?;
        Ok(bytes.chunks(stride).filter_map(move |row| row.get(..size)))
    }

    fn rows(&self, kind: DataType, columns: usize, count: usize) -> Result<Vec<[f32; 4]>, String> {
        let row = |cells: &[u8]| {
            let mut row = [0.0; 4];
            let size = kind.size();
            row.iter_mut().zip(cells.chunks_exact(size)).for_each(|(out, cell)| *out = number(kind, cell));
            row
        };
        Ok(self.cells(kind, columns, count)?.map(row).collect())
    }
}

/// A number of little-endian bytes.
fn number(kind: DataType, cell: &[u8]) -> f32 {
    let two = || <[u8; 2]>::try_from(cell).unwrap_or_default();
    let four = || <[u8; 4]>::try_from(cell).unwrap_or_default();
    let one = cell.first().copied().unwrap_or(0);
    match kind {
        DataType::I8 => (f32::from(one.cast_signed()) / 127.0).max(-1.0),
        DataType::U8 => f32::from(one) / 255.0,
        DataType::I16 => (f32::from(i16::from_le_bytes(two())) / 32767.0).max(-1.0),
        DataType::U16 => f32::from(u16::from_le_bytes(two())) / 65535.0,
        DataType::U32 => (f64::from(u32::from_le_bytes(four())) / f64::from(u32::MAX)) as f32,
        DataType::F32 => f32::from_le_bytes(four()),
    }
}
