//! From a path to a clock: for each source frame a fractional target frame.

/// Target frame of every source frame: the mean over repetitions, linear between the neighbours of frames left out, the
/// path's own ends exactly, and constant beyond them. Never falls. O(frames).
pub(super) fn clock(path: &[(usize, usize)], source_frames: usize) -> Vec<f64> {
    let mut out = vec![0.0; source_frames];
    let mut previous: Option<(usize, f64)> = None;
    let (Some(first), Some(last)) = (path.first(), path.last()) else {
        return out;
    };
    for run in path.chunk_by(|p, q| p.0 == q.0) {
        let (Some(&(i, from)), Some(&(_, to))) = (run.first(), run.last()) else {
            continue;
        };
        let value = match i {
            _ if i == first.0 && previous.is_none() => first.1 as f64,
            _ if i == last.0 => last.1 as f64,
            _ => (from + to) as f64 / 2.0,
        };
        let (start, before) = previous.unwrap_or((i, value));
        for (n, slot) in out.iter_mut().enumerate().take(i + 1).skip(start) {
            let part = if i == start { 1.0 } else { (n - start) as f64 / (i - start) as f64 };
            *slot = before + (value - before) * part;
        }
        previous = Some((i, value));
    }
    for slot in out.iter_mut().take(first.0) {
        *slot = first.1 as f64;
    }
    for slot in out.iter_mut().skip(last.0 + 1) {
        *slot = last.1 as f64;
    }
    out
}

/// Triangular moving average of half-width `half`, the curve continued beyond its ends by point reflection: keeps the end
/// values, and a curve that never falls still never falls. O(frames x half).
pub(super) fn smooth(values: &[f64], half: usize) -> Vec<f64> {
    let half = half.min(values.len().saturating_sub(1)) as isize;
    let last = values.len() as isize - 1;
    let at = |t: isize| -> f64 {
        let get = |t: isize| values.get(t as usize).copied().unwrap_or(0.0);
        if t < 0 {
            2.0 * get(0) - get(-t)
        } else if t > last {
            2.0 * get(last) - get(2 * last - t)
        } else {
            get(t)
        }
    };
    (0..=last)
        .map(|t| {
            let (mut sum, mut weights) = (0.0, 0.0);
            for d in -half..=half {
                let w = (half + 1 - d.abs()) as f64;
                sum += w * at(t + d);
                weights += w;
            }
            sum / weights
        })
        .collect()
}

/// Derivative by central differences, one-sided at the ends; zero for a single frame. O(frames).
pub(super) fn slope(values: &[f64]) -> Vec<f64> {
    let last = values.len().saturating_sub(1);
    (0..values.len())
        .map(|t| {
            let (a, b) = (t.saturating_sub(1), (t + 1).min(last));
            match (values.get(a), values.get(b)) {
                (Some(&x), Some(&y)) if b > a => (y - x) / (b - a) as f64,
                _ => 0.0,
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn repetitions_are_averaged_and_gaps_interpolated() {
        let path = [(0, 0), (1, 1), (1, 2), (1, 3), (2, 4), (5, 5), (6, 6)];
        let got = clock(&path, 8);
        let want = [0.0, 2.0, 4.0, 4.0 + 1.0 / 3.0, 4.0 + 2.0 / 3.0, 5.0, 6.0, 6.0];
        assert!(got.iter().zip(want).all(|(g, w)| (g - w).abs() < 1e-12), "{got:?}");
    }

    #[test]
    fn smoothing_keeps_ends_and_order() {
        let stairs: Vec<f64> = (0..50).map(|t| f64::from(t / 5) * 4.0).collect();
        let s = smooth(&stairs, 6);
        assert_eq!((s[0], s[49]), (stairs[0], stairs[49]));
        assert!(s.windows(2).all(|w| w[1] >= w[0] - 1e-12));
        assert!(slope(&s).iter().all(|&d| d >= -1e-12));
    }
}
