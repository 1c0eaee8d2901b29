//! Speed limits.

/// Greatest change from one frame to the next for a speed limit that allows `most`: a hair less, so that the few digits of values and
/// times in a table do not exceed it. `digits` is how far two rounded values may come apart.
pub(super) fn a_frame(most: f64, digits: f64) -> f64 {
    (most * (1.0 - 1e-4) - digits).max(0.0)
}

/// The path that keeps the speed limit and is nowhere further from this one than any other that keeps it: the mean of the lowest path
/// above and the highest path below. It sets out before a leap that is too quick and arrives after it. It stays between the least and the
/// greatest value of the path. `most` is the greatest change from one frame to the next.
pub(super) fn keep(path: &mut [f64], most: f64) {
    if !most.is_finite() {
        return;
    }
    let (mut above, mut below) = (path.to_vec(), path.to_vec());
    for at in 1..path.len() {
        above[at] = above[at].min(above[at - 1] + most);
        below[at] = below[at].max(below[at - 1] - most);
    }
    for at in (1..path.len()).rev() {
        above[at - 1] = above[at - 1].min(above[at] + most);
        below[at - 1] = below[at - 1].max(below[at] - most);
    }
    path.iter_mut().zip(above).zip(below).for_each(|((value, above), below)| *value = 0.5 * (above + below));
}
