//! The whole way from the emulator to modelled cycles, against loops that were counted by hand.

mod common;

use common::Bench;
use kinesic_firmware_sim::elf::Image;
use kinesic_firmware_sim::emulator::Run;

const FRAMES: u32 = 7;

struct Counted {
    bench: Bench,
    target: &'static str,
    image: Image,
    run: Run,
}

impl Counted {
    fn new(target: &'static str) -> Self {
        let bench = Bench::new();
        let image = bench.build(target, "calibrate");
        let run = bench.run(target, "calibrate", &image, FRAMES).unwrap();
        assert_eq!(run.profile.frames.len(), FRAMES as usize);
        let [shortest, _, longest] = run.profile.spread();
        assert_eq!(shortest, longest, "a loop of fixed length costs the same every time");
        Self { bench, target, image, run }
    }

    /// Instructions and modelled cycles (low, middle, high) of one call of a function, without the functions it calls.
    fn of(&self, function: &str) -> (u64, [f64; 3]) {
        let target = self.bench.target(self.target);
        let timing = &self.bench.data.timings[&target.timing];
        let range = self.image.range(function).unwrap();
        let own = self.run.profile.instructions.range(range).map(|(address, one)| (*address, one.clone())).collect();
        let cycles = timing.price(target.isa, &own, |one| one.longest).unwrap();
        let executed = own.values().map(|one| one.longest.0).sum();
        let all: u64 = own.values().map(|one| one.all.0).sum();
        assert_eq!(all, executed * u64::from(FRAMES));
        (executed, [cycles.low, cycles.middle, cycles.high])
    }
}

/// Single-cycle arithmetic, loads and stores 2, lists 1 + N, taken branches 2, calls 3, returns 2, pop to pc 3 + N.
#[test]
#[ignore = "needs QEMU and a compiler for the targets: ./ci.sh firmware runs it"]
fn m0plus() {
    let counted = Counted::new("m0plus");
    let same = |cycles: f64| [cycles; 3];
    // 1 + 100 x 2 + (99 x 2 + 1) + 2
    assert_eq!(counted.of("loop_adds"), (302, same(402.0)));
    // 1 + 50 x 2 + (49 x 2 + 1) + 2
    assert_eq!(counted.of("loop_multiplies"), (152, same(202.0)));
    // 2 + 20 x (2 + 2 + 2 + 1 + 3 + 1) + (19 x 2 + 1) + 1 + 2
    assert_eq!(counted.of("loop_loads"), (144, same(264.0)));
    // 3 + 1 + 10 x (3 + 1) + (9 x 2 + 1) + 5
    assert_eq!(counted.of("loop_calls"), (33, same(68.0)));
    assert_eq!(counted.of("calibrate_leaf"), (10, same(20.0)));
}

/// P = 1, 2, 3 for each taken branch; the second load of a pair is pipelined; an FPU result used at once costs 0, 1, 1.
#[test]
#[ignore = "needs QEMU and a compiler for the targets: ./ci.sh firmware runs it"]
fn m4f() {
    let counted = Counted::new("m4f");
    // 1 + 100 x 3 + 99 P + 1 + P
    assert_eq!(counted.of("loop_adds"), (302, [402.0, 502.0, 602.0]));
    // 1 + 50 x 3 + 49 P + 1 + P
    assert_eq!(counted.of("loop_multiplies"), (152, [202.0, 252.0, 302.0]));
    // 2 + 20 x (2 + 1 + 1 + 1 + 3 + 1 + 1) + 19 P + 1 + 1 + P
    assert_eq!(counted.of("loop_loads"), (144, [224.0, 244.0, 264.0]));
    // 3 + 1 + 10 x (1 + P + 1 + 1) + 9 P + 3 + P
    assert_eq!(counted.of("loop_calls"), (33, [57.0, 77.0, 97.0]));
    assert_eq!(counted.of("calibrate_leaf"), (10, [20.0, 30.0, 40.0]));
    // 2 + 30 x (1 + stall + 1 + 3 + 1 + 5 + 1 + 1) + 29 P + 1 + 1 + P
    assert_eq!(counted.of("loop_floats"), (214, [424.0, 484.0, 514.0]));
}

/// Loads 1 and 1 more if used at once, taken branches 2, jumps 2.
#[test]
#[ignore = "needs QEMU and a compiler for the targets: ./ci.sh firmware runs it"]
fn rv32imc() {
    let counted = Counted::new("rv32imc");
    let same = |cycles: f64| [cycles; 3];
    assert_eq!(counted.of("loop_adds"), (302, same(402.0)));
    assert_eq!(counted.of("loop_multiplies"), (152, same(202.0)));
    // 2 + 20 x (1 + 2 + 1 + 1 + 1) + 19 + 1 + 2
    assert_eq!(counted.of("loop_loads"), (104, same(144.0)));
    // 3 + 10 x (2 + 1 + 1) + 9 + 1 + 1 + 2
    assert_eq!(counted.of("loop_calls"), (36, same(56.0)));
    assert_eq!(counted.of("calibrate_leaf"), (10, same(20.0)));
}

/// Where only a bracket is known, the hand count of the M4 table with P = 3 must lie in it or at its end.
#[test]
#[ignore = "needs QEMU and a compiler for the targets: ./ci.sh firmware runs it"]
fn brackets_hold_their_ends() {
    for target in ["m7", "m33", "m55"] {
        let counted = Counted::new(target);
        for (function, instructions) in [("loop_adds", 302), ("loop_loads", 144), ("loop_floats", 214)] {
            let (executed, [low, middle, high]) = counted.of(function);
            assert_eq!(executed, instructions, "{target} {function}");
            assert!(0.5 * executed as f64 <= low && low <= middle && middle <= high, "{target} {function}");
            assert!(high <= 3.0 * executed as f64, "{target} {function}: {high} is more than any table allows");
        }
    }
    // M33's high end is the M4 table: 1 + 100 x 3 + 99 x 3 + 1 + 3.
    assert_eq!(Counted::new("m33").of("loop_adds").1[2], 602.0);
}
