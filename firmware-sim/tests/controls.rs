//! Negative controls: what `check` promises to catch, it catches.

mod common;

use common::Bench;
use kinesic_firmware_sim::emulator::RunError;

const ALL: [&str; 6] = ["m0plus", "m4f", "m7", "m33", "m55", "rv32imc"];

fn reason(result: Result<kinesic_firmware_sim::emulator::Run, RunError>) -> String {
    match result {
        Err(RunError::Stopped { reason, .. }) => reason,
        Err(other) => panic!("stopped for another reason: {other}"),
        Ok(_) => panic!("the run passed"),
    }
}

#[test]
#[ignore = "needs QEMU and a compiler for the targets: ./ci.sh firmware runs it"]
fn a_panic_is_seen_in_the_symbols_and_in_the_run() {
    let bench = Bench::new();
    for target in ALL {
        let image = bench.build(target, "control-panic");
        let forbidden = image.forbidden();
        assert!(forbidden.iter().any(|symbol| symbol.contains("panic")), "{target}: {forbidden:?}");
        assert_eq!(reason(bench.run(target, "control-panic", &image, 4)), "panicked", "{target}");
    }
}

#[test]
#[ignore = "needs QEMU and a compiler for the targets: ./ci.sh firmware runs it"]
fn a_scratch_buffer_is_seen_in_the_painted_stack() {
    let bench = Bench::new();
    for target in ALL {
        let image = bench.build(target, "control-stack");
        assert!(image.forbidden().is_empty(), "{target}: only the stack is wrong here");
        let run = bench.run(target, "control-stack", &image, 3).unwrap();
        assert!((16 * 1024..40 * 1024).contains(&run.stack_frames), "{target}: {}", run.stack_frames);
        assert!(run.stack_start_up < 1024, "{target}: {}", run.stack_start_up);
    }
}

#[test]
#[ignore = "needs QEMU and a compiler for the targets: ./ci.sh firmware runs it"]
fn a_stack_that_runs_out_of_ram_fails_the_run() {
    let bench = Bench::new();
    for target in ALL {
        let image = bench.build(target, "control-overflow");
        let result = bench.run(target, "control-overflow", &image, 1);
        assert!(matches!(result, Err(RunError::Stopped { .. })), "{target}: {result:?}");
    }
}
