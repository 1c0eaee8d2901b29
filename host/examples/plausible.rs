//! Which strengths of translators are plausible: by top speed alone, as it once was, and by playing; and what ends them.
//!
//! `cargo run --release -p kinesic-host --example plausible -- SOURCE TARGET PACK.kin [SOURCE TARGET PACK.kin ...]`

use std::path::Path;

use kinesic_host::clip::{Clip, ReadOptions};
use kinesic_host::pack::PackFile;
use kinesic_host::plausible::Figures;
use kinesic_host::prepare::Source;
use kinesic_host::rig::Rig;
use kinesic_host::translate::{Settings, plausible, play};

/// The fastest joint was allowed to be so many times faster.
const SPEED: f64 = 1.5;

fn main() {
    let args: Vec<String> = std::env::args().skip(1).collect();
    if args.is_empty() || !args.len().is_multiple_of(3) {
        stop(&"expected SOURCE TARGET PACK.kin, once or more");
    }
    println!("| pack | by top speed alone | by playing | what ends it |");
    println!("|---|---|---|---|");
    for row in args.chunks_exact(3) {
        let [source, target, path] = row else { continue };
        let file = PackFile::read(Path::new(path)).unwrap_or_else(|error| stop(&error));
        let pack = file.pack().unwrap_or_else(|error| stop(&error));
        let rig = Rig::from_pack(&pack).unwrap_or_else(|error| stop(&error));
        let fps = f64::from(pack.metadata().frame_rate);
        let read = |path: &String| -> Clip {
            let source = Source::read(Path::new(path), &ReadOptions::default()).unwrap_or_else(|error| stop(&error));
            source.on_rig(&rig, fps).unwrap_or_else(|error| stop(&error))
        };
        let (source, target) = (read(source), read(target));
        let speed = |clip: &Clip| Figures::of(&rig, std::iter::once(clip)).speed_m_s;
        let bound = SPEED * speed(&source).max(speed(&target));
        let slow = |quarters: &u8| {
            let mut settings = Settings::default();
            settings.controls.strength = 0.25 * f32::from(*quarters);
            speed(&play(&pack, &rig, &source, &settings).unwrap_or_else(|error| stop(&error))) <= bound
        };
        let before = (5..=12).take_while(slow).last().unwrap_or(4);
        let found = plausible(&pack, &rig, &[&source], &[&target]).unwrap_or_else(|error| stop(&error));
        let name = Path::new(path).file_stem().unwrap_or_default().to_string_lossy();
        let why = found.why().unwrap_or_else(|| "the largest that is tried".to_owned());
        println!("| {name} | {} | {} | {why} |", 0.25 * f64::from(before), found.largest);
    }
}

fn stop(error: &dyn std::fmt::Display) -> ! {
    eprintln!("{error}");
    std::process::exit(1);
}
