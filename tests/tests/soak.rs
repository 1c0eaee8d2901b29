//! A short soak of every engine; the long one is `cargo run --release -p kinesic-tests --example soak`.

#[path = "common/engines.rs"]
mod engines;
#[path = "common/robot.rs"]
mod robot;
#[path = "common/soak.rs"]
mod soak;

use engines::{ENGINES, Packs};

#[test]
fn every_engine_runs_on_with_the_same_bits() {
    let packs = Packs::new();
    for engine in ENGINES {
        let first = soak::soak(&packs, engine, 20_000, |_| {});
        assert!(first.worst_norm < 1e-5, "{engine}: {first:?}");
        assert_eq!((first.engine_faults, first.faulty_frames), (0, 0), "{engine}");
        assert_eq!(first, soak::soak(&packs, engine, 20_000, |_| {}), "{engine}: a second run");
    }
}
