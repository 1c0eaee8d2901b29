//! Speed limits on a whole path.

/// The path that keeps the speed limit and is nowhere further from this one than any other that keeps it: the mean of the lowest path
/// above and the highest path below. It sets out before a leap that is too quick and arrives after it. It stays between the least and the
/// greatest value of the path. `most` is the greatest change from one frame to the next. Gives how many values were moved by more than a
/// thousandth.
pub(super) fn keep(path: &mut [f64], most: f64) -> usize {
    if !most.is_finite() {
        return 0;
    }
    // A hair less, so that the few digits of values and times in a table do not exceed it.
    let most = most * (1.0 - 1e-4);
    let (mut above, mut below) = (path.to_vec(), path.to_vec());
    for at in 1..path.len() {
        above[at] = above[at].min(above[at - 1] + most);
        below[at] = below[at].max(below[at - 1] - most);
    }
    for at in (1..path.len()).rev() {
        above[at - 1] = above[at - 1].min(above[at] + most);
        below[at - 1] = below[at - 1].max(below[at] - most);
    }
    let mut moved = 0;
    for ((value, above), below) in path.iter_mut().zip(above).zip(below) {
        let kept = 0.5 * (above + below);
        moved += usize::from((kept - *value).abs() > 1e-3);
        *value = kept;
    }
    moved
}
