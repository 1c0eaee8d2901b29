//! Lines over semihosting, without `core::fmt`: the images of workloads must be free of it.

use crate::board;

/// A short text as it is.
#[inline(never)]
pub fn text(message: &str) {
    message.bytes().for_each(board::put);
}

/// `label` and a number in hexadecimal.
#[inline(never)]
pub fn line(label: &str, value: u64) {
    text(label);
    let mut rest = value;
    for _ in 0..16 {
        rest = rest.rotate_left(4);
        let digit = (rest & 15) as u8;
        board::put(digit + if digit < 10 { b'0' } else { b'a' - 10 });
    }
    board::put(b'\n');
}
