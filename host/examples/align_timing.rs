//! Time and memory of the alignment on made, gait-like clips: `cargo run --release -p kinesic-host --example align_timing --
//! [frames] [channels] [iterations] [full]`.

use std::time::Instant;

use kinesic_host::align::{AlignError, Search, Series, Settings, align};

fn main() -> Result<(), AlignError> {
    let numbers: Vec<usize> = std::env::args().skip(1).filter_map(|a| a.parse().ok()).collect();
    let number = |k: usize, default: usize| numbers.get(k).copied().unwrap_or(default).max(2);
    let (frames, channels, iterations) = (number(0, 6000), number(1, 60), number(2, 10));
    let full = std::env::args().any(|a| a == "full");

    let warp_of = |t: f64| t + 12.0 * (t / 180.0).sin() + 5.0 * (t / 47.0).sin();
    let make = |clock: &dyn Fn(f64) -> f64, style: f64| -> Vec<f64> {
        let mut noise = style.to_bits() | 1;
        (0..frames * channels)
            .map(|x| {
                let (t, c) = (clock((x / channels) as f64), (x % channels) as f64);
                noise = noise.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                let random = (noise >> 40) as f64 / (1u64 << 24) as f64 - 0.5;
                let walk = (t / 10.3 + c).sin() + 0.4 * (t / 5.15 + 2.0 * c).cos() + 0.3 * (t / 301.0 + c * c).sin();
                walk * (1.0 + style * (c * 0.7).sin()) + style * c.cos() + 0.1 * random
            })
            .collect()
    };
    let (u, v) = (make(&|t| t, 0.0), make(&warp_of, 0.3));
    let settings = Settings {
        max_iterations: iterations,
        tolerance: 0.0,
        search: if full { Search::Full } else { Settings::default().search },
        ..Settings::default()
    };
    let (start, cpu) = (Instant::now(), cpu_seconds());
    let warp = align(Series::new(&u, channels)?, Series::new(&v, channels)?, &settings)?;
    let (seconds, cpu) = (start.elapsed().as_secs_f64(), cpu_seconds() - cpu);
    println!(
        "{frames} frames x {channels} channels, {} iterations: {seconds:.4} s, {cpu:.4} s of CPU, {:?}",
        warp.iterations(),
        warp.work()
    );
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    status.lines().filter(|l| l.starts_with("VmHWM")).for_each(|l| println!("peak memory {l}"));
    for step in warp.history() {
        println!("{:3} {:5} {:.6}", step.iteration, format!("{:?}", step.half), step.energy.total());
    }
    Ok(())
}

/// Time on a processor (Linux; zero elsewhere): does not depend on what else the machine does, except through its caches.
fn cpu_seconds() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/schedstat").unwrap_or_default();
    stat.split_whitespace().next().and_then(|ns| ns.parse::<f64>().ok()).unwrap_or(0.0) * 1e-9
}
