//! Packs with one or two numbers changed: what loads is shown, played, scored and exported in bounded time and memory.
//!
//! `KINESIC_CAMPAIGN=20000` packs; a few hundred otherwise.

#[path = "../../tests/tests/common/hostile.rs"]
mod hostile;

use std::path::Path;
use std::time::{Duration, Instant};

use hostile::Hostile;
use kinesic::model::{Field, ModelMeta};
use kinesic_host::clip::JointMap;
use kinesic_host::embed::rust_module;
use kinesic_host::emotion::evaluate::Scorer;
use kinesic_host::gait::{Manner, walk};
use kinesic_host::limit::HostLimiter;
use kinesic_host::mechanics::decouple;
use kinesic_host::pack::PackFile;
use kinesic_host::prepare::Source;
use kinesic_host::quantise::{to_int8, to_int16};
use kinesic_host::rig::Rig;
use kinesic_host::view::{View, ViewClip, ViewPack, WASM, page};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

/// Ends of plausible ranges and what is beyond them.
const NUMBERS: [f32; 20] = [
    0.0,
    -0.0,
    1e-30,
    0.01,
    0.5,
    1.0,
    -1.0,
    4.0,
    -4.0,
    12.0,
    59.0,
    200.0,
    1000.0,
    -1000.0,
    1e4,
    1e10,
    -1e10,
    f32::MAX,
    f32::INFINITY,
    f32::NAN,
];
const COUNTS: [u32; 8] = [0, 1, 2, 3, 64, 1 << 20, 1 << 31, u32::MAX];

/// How many f32 and u32 the metadata hold.
fn numbers(pack: &mut Hostile) -> [usize; 2] {
    let mut found = [1, 0];
    for model in &mut pack.models {
        model.fields(&mut |field| match field {
            Field::Count(_) => found[1] += 1,
            Field::Strength(_) => found[0] += 2,
            Field::Size(_) | Field::Gain(_) | Field::Own(_) => found[0] += 1,
        });
    }
    found
}

/// Changes the f32 at one place, the first being the frame rate, and the u32 at another.
fn put(pack: &mut Hostile, (at, to): (usize, f32), (count_at, count_to): (usize, u32)) {
    let (mut here, mut count_here) = (1, 0);
    if at == 0 {
        pack.frame_rate = to;
    }
    for model in &mut pack.models {
        model.fields(&mut |field| {
            let mut number_at = |x: &mut f32| {
                if here == at {
                    *x = to;
                }
                here += 1;
            };
            match field {
                Field::Count(count) => {
                    if count_here == count_at {
                        *count = count_to;
                    }
                    count_here += 1;
                }
                Field::Strength(range) => range.iter_mut().for_each(number_at),
                Field::Size(x) | Field::Gain(x) | Field::Own(x) => number_at(x),
            }
        });
    }
}

fn pick<T: Copy>(of: &[T], random: &mut ChaCha8Rng) -> T {
    of[random.random_range(0..of.len())]
}

/// Changes one number of the metadata, of a tensor, or the parent of a joint.
fn change(pack: &mut Hostile, random: &mut ChaCha8Rng) {
    let (number, count) = (pick(&NUMBERS, random), pick(&COUNTS, random));
    match random.random_range(0..8) {
        0..4 => {
            let [numbers, _] = numbers(pack);
            put(pack, (random.random_range(0..numbers), number), (usize::MAX, count));
        }
        4 => {
            let [_, counts] = numbers(pack);
            if counts > 0 {
                put(pack, (usize::MAX, number), (random.random_range(0..counts), count));
            }
        }
        5 if !pack.joints.is_empty() => {
            let at = random.random_range(0..pack.joints.len());
            pack.joints[at].1 = pick(&[None, Some(0), Some(1), Some(u16::MAX)], random);
        }
        _ => {
            let tensors = pack.f32_tensors();
            let name = pick(&tensors, random);
            let (all, place) = (random.random_bool(0.3), random.random::<u32>() as usize);
            pack.f32s(name, |numbers| match numbers.len() {
                0 => {}
                _ if all => numbers.fill(number),
                len => numbers[place % len] = number,
            });
        }
    }
}

