//! What a translator's pack makes of its training clips at every strength that is tried, beside what these clips do.
//!
//! `cargo run --release -p kinesic-host --example plausible -- SOURCE TARGET PACK.kin`
use std::path::Path;

use kinesic_host::clip::ReadOptions;
use kinesic_host::feet::kept_step;
use kinesic_host::pack::PackFile;
use kinesic_host::plausible::Figures;
use kinesic_host::prepare::Source;
use kinesic_host::rig::Rig;
use kinesic_host::translate::{Settings, play};

fn main() {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let file = PackFile::read(Path::new(&args[2])).unwrap();
    let pack = file.pack().unwrap();
    let rig = Rig::from_pack(&pack).unwrap();
    let fps = f64::from(pack.metadata().frame_rate);
    let read = |path: &str| Source::read(Path::new(path), &ReadOptions::default()).unwrap().on_rig(&rig, fps).unwrap();
    let (source, target) = (read(&args[0]), read(&args[1]));
    let [a, b] = [&source, &target].map(|clip| Figures::of(&rig, std::iter::once(clip)));
    let seen = a.or(&b);
    println!("{} speed {:.1} jerk {:.1} stand {:?} | {:?} {:.1} {:?}", args[2], a.speed_m_s, a.jerk_m_s3, a.stand, b.speed_m_s, b.jerk_m_s3, b.stand);
    let mut settings = Settings::default();
    for quarter in -4..=12 {
        let strength = 0.25 * f64::from(quarter);
        settings.controls.strength = strength as f32;
        let styled = play(&pack, &rig, &source, &settings).unwrap();
        let f = Figures::of(&rig, std::iter::once(&styled));
        let stand = f.stand.unwrap_or_default();
        let was = seen.stand.unwrap_or_default();
        let step = kept_step((&source, &rig.map), (&styled, &rig.map)).map(|x| x.unwrap_or(f64::NAN));
        println!(
            "{strength:5.2} speed {:.2} jerk {:.2} outside {:5.1} reach {:+.3} slide {:5.1} ({:.1}) standing {:.2} step {:.2} {:.2}",
            f.speed_m_s / seen.speed_m_s,
            f.jerk_m_s3 / seen.jerk_m_s3,
            seen.outside(&rig, &styled).to_degrees(),
            stand.reach_m - was.reach_m,
            stand.slide_cm_s,
            stand.slide_cm_s / was.slide_cm_s,
            stand.standing_percent / was.standing_percent,
            step[0], step[1]
        );
    }
}
