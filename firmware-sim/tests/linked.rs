//! What a pipeline links: the engines that it names, and nearly nothing of its own.

mod common;

use common::Bench;
use kinesic_firmware_sim::workload::{prepare, styled};

/// Bytes of flash that `Pipeline`, guard and tuple may take beside the same engines called by hand.
const OWN: u64 = 2_048;

#[test]
fn a_pipeline_computes_what_its_engines_compute_by_hand() {
    let (pipeline, by_hand) = (prepare("styled", 100).unwrap(), styled::by_hand(100).unwrap());
    assert_eq!(pipeline.hashes, by_hand.hashes);
}

#[test]
#[ignore = "needs a compiler for the targets: ./ci.sh firmware runs it"]
fn engines_that_are_not_named_are_not_linked() {
    let bench = Bench::new();
    bench.pack(&prepare("styled", 1).unwrap());
    for target in ["m0plus", "m4f", "rv32imc"] {
        let pipeline = bench.build(target, "styled");
        let by_hand = bench.build(target, "by-hand");
        println!("{target}: flash of translator and limits {} B, by hand {} B", pipeline.flash, by_hand.flash);
        assert!(pipeline.flash <= by_hand.flash + OWN, "{target}: {} {}", pipeline.flash, by_hand.flash);
        for (symbol, _) in pipeline.largest() {
            let unused = ["mechanics::", "components::", "emotion::", "face::"]
                .into_iter()
                .find(|engine| symbol.contains(&format!("kinesic::{engine}")));
            assert_eq!(unused, None, "{target}: {symbol}");
        }
    }
}
