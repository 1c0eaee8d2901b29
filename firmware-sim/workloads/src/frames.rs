//! The block of input frames: `magic, frames, bytes per frame, 0` as little-endian words, then the frames.
//!
//! The emulator places it in memory outside the part's flash and RAM, where a sensor's DMA buffer would be, so that the
//! image's sizes are the product's and another clip needs no new image.

const MAGIC: u32 = u32::from_le_bytes(*b"KNFR");
const HEADER: usize = 16;

/// Input frames of equal size.
#[derive(Clone, Copy, Debug)]
pub struct Frames<'a> {
    count: usize,
    stride: usize,
    bytes: &'a [u8],
}

fn word(bytes: &[u8], index: usize) -> Option<u32> {
    let field = bytes.get(index * 4..index * 4 + 4)?;
    Some(u32::from_le_bytes([*field.first()?, *field.get(1)?, *field.get(2)?, *field.get(3)?]))
}

impl<'a> Frames<'a> {
    /// Bytes of the header, and the header itself for `count` frames of `stride` bytes.
    pub fn header(count: u32, stride: u32) -> [u32; HEADER / 4] {
        [MAGIC, count, stride, 0]
    }

    /// Length of the whole block, read from its header; `None` if it is no such block.
    pub fn block_len(header: &[u8]) -> Option<usize> {
        if word(header, 0)? != MAGIC {
            return None;
        }
        (word(header, 1)? as usize).checked_mul(word(header, 2)? as usize)?.checked_add(HEADER)
    }

    /// Views a block. `None` if the magic or the length is wrong.
    pub fn open(block: &'a [u8]) -> Option<Self> {
        let whole = block.get(..Self::block_len(block)?)?;
        Some(Self { count: word(block, 1)? as usize, stride: word(block, 2)? as usize, bytes: whole.get(HEADER..)? })
    }

    /// The frames in order.
    pub fn iter(&self) -> impl Iterator<Item = &'a [u8]> {
        let (bytes, stride) = (self.bytes, self.stride);
        (0..self.count).map_while(move |frame| bytes.get(frame * stride..frame * stride + stride))
    }
}
