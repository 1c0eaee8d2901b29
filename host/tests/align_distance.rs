//! The aligned RMS joint distance against brute force and known cases.

mod align_common;

use align_common::{Gait, noise};
use kinesic_host::align::{AlignError, Ends, Series, aligned, aligned_distance, aligned_rms};

fn series(data: &[f64], channels: usize) -> Series<'_> {
    Series::new(data, channels).expect("whole frames")
}

/// Smallest sum of squared distances over all closed paths, and the length of the path, by enumeration.
fn brute(p: &[&[f64]], q: &[&[f64]]) -> (f64, usize) {
    let (Some((last_p, p_head)), Some((last_q, q_head))) = (p.split_last(), q.split_last()) else {
        return (f64::INFINITY, 0);
    };
    let here: f64 = last_p.iter().zip(*last_q).map(|(a, b)| (a - b).powi(2)).sum();
    if p_head.is_empty() && q_head.is_empty() {
        return (here, 1);
    }
    let before = [brute(p_head, q_head), brute(p_head, q), brute(p, q_head)];
    let best = before.into_iter().min_by(|a, b| a.0.total_cmp(&b.0)).expect("three");
    (best.0 + here, best.1 + 1)
}

#[test]
fn equals_brute_force() {
    for seed in 0..40 {
        let (n, m) = (1 + seed as usize % 6, 1 + seed as usize / 7);
        let (p, q) = (noise(n, 6, true, seed), noise(m, 6, true, seed + 100));
        let rows = |x: &'static [f64]| x.chunks(6).collect::<Vec<_>>();
        let (sum, length) = brute(&rows(p.clone().leak()), &rows(q.clone().leak()));
        let found = aligned_distance(series(&p, 6), series(&q, 6), Ends::Closed).expect("positions");
        let want = (sum / (length as f64 * 2.0)).sqrt();
        assert!((found.rms - want).abs() < 1e-6 * want, "{n} x {m}: {found:?}, {want}");
        assert_eq!((found.path_len, found.joints, found.unmatched), (length, 2, 0));
    }
}

#[test]
fn timing_does_not_count_and_a_shift_does() {
    let mut gait = Gait::new(9, 3);
    let p = gait.clip((0..200).map(f64::from), 0.0);
    assert_eq!(aligned_rms(series(&p, 9), series(&p, 9)), Ok(0.0));
    // Every frame twice: nothing but timing.
    let slow: Vec<f64> = p.chunks(9).flat_map(|row| [row, row].concat()).collect();
    assert!(aligned_rms(series(&p, 9), series(&slow, 9)).expect("positions") < 1e-6);
    // One constant frame against others: each joint 5 = |(3, 4, 0)| away, far from the origin.
    let p: Vec<f64> = [1e4, -1e4, 7.0].repeat(4 * 3);
    let q: Vec<f64> = [1e4 + 3.0, -1e4 + 4.0, 7.0].repeat(6 * 3);
    let rms = aligned_rms(series(&p, 9), series(&q, 9)).expect("positions");
    assert!((rms - 5.0).abs() < 1e-6, "{rms}");
}

#[test]
fn is_symmetric() {
    let (p, q) = (noise(70, 12, true, 1), noise(50, 12, true, 2));
    let forth = aligned_rms(series(&p, 12), series(&q, 12)).expect("positions");
    let back = aligned_rms(series(&q, 12), series(&p, 12)).expect("positions");
    assert!((forth - back).abs() < 1e-9 * forth, "{forth} {back}");
}

#[test]
fn open_ends_leave_out_a_head() {
    let mut gait = Gait::new(9, 3);
    let p = gait.clip((0..200).map(f64::from), 0.0);
    let q = gait.clip((15..215).map(f64::from), 0.0);
    let closed = aligned_rms(series(&p, 9), series(&q, 9)).expect("positions");
    let open = aligned_distance(series(&p, 9), series(&q, 9), Ends::Open { max_fraction: 0.1 }).expect("positions");
    assert!(open.rms < 1e-6 && closed > 0.1, "open {open:?}, closed {closed}");
    assert_eq!(open.unmatched, 30);
}

#[test]
fn one_frame_is_enough_and_none_is_not() {
    let p = noise(1, 3, false, 1);
    assert_eq!(aligned_rms(series(&p, 3), series(&p, 3)), Ok(0.0));
    assert!(matches!(
        aligned_rms(series(&[], 3), series(&p, 3)),
        Err(AlignError::TooShort { found: 0, needed: 1, .. })
    ));
    let p = noise(4, 4, false, 1);
    assert_eq!(aligned_rms(series(&p, 4), series(&p, 4)), Err(AlignError::NotPositions { channels: 4 }));
}

#[test]
fn the_path_is_the_one_that_was_measured() {
    let mut gait = Gait::new(9, 3);
    let p = gait.clip((0..60).map(f64::from), 0.0);
    let q = gait.clip((7..50).map(|t| f64::from(t) * 1.1), 0.3);
    for ends in [Ends::Closed, Ends::Open { max_fraction: 0.2 }] {
        let alone = aligned_distance(series(&p, 9), series(&q, 9), ends).expect("positions");
        let (found, path) = aligned(series(&p, 9), series(&q, 9), ends).expect("positions");
        assert_eq!(found, alone);
        assert_eq!(path.len(), found.path_len);
        let steps = path.windows(2).map(|pair| (pair[1].0 - pair[0].0, pair[1].1 - pair[0].1));
        assert!(steps.into_iter().all(|step| matches!(step, (1, 0) | (0, 1) | (1, 1))));
        let square = |(i, j): &(usize, usize)| (0..9).map(|c| (p[9 * i + c] - q[9 * j + c]).powi(2)).sum::<f64>();
        let rms = (path.iter().map(square).sum::<f64>() / (3 * path.len()) as f64).sqrt();
        assert!((rms - found.rms).abs() < 1e-5 * rms, "{rms} {found:?}");
        let left_out = path[0].0 + path[0].1 + (59 - path[path.len() - 1].0) + (42 - path[path.len() - 1].1);
        assert_eq!(left_out, found.unmatched, "{ends:?}");
        assert_eq!(ends == Ends::Closed, left_out == 0);
    }
}
