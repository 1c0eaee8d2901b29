//! Motions in the joints of machines.

use std::path::Path;

use kinesic_host::moves::{Options, is_moves, parse};

/// Reads the bytes as a motion, under the name before a zero byte if there is one. What is taken is cut, resampled and told in figures, and its
/// table is read again.
pub fn moves(data: &[u8]) {
    let at = data.iter().position(|byte| *byte == 0).filter(|at| *at < 16);
    let (name, bytes) = at.map_or((&b"x.csv"[..], data), |at| (&data[..at], &data[at + 1..]));
    let path = Path::new(std::str::from_utf8(name).unwrap_or("x.json"));
    let options = Options { rate: Some(50.0), episode: None };
    let _ = is_moves(path, &bytes[..bytes.len().min(4096)]);
    let Ok(moves) = parse(bytes, path, &options) else { return };
    assert!(moves.times.windows(2).all(|pair| pair[0] < pair[1]), "times rise");
    assert!(moves.values.len() == moves.frames() * moves.channels.len() && moves.values.iter().all(|x| x.is_finite()));
    let _ = (moves.summary(), moves.is_even(), moves.slice(1..3).resample(25.0), moves.resample(30.0));
    let _ = parse(moves.to_csv().as_bytes(), Path::new("x.csv"), &options);
}
