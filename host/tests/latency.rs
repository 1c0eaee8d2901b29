//! What reports say about latency is what `docs/latency.md` says.

use kinesic_host::report::latency::{CORES, workloads};

#[test]
fn the_reports_latencies_are_those_of_the_page() {
    let page = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/latency.md")).unwrap();
    let mut compared = 0;
    for workload in ["translator", "mechanics", "components", "face", "emotion"].into_iter().flat_map(workloads) {
        for (core, microseconds) in CORES.iter().zip(workload.microseconds) {
            let begin = format!("| {} | {core} |", workload.name);
            let row = page.lines().find(|line| line.starts_with(&begin)).expect("a row of the table");
            let time = row.split('|').nth(5).unwrap().trim().replace(',', "");
            assert_eq!(time, microseconds.to_string(), "{row}");
            compared += 1;
        }
    }
    assert_eq!(compared, 48);
}
