//! Known warps are found again.

mod align_common;

use align_common::{Gait, assert_never_rises};
use kinesic_host::align::{Ends, Search, Series, Settings, Warp, align};

/// Time in source frames of target frame j: speeds between 0.55 and 1.6 source frames per target frame.
fn known(j: f64, length: f64) -> f64 {
    let x = j / length * std::f64::consts::TAU;
    j + length * (0.05 * x.sin() + 0.02 * (3.0 * x).sin()) * (600.0 / length.max(600.0))
}

/// Target frame that shows source time t.
fn inverse(t: f64, length: f64) -> f64 {
    let (mut low, mut high) = (0.0, length);
    for _ in 0..60 {
        let mid = 0.5 * (low + high);
        if known(mid, length) < t { low = mid } else { high = mid }
    }
    low
}

fn series(data: &[f64], channels: usize) -> Series<'_> {
    Series::new(data, channels).expect("whole frames")
}

/// A clip, its styled and warped copy, and the warp found.
fn made(frames: usize, channels: usize, settings: &Settings) -> (Vec<f64>, Vec<f64>, Warp) {
    let mut gait = Gait::new(channels, frames as u64);
    let last = (frames - 1) as f64;
    let u = gait.clip((0..frames).map(|t| t as f64), 0.05);
    let mut v = gait.clip((0..frames).map(|j| known(j as f64, last)), 0.05);
    gait.style(&mut v);
    let warp = align(series(&u, channels), series(&v, channels), settings).expect("aligns");
    (u, v, warp)
}

fn mean_error(found: &[f64], truth: impl Fn(usize) -> f64, range: std::ops::Range<usize>) -> f64 {
    let count = range.len() as f64;
    range.map(|t| (found[t] - truth(t)).abs()).sum::<f64>() / count
}

#[test]
fn a_smooth_warp_with_scale_offset_and_noise() {
    for (frames, channels) in [(300, 20), (600, 60), (1500, 33)] {
        let (u, v, warp) = made(frames, channels, &Settings::default());
        let last = (frames - 1) as f64;
        let path = warp.path();
        assert!(path.windows(2).any(|w| w[1].0 == w[0].0), "no repetition");
        assert!(path.windows(2).any(|w| w[1].0 > w[0].0 + 1), "no deletion");
        assert_eq!((path.first(), path.last()), (Some(&(0, 0)), Some(&(frames - 1, frames - 1))));
        assert_never_rises(&warp);

        let clock = warp.target_on_source();
        let error = mean_error(clock, |t| inverse(t as f64, last), 0..frames);
        println!("{frames} frames x {channels} channels: mean error of the clock {error:.3} frames");
        assert!(error < 0.5, "{frames} x {channels}: mean error {error} frames");
        assert!(clock.windows(2).all(|w| w[1] >= w[0]), "the clock runs backwards");

        let speed = warp.slope(10);
        let truth = |t: usize| inverse(t as f64 + 0.5, last) - inverse(t as f64 - 0.5, last);
        let error = mean_error(&speed, truth, 1..frames - 1);
        assert!(error < 0.08, "{frames} x {channels}: mean error of the speed {error}");
        assert!(speed.iter().all(|&s| s >= 0.0));

        // On the source's clock the target is the styled source; a u + b comes near it, u alone does not.
        let resampled = warp.apply(series(&v, channels)).expect("the target");
        let fitted = warp.fitted(series(&u, channels)).expect("the source");
        let rms =
            |a: &[f64]| (a.iter().zip(&resampled).map(|(a, b)| (a - b).powi(2)).sum::<f64>() / a.len() as f64).sqrt();
        assert!(rms(&fitted) < 0.3 * rms(&u), "{} of {}", rms(&fitted), rms(&u));
    }
}

#[test]
fn a_clip_is_aligned_with_itself_on_the_diagonal() {
    let u = Gait::new(12, 5).clip((0..200).map(f64::from), 0.0);
    let warp = align(series(&u, 12), series(&u, 12), &Settings::default()).expect("aligns");
    assert!(warp.path().iter().all(|&(i, j)| i == j));
    assert!(warp.converged() && warp.energy().total() < 1e-9);
    assert!(warp.slope(8).iter().all(|s| (s - 1.0).abs() < 1e-9));
}

#[test]
fn one_clip_three_times_as_long() {
    for (n, m) in [(300, 100), (100, 300)] {
        let mut gait = Gait::new(24, 9);
        let speed = (n - 1) as f64 / (m - 1) as f64;
        let u = gait.clip((0..n).map(|t| t as f64), 0.02);
        let v = gait.clip((0..m).map(|j| j as f64 * speed), 0.02);
        let warp = align(series(&u, 24), series(&v, 24), &Settings::default()).expect("aligns");
        assert_never_rises(&warp);
        let error = mean_error(warp.target_on_source(), |t| t as f64 / speed, 0..n);
        assert!(error < 1.0, "{n}:{m}: {error}");
    }
}

#[test]
fn open_ends_leave_out_what_the_other_clip_does_not_have() {
    // Each clip has a head that the other lacks: the target starts 20 frames later in the gait and goes on 25 longer.
    let mut gait = Gait::new(30, 11);
    let u = gait.clip((0..400).map(f64::from), 0.05);
    let mut v = gait.clip((0..405).map(|j| known(f64::from(j), 404.0) + 20.0), 0.05);
    gait.style(&mut v);
    for search in [Search::Full, Search::Corridor { radius: 32 }] {
        let settings = Settings { ends: Ends::Open { max_fraction: 0.15 }, search, ..Settings::default() };
        let warp = align(series(&u, 30), series(&v, 30), &settings).expect("aligns");
        assert_never_rises(&warp);
        let (covered, target) = (warp.covered(), warp.covered_target());
        assert!(covered.start.abs_diff(20) <= 3 && covered.end > 395, "source {covered:?}");
        let end = inverse(380.0, 404.0);
        assert!(target.start <= 2 && (target.end as f64 - end).abs() < 5.0, "target {target:?}, true end {end}");
        let truth = |t: usize| inverse(t as f64 - 20.0, 404.0);
        let error = mean_error(warp.target_on_source(), truth, covered);
        assert!(error < 0.7, "{error}");
    }
    // The same clips with ends that match: open ends must not shorten them.
    let settings = Settings { ends: Ends::Open { max_fraction: 0.15 }, ..Settings::default() };
    let (_, _, warp) = made(400, 30, &settings);
    assert!(warp.covered().len() > 390 && warp.covered_target().len() > 390, "{:?}", warp.covered());
}
