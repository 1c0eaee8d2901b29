//! Real clips: adults and children doing the same things (`KINESIC_DATA`).

mod align_common;

use std::path::Path;

use align_common::assert_never_rises;
use kinesic_host::align::{Ends, Search, Series, Settings, align};
use kinesic_tests::data;

/// Positions of a Kinect clip about the centre of the hips; frames as recorded.
fn kinect(path: &Path) -> Vec<f64> {
    let text = std::fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let mut out = Vec::new();
    for line in text.lines().skip(1) {
        let row: Vec<f64> = line.split(',').skip(1).take(60).map_while(|v| v.trim().parse().ok()).collect();
        if row.len() == 60 {
            out.extend(row.iter().enumerate().map(|(k, v)| v - row[k % 3]));
        }
    }
    out
}

#[test]
fn adults_and_children() {
    let Some(folder) = data("adults_and_children") else { return };
    let pairs = std::fs::read_to_string(folder.join("pairs.tsv")).expect("pairs.tsv");
    let mut count = 0;
    for line in pairs.lines() {
        let columns: Vec<&str> = line.split('\t').collect();
        let [_, neutral, styled, content, "child", ..] = columns[..] else {
            continue;
        };
        if !neutral.starts_with("kindergator") || count == 24 {
            continue;
        }
        let (u, v) = (kinect(&folder.join(neutral)), kinect(&folder.join(styled)));
        let (u, v) = (Series::new(&u, 60).expect("frames"), Series::new(&v, 60).expect("frames"));
        let run = |ends, search| {
            let settings = Settings { ends, search, ..Settings::default() };
            align(u, v, &settings).unwrap_or_else(|e| panic!("{content}: {e}"))
        };
        for ends in [Ends::Closed, Ends::Open { max_fraction: 0.2 }] {
            let full = run(ends, Search::Full);
            let corridor = run(ends, Settings::default().search);
            assert_never_rises(&full);
            assert_never_rises(&corridor);
            let (a, b) = (corridor.energy().total(), full.energy().total());
            println!(
                "{content} {ends:?}: full {b:.3}, corridor {a:.3}, iterations {} {}",
                full.iterations(),
                corridor.iterations()
            );
            assert!(a <= b * 1.001, "{content}: corridor {a}, full search {b}");
        }
        count += 1;
    }
    assert!(count >= 6, "only {count} pairs found");
}

#[test]
fn a_long_session_through_the_coarse_start() {
    // All actions of one adult and one child one after the other: long enough to start at a reduced frame rate.
    let Some(folder) = data("a_long_session_through_the_coarse_start") else { return };
    let pairs = std::fs::read_to_string(folder.join("pairs.tsv")).expect("pairs.tsv");
    let (mut u, mut v) = (Vec::new(), Vec::new());
    for line in pairs.lines().filter(|l| l.contains("kindergator/adult/p565_") && l.contains("child/p103_")) {
        let columns: Vec<&str> = line.split('\t').collect();
        u.extend(kinect(&folder.join(columns[1])));
        v.extend(kinect(&folder.join(columns[2])));
    }
    assert!(u.len() > 60 * 1000, "{} frames", u.len() / 60);
    let (u, v) = (Series::new(&u, 60).expect("frames"), Series::new(&v, 60).expect("frames"));
    let run = |search| {
        let settings = Settings { search, ..Settings::default() };
        let warp = align(u, v, &settings).expect("aligns");
        assert_never_rises(&warp);
        println!("{} to {} frames: {:.3}, {:?}", u.frames(), v.frames(), warp.energy().total(), warp.work());
        warp.energy().total()
    };
    let (full, corridor) = (run(Search::Full), run(Settings::default().search));
    assert!(corridor <= full * 1.001, "corridor {corridor}, full search {full}");
}
