//! The cost never rises, the corridor finds what the full search finds, and the work stays linear.

mod align_common;

use align_common::{Gait, assert_never_rises, noise};
use kinesic_host::align::{Ends, Half, Search, Series, Settings, align, align_with};
use proptest::prelude::*;

fn series(data: &[f64], channels: usize) -> Series<'_> {
    Series::new(data, channels).expect("whole frames")
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 150, ..ProptestConfig::default() })]

    #[test]
    fn never_rises_on_random_data(
        n in 2usize..120, m in 2usize..120, channels in 1usize..9, seed: u64, walk: bool, open: bool, full: bool,
        standardise: bool, period in 1.0f64..500.0, radius in 1usize..40, stretch in 1.0f64..8.0, timing in 0.0f64..1.0,
    ) {
        let (u, v) = (noise(n, channels, walk, seed), noise(m, channels, walk, !seed));
        let smooth = kinesic_host::align::Smoothness::period(period);
        let settings = Settings {
            ends: if open { Ends::Open { max_fraction: 0.2 } } else { Ends::Closed },
            search: if full { Search::Full } else { Search::Corridor { radius } },
            scale: smooth,
            offset: smooth,
            standardise,
            max_stretch: stretch,
            timing,
            tolerance: 0.0,
            ..Settings::default()
        };
        let result = align(series(&u, channels), series(&v, channels), &settings);
        // Only lengths very far apart are refused.
        prop_assert!(result.is_ok() || n.max(m) as f64 * stretch > 60.0 * (n.min(m) - 1) as f64, "{result:?}");
        if let Ok(warp) = result {
            assert_never_rises(&warp);
            let path = warp.path();
            prop_assert!(path.windows(2).all(|w| w[1].1 == w[0].1 + 1 && w[1].0 >= w[0].0));
            prop_assert!(warp.target_on_source().windows(2).all(|w| w[1] >= w[0] - 1e-9));
            prop_assert!(warp.scale().iter().chain(warp.offset()).all(|x| x.is_finite()));
            if !open {
                prop_assert_eq!(path.first().copied(), Some((0, 0)));
                prop_assert_eq!(path.last().copied(), Some((n - 1, m - 1)));
            }
        }
    }
}

#[test]
fn corridor_reaches_the_energy_of_the_full_search() {
    for (seed, frames) in [(1u64, 900usize), (2, 1300), (3, 2000)] {
        let mut gait = Gait::new(24, seed);
        let u = gait.clip((0..frames).map(|t| t as f64), 0.2);
        let warp_of = |j: usize| j as f64 + 25.0 * (j as f64 / 90.0).sin();
        let mut v = gait.clip((0..frames).map(warp_of), 0.2);
        gait.style(&mut v);
        let total = |search| {
            let settings = Settings { search, ..Settings::default() };
            align(series(&u, 24), series(&v, 24), &settings).expect("aligns").energy().total()
        };
        let (full, corridor) = (total(Search::Full), total(Settings::default().search));
        assert!(corridor <= full * 1.001, "{frames} frames: corridor {corridor}, full search {full}");
    }
}

#[test]
fn work_grows_with_the_frames_not_with_their_square() {
    let work = |frames: usize| {
        let mut gait = Gait::new(60, 4);
        let u = gait.clip((0..frames).map(|t| t as f64), 0.1);
        let mut v = gait.clip((0..frames).map(|j| j as f64 + 20.0 * (j as f64 / 150.0).sin()), 0.1);
        gait.style(&mut v);
        let mut steps = Vec::new();
        let warp =
            align_with(series(&u, 60), series(&v, 60), &Settings::default(), |p| steps.push(*p)).expect("aligns");
        assert_eq!(steps, warp.history(), "the observer sees the history");
        assert!(steps.chunks(2).all(|s| s.len() == 2 && s[0].half == Half::Time && s[1].half == Half::Space));
        assert_never_rises(&warp);
        (warp.work().cells as usize, warp.work().searches as usize)
    };
    let (cells, searches) = work(4000);
    // A corridor of 32 frames on either side, with room for steep parts; the coarse search is 768^2 at most.
    assert!(cells < searches * 4000 * 100 + 768 * 768, "{cells} cells in {searches} searches");
    assert!(cells * 4 < searches * 4000 * 4000, "{cells}");
}
