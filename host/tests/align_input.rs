//! Input at the edge, and beyond it.

mod align_common;

use align_common::{assert_never_rises, noise};
use kinesic_host::align::{AlignError, Ends, Series, Settings, Side, align, aligned_rms};

fn series(data: &[f64], channels: usize) -> Series<'_> {
    Series::new(data, channels).expect("whole frames")
}

#[test]
fn a_table_must_be_whole_frames() {
    assert_eq!(Series::new(&[0.0; 7], 3).err(), Some(AlignError::Shape { values: 7, channels: 3 }));
    assert_eq!(Series::new(&[], 0).err(), Some(AlignError::Shape { values: 0, channels: 0 }));
    assert_eq!(series(&[0.0; 6], 3).row(2), None);
    assert_eq!(series(&[0.0; 6], 3).row(usize::MAX), None);
}

#[test]
fn empty_and_single_frames_are_refused_by_name() {
    let clip = noise(10, 3, true, 1);
    for (frames, side) in [(0, Side::Source), (1, Side::Source), (0, Side::Target), (1, Side::Target)] {
        let short = series(&clip[..frames * 3], 3);
        let (u, v) = if side == Side::Source { (short, series(&clip, 3)) } else { (series(&clip, 3), short) };
        let error = align(u, v, &Settings::default()).expect_err("too short");
        assert_eq!(error, AlignError::TooShort { side, found: frames, needed: 2 });
    }
}

#[test]
fn the_smallest_pairs_align() {
    for (n, m) in [(2, 2), (2, 3), (3, 2), (2, 5), (2, 20), (20, 2), (3, 40)] {
        let (u, v) = (noise(n, 2, true, 7), noise(m, 2, true, 8));
        for (ends, stretch) in [(Ends::Closed, 1.0), (Ends::Closed, 3.0), (Ends::Open { max_fraction: 0.5 }, 3.0)] {
            let settings = Settings { ends, max_stretch: stretch, ..Settings::default() };
            let warp = align(series(&u, 2), series(&v, 2), &settings).unwrap_or_else(|e| panic!("{n} x {m}: {e}"));
            assert_never_rises(&warp);
            assert_eq!(warp.target_on_source().len(), n);
            assert_eq!(warp.slope(5).len(), n);
            assert_eq!(warp.apply(series(&v, 2)).map(|a| a.len()), Ok(2 * n));
        }
    }
}

#[test]
fn a_pair_of_one_to_a_thousand_is_refused_with_both_lengths() {
    let (u, v) = (noise(3, 1, true, 7), noise(3000, 1, true, 8));
    let error = align(series(&u, 1), series(&v, 1), &Settings::default()).expect_err("too different");
    assert!(error.to_string().contains("3 source and 3000 target frames"), "{error}");
}

#[test]
fn not_a_number_is_refused_with_its_place() {
    let clip = noise(10, 4, true, 1);
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let mut broken = clip.clone();
        broken[4 * 6 + 2] = bad;
        let error = align(series(&clip, 4), series(&broken, 4), &Settings::default()).expect_err("not finite");
        assert!(matches!(error, AlignError::NotFinite { side: Side::Target, frame: 6, channel: 2, .. }), "{error}");
        assert!(aligned_rms(series(&broken[..36], 3), series(&clip[..36], 3)).is_err());
    }
}

#[test]
fn different_channels_are_refused_with_both_counts() {
    let clip = noise(12, 6, true, 1);
    let error = align(series(&clip, 6), series(&clip, 3), &Settings::default()).expect_err("channels");
    assert_eq!(error, AlignError::Channels { source_channels: 6, target_channels: 3 });
}

#[test]
fn still_clips_and_still_channels_stay_on_the_diagonal() {
    let still = vec![2.5; 80 * 6];
    let warp = align(series(&still, 6), series(&still, 6), &Settings::default()).expect("still clips");
    assert!(warp.path().iter().all(|&(i, j)| i == j));
    // One channel moves, the others do not, and stand elsewhere in the target.
    let (mut u, mut v) = (still.clone(), vec![-1.0; 80 * 6]);
    for t in 0..80 {
        u[t * 6] = (t as f64 / 5.0).sin();
        v[t * 6] = 2.0 * (t as f64 / 5.0).sin();
    }
    let warp = align(series(&u, 6), series(&v, 6), &Settings::default()).expect("still channels");
    assert!(warp.path().iter().all(|&(i, j)| i == j), "{:?}", warp.path());
    let fitted = warp.fitted(series(&u, 6)).expect("the source");
    assert!(fitted.iter().zip(&v).all(|(a, b)| (a - b).abs() < 1e-2));
}

#[test]
fn large_values_align_and_huge_ones_are_refused() {
    for (size, fits) in [(1e9, true), (1e11, true), (1e30, false), (1e300, false)] {
        let u: Vec<f64> = noise(40, 3, false, 3).iter().map(|x| x * size).collect();
        let v: Vec<f64> = noise(50, 3, false, 4).iter().map(|x| x * size).collect();
        for standardise in [true, false] {
            let settings = Settings { standardise, ..Settings::default() };
            match align(series(&u, 3), series(&v, 3), &settings) {
                Ok(warp) => {
                    assert!(fits, "{size:e}");
                    assert_never_rises(&warp);
                    assert!(warp.scale().iter().all(|a| a.is_finite()), "{size:e}");
                }
                Err(error) => assert!(!fits && matches!(error, AlignError::NotFinite { .. }), "{size:e}: {error}"),
            }
        }
    }
}

#[test]
fn settings_out_of_range_are_named() {
    let clip = noise(10, 3, true, 1);
    let broken = [
        (Settings { ends: Ends::Open { max_fraction: 0.7 }, ..Settings::default() }, "max_fraction"),
        (Settings { ridge: 0.0, ..Settings::default() }, "ridge"),
        (Settings { max_stretch: f64::NAN, ..Settings::default() }, "max_stretch"),
        (Settings { max_iterations: 0, ..Settings::default() }, "max_iterations"),
        (Settings { tolerance: -1.0, ..Settings::default() }, "tolerance"),
    ];
    for (settings, name) in broken {
        let error = align(series(&clip, 3), series(&clip, 3), &settings).expect_err("out of range");
        assert!(error.to_string().contains(name), "{error}");
    }
}

#[test]
fn a_warp_applies_only_to_a_clip_of_its_target_length() {
    let clip = noise(10, 3, true, 1);
    let warp = align(series(&clip, 3), series(&clip, 3), &Settings::default()).expect("aligns");
    let error = warp.apply(series(&clip[..27], 3)).expect_err("another length");
    assert_eq!(error, AlignError::Frames { found: 9, expected: 10 });
    assert!(warp.fitted(series(&clip[..27], 3)).is_err());
}