/// What is shown beside the packs.
struct Shown {
    clip: ViewClip,
}

/// Everything that the host does with a pack. Refusals are welcome, panics are not.
fn use_everywhere(file: &PackFile, shown: &Shown) -> bool {
    let Ok(pack) = file.pack() else { return false };
    let models: Vec<ModelMeta> = pack.metadata().models.iter().collect();
    let provenance = file.provenance().unwrap();
    let _ = rust_module(file, "made.kin");
    // The page of a face makes 49 warps; those of a face that folds take more than this test's time on a busy machine.
    if models.iter().any(|m| m.face().is_some()) {
        return true;
    }
    let packs = || vec![ViewPack { name: "made".to_owned(), file: file.clone(), look: None }];
    let has = |such: fn(&ModelMeta) -> bool| models.iter().any(such);
    let mut view = View::default();
    if has(|m| m.emotion().is_some()) {
        view.emotions = packs();
    } else {
        (view.packs, view.clips) = (packs(), vec![shown.clip.clone()]);
    }
    let _ = page("title", "made", &view, WASM);
    let _ = to_int8(file, &provenance);
    let _ = to_int16(file, &provenance);
    let _ = HostLimiter::load(&pack).map(|limiter| limiter.recovery_frames());
    if let Ok(rig) = Rig::from_pack(&pack)
        && let Ok(clip) = shown.clip.source.on_rig(&rig, f64::from(pack.metadata().frame_rate))
    {
        let _ = decouple(&pack, &rig.poses(&clip));
        if let Ok(scorer) = Scorer::load(&pack) {
            let _ = scorer.read(&clip);
        }
    }
    true
}

#[test]
fn changed_packs_are_refused_or_used_in_bounded_time_and_memory() {
    let cases: u64 = std::env::var("KINESIC_CAMPAIGN").map_or(270, |cases| cases.parse().unwrap());
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/packs/v2");
    let mut files: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    let packs: Vec<Hostile> = files.iter().map(|path| Hostile::of(&PackFile::read(path).unwrap())).collect();
    let clip = walk(&Manner::NEUTRAL, 1.0, 60.0, 0.0, 1);
    let map = JointMap::detect(&clip.skeleton).unwrap();
    let source = Source::new("walk", clip, map);
    let shown = Shown { clip: ViewClip { name: "walk".to_owned(), source, target: None } };
    let (mut loaded, mut slowest) = (0, (Duration::ZERO, 0));
    for case in 0..cases {
        let mut random = ChaCha8Rng::seed_from_u64(case);
        let mut pack = packs[case as usize % packs.len()].clone();
        for _ in 0..random.random_range(1..3) {
            change(&mut pack, &mut random);
        }
        let begun = Instant::now();
        let file = PackFile::from_bytes(&pack.bytes());
        let used = std::panic::catch_unwind(|| use_everywhere(&file, &shown));
        let used = used.unwrap_or_else(|_| panic!("case {case}, {}", files[case as usize % packs.len()].display()));
        loaded += u64::from(used);
        slowest = slowest.max((begun.elapsed(), case));
        assert!(begun.elapsed() < Duration::from_secs(30), "case {case} took {:?}", begun.elapsed());
    }
    println!("{cases} packs, {loaded} of them loaded; the slowest took {slowest:?}");
    assert!(loaded > cases / 5 && loaded < cases);
    // Resident memory at most, of this process; of Linux alone.
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    if let Some(most) = status.lines().find_map(|line| line.strip_prefix("VmHWM:")) {
        let kilobytes: u64 = most.trim().trim_end_matches(" kB").parse().unwrap();
        println!("{kilobytes} kB");
        assert!(kilobytes < 600_000, "{most}");
    }
}
