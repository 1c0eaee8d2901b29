//! Damaged files of motions are refused or used, in bounded memory.

use std::path::Path;

use kinesic_host::moves::{Options, is_moves, parse, read};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

const ANGLES: &str = "frame,time_s,Hips_x_m,Hips_y_m,Hips_z_m,Hips_z_deg,Hips_x_deg,Hips_y_deg\n0,0.000000,0.1,0.9,0.0,1.0,2.0,3.0\n\
                      1,0.016667,0.1,0.9,0.01,1.5,2.5,3.5\n2,0.033333,0.1,0.9,0.02,2.0,3.0,4.0\n";
const ROS: &str = "time_from_start,pan,tilt\n0,0.1,0.2\n0.5,0.2,0.3\n";
const LINES: &str = "{\"timestamp\": 0.0, \"frame_index\": 0, \"episode_index\": 3, \"action\": [1.0, 2.0], \"task\": \"wave\"}\n\
                     {\"timestamp\": 0.1, \"frame_index\": 1, \"episode_index\": 3, \"action\": [1.5, 2.5], \"task\": \"wave\"}\n";

/// Small files of every format.
fn examples() -> Vec<(&'static str, String)> {
    let reachy = "{\"description\": \"a nod\",\n\"time\": [0, 0.01], \"set_target_data\": [\n\
        {\"head\": [[1,0,0,0.01],[0,1,0,0],[0,0,1,0.02],[0,0,0,1]], \"antennas\": [0.1, -0.2], \"body_yaw\": 0.5, \"check_collision\": false},\n\
        {\"head\": [[0.6,-0.8,0,0],[0.8,0.6,0,0],[0,0,1,0],[0,0,0,1]], \"antennas\": [0.2, -0.3], \"body_yaw\": 0.25}]}";
    let yaml = "header: {frame_id: base}\njoint_names: [pan, 'tilt']\npoints:\n- positions: [0.1, 2e-1]\n  velocities: []\n  \
        time_from_start: {sec: 0, nanosec: 0}\n- positions:\n  - .5\n  - 1\n  time_from_start:\n    secs: 1\n    nsecs: 5\n---\n";
    [
        ("a.csv", ANGLES),
        ("b.csv", ROS),
        ("c.csv", "# by hand\nt;pan_deg;eyes\n0;1,5;\"a\"\"b\"\n0,02;2;x\n"),
        ("d.csv", "timestamp,action,episode_index\n0,\"[1, 2]\",0\n0.1,[1.5 2.5],0\n"),
        ("e.jsonl", LINES),
        ("f.json", "{\"unit\": \"deg\", \"fps\": 50, \"joints\": {\"pan\": [1, 2], \"t\\u00e9\": [3, 4e0]}, \"x\": [{\"a\": null}]}"),
        ("g.json", "{\"joint_names\": [\"a\", \"b_m\"], \"times\": [0, 1], \"frames\": [[1, 2], [3, 4]]}"),
        ("h.json", "[{\"time\": 0, \"pan_deg\": 1, \"led\": \"red\"}, {\"time\": 0.1, \"pan_deg\": 2}]"),
        ("i.json", reachy),
        ("j.yaml", yaml),
    ]
    .map(|(name, text)| (name, text.to_owned()))
    .to_vec()
}

/// Flips, cuts and inserts bytes.
fn damaged(text: &str, random: &mut ChaCha8Rng) -> Vec<u8> {
    let mut bytes = text.as_bytes().to_vec();
    for _ in 0..random.random_range(1..5) {
        let at = random.random_range(0..bytes.len().max(1)).min(bytes.len());
        let signs = b"0,;[{\"\n-e.:#'&*|>\\]}\t\xff\x00";
        match random.random_range(0..5) {
            0 if at < bytes.len() => bytes[at] ^= 1 << random.random_range(0..8),
            1 => bytes.truncate(at),
            2 => bytes.insert(at, signs[random.random_range(0..signs.len())]),
            3 => drop(bytes.drain(at..(at + random.random_range(1..9)).min(bytes.len()))),
            _ => {
                let piece = bytes[at..(at + 12).min(bytes.len())].to_vec();
                bytes.splice(at..at, piece);
            }
        }
    }
    bytes
}

#[test]
fn damaged_files_are_refused_or_used() {
    let mut random = ChaCha8Rng::seed_from_u64(9);
    let mut used = 0;
    for (name, text) in examples() {
        parse(text.as_bytes(), Path::new(name), &Options::default()).unwrap_or_else(|error| panic!("{name}: {error}"));
        for _ in 0..2000 {
            let bytes = damaged(&text, &mut random);
            let _ = is_moves(Path::new(name), &bytes);
            let Ok(moves) = parse(&bytes, Path::new(name), &Options { rate: Some(50.0), episode: None }) else {
                continue;
            };
            used += 1;
            assert!(moves.times.windows(2).all(|pair| pair[0] < pair[1]) && moves.times[0] == 0.0);
            assert!(
                moves.values.iter().all(|x| x.is_finite())
                    && moves.values.len() == moves.frames() * moves.channels.len()
            );
            assert!(moves.values.len() <= bytes.len() && moves.extra.rows.len() <= bytes.len());
            let _ = (moves.summary(), moves.to_csv(), moves.resample(30.0));
            // What was taken is written, and taken again.
            let extension = if name.ends_with("json") { "json" } else { "csv" };
            let folder = std::env::temp_dir();
            if used % 50 == 0 {
                let path = folder.join(format!("kinesic-moves-{}.{extension}", std::process::id()));
                moves.write(&path).unwrap();
                let _ = read(&path, &Options { rate: Some(50.0), episode: None });
                std::fs::remove_file(path).unwrap();
            }
        }
    }
    assert!(used > 1000, "{used}");
}

#[test]
fn small_files_do_not_stand_for_much() {
    let deep = "[".repeat(100_000);
    assert!(parse(deep.as_bytes(), Path::new("a.json"), &Options::default()).unwrap_err().to_string().contains("64"));
    let keys: String = (0..5000).map(|i| format!("{{\"t\":{i},\"a\":1,\"k{i}\":\"\"}}\n")).collect();
    let error = parse(keys.as_bytes(), Path::new("a.jsonl"), &Options::default()).unwrap_err().to_string();
    assert!(error.contains("differ from frame to frame") && error.contains("line "), "{error}");
    let objects = format!("{{\"fps\":50,\"joints\":{{\"a\":[1,2]}},\"x\":[{}1]}}", "{\"a\":1},".repeat(100_000));
    assert!(
        parse(objects.as_bytes(), Path::new("a.json"), &Options::default())
            .unwrap_err()
            .to_string()
            .contains("objects")
    );
    let deep = format!("joint_names: {}", "[".repeat(50_000));
    assert!(parse(deep.as_bytes(), Path::new("a.yaml"), &Options::default()).is_err());
}
