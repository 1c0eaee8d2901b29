//! The block of input frames: `magic, frames, bytes per frame, rounds` as little-endian words, then the frames. A round is all frames
//! in order; the state goes on from round to round. No rounds are one.
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
    rounds: usize,
    bytes: &'a [u8],
}

fn word(bytes: &[u8], index: usize) -> Option<u32> {
    let field = bytes.get(index * 4..index * 4 + 4)?;
    Some(u32::from_le_bytes([*field.first()?, *field.get(1)?, *field.get(2)?, *field.get(3)?]))
}

impl<'a> Frames<'a> {
    /// The header for `count` frames of `stride` bytes, played `rounds` times.
    pub fn header(count: u32, stride: u32, rounds: u32) -> [u32; HEADER / 4] {
        [MAGIC, count, stride, rounds]
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
        let [count, stride, rounds] = [word(block, 1)? as usize, word(block, 2)? as usize, word(block, 3)? as usize];
        Some(Self { count, stride, rounds: rounds.max(1), bytes: whole.get(HEADER..)? })
    }

    /// The frames in order, round after round.
    pub fn iter(&self) -> impl Iterator<Item = &'a [u8]> {
        let Self { count, stride, rounds, bytes } = *self;
        let frames = (0..rounds).flat_map(move |_| 0..count);
        frames.map_while(move |frame| bytes.get(frame * stride..frame * stride + stride))
    }
}
