//! Processor time and memory of a job.

use std::fs;
use std::io::{self, Write};
use std::path::Path;

/// Runs of a job; the first warms the caches and is not counted.
const RUNS: usize = 5;

/// Processor seconds of a call, measured five times, and the last result.
pub fn timed<T>(mut job: impl FnMut() -> T) -> (Vec<f64>, T) {
    let mut result = job();
    let seconds = (0..RUNS).map(|_| seconds_a_call(0.1, || result = job())).collect();
    (seconds, result)
}

/// Processor seconds of one call, over as many as take at least so long: the system counts in ticks of some milliseconds.
pub fn seconds_a_call(least: f64, mut work: impl FnMut()) -> f64 {
    let (begin, mut calls) = (processor_seconds(), 0);
    loop {
        work();
        calls += 1;
        let seconds = processor_seconds() - begin;
        if seconds > least {
            return seconds / f64::from(calls);
        }
    }
}

/// Processor time of all threads, s (Linux): does not depend on what else the machine does, except through its caches.
fn processor_seconds() -> f64 {
    let threads = fs::read_dir("/proc/self/task").expect("Linux keeps the time of a thread in /proc/self/task");
    let nanoseconds = |task: fs::DirEntry| -> Option<f64> {
        fs::read_to_string(task.path().join("schedstat")).ok()?.split_whitespace().next()?.parse().ok()
    };
    threads.flatten().filter_map(nanoseconds).sum::<f64>() * 1e-9
}

/// Most memory that the process ever held, MiB.
pub fn peak_mib() -> f64 {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    line.and_then(|line| line.split_whitespace().next()?.parse::<f64>().ok()).unwrap_or(f64::NAN) / 1024.0
}

/// Writes numbers for NumPy: raw, little-endian.
pub fn write<T: bytemuck::NoUninit>(folder: &Path, name: &str, values: &[T]) -> io::Result<()> {
    fs::create_dir_all(folder)?;
    fs::File::create(folder.join(name))?.write_all(bytemuck::cast_slice(values))
}
