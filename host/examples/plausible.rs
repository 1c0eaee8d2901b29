//! What a translator's pack makes of its training source at every strength that is tried, beside what source and target do: the table of
//! docs/quality.md.
//!
//! `cargo run --release -p kinesic-host --example plausible -- SOURCE TARGET PACK.kin`
//!
//! Speed and jerk as multiples of the larger of source and target; how far the joint that leaves their rotations most is outside, as a share of what
//! it may be; how much farther the centre of mass is from the foot that stands, cm; how long feet stand, as a share; what breaks.

use std::path::Path;

use kinesic_host::clip::{Clip, ReadOptions};
use kinesic_host::pack::PackFile;
use kinesic_host::plausible::{Bounds, Figures};
use kinesic_host::prepare::Source;
use kinesic_host::rig::Rig;
use kinesic_host::translate::{Settings, play};

fn main() {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let [source, target, pack] = &args[..] else { stop(&"expected SOURCE TARGET PACK.kin") };
    let file = PackFile::read(Path::new(pack)).unwrap_or_else(|error| stop(&error));
    let pack = file.pack().unwrap_or_else(|error| stop(&error));
    let rig = Rig::from_pack(&pack).unwrap_or_else(|error| stop(&error));
    let fps = f64::from(pack.metadata().frame_rate);
    let read = |path: &String| -> Clip {
        let source = Source::read(Path::new(path), &ReadOptions::default()).unwrap_or_else(|error| stop(&error));
        source.on_rig(&rig, fps).unwrap_or_else(|error| stop(&error))
    };
    let (source, target) = (read(source), read(target));
    let of = |clip: &Clip| Figures::of(&rig, std::iter::once(clip));
    let seen = of(&source).or(of(&target));
    let bounds = Bounds::new(&rig, std::iter::once(&source), std::iter::once(&target));
    println!("| strength | speed | jerk | outside | leans, cm | stands | breaks |");
    println!("|---|---|---|---|---|---|---|");
    let mut settings = Settings::default();
    for quarter in 0..=12u8 {
        settings.controls.strength = 0.25 * f32::from(quarter);
        let styled = play(&pack, &rig, &source, &settings).unwrap_or_else(|error| stop(&error));
        let found = of(&styled);
        let (stand, stood) = (found.stand.unwrap_or_default(), seen.stand.unwrap_or_default());
        let breaks = bounds.broken(&rig, &[styled]).map_or_else(|| "-".to_owned(), |broken| format!("{broken:?}"));
        println!(
            "| {:.2} | {:.2} | {:.2} | {:.2} | {:+.1} | {:.2} | {breaks} |",
            settings.controls.strength,
            found.speed_m_s / seen.speed_m_s,
            found.jerk_m_s3 / seen.jerk_m_s3,
            seen.outside(&rig, &found),
            100.0 * (stand.reach_m - stood.reach_m),
            stand.standing_percent / stood.standing_percent
        );
    }
}

fn stop(error: &dyn std::fmt::Display) -> ! {
    eprintln!("{error}");
    std::process::exit(1);
}
