//! The automatic proposal of non-expressive clips beside the labels of `manifest.tsv`, which it does not read.

mod mechanics_common;
mod real;

use kinesic_host::clip::ReadOptions;
use kinesic_host::mechanics::propose;
use kinesic_host::prepare::Source;

#[test]
fn proposes_most_plain_clips_and_hardly_an_expressive_one() {
    let Some(folder) = real::data("mechanics_propose") else { return };
    let manifest = std::fs::read_to_string(folder.join("manifest.tsv")).expect("manifest.tsv");
    let (mut right, mut wrong, mut missed, mut refused) = (0, 0, Vec::new(), 0);
    for row in manifest.lines().map(|line| line.split('\t').collect::<Vec<_>>()) {
        let plain = match row.get(8) {
            Some(&"body-mechanics") => true,
            Some(&"expressive") => false,
            _ => continue,
        };
        if !row[0].starts_with("cmu31/") {
            continue;
        }
        let source = Source::read(&folder.join(row[0]), &ReadOptions::default()).expect("a clip");
        let proposal = propose(&source.clip, &source.map).expect("a proposal");
        match (proposal.plain, plain) {
            (true, true) => right += 1,
            (true, false) => {
                wrong += 1;
                println!("proposed, labelled expressive: {} ({}) {proposal:?}", row[0], row[4]);
            }
            (false, true) => missed.push(format!("{} ({}) {proposal:?}", row[0], row[4])),
            (false, false) => refused += 1,
        }
    }
    for missed in &missed {
        println!("not proposed, labelled body mechanics: {missed}");
    }
    println!(
        "proposed {right} of {} plain clips and {wrong} of {} expressive ones",
        right + missed.len(),
        wrong + refused
    );
    assert!(right as f64 > 0.8 * (right + missed.len()) as f64);
    assert!(wrong * 10 < refused);
}
