//! The README and the book: every command line runs as written, and every error message on the page is a real one.
//!
//! - ```` ```sh ````: commands that must succeed, line by line in one shell
//! - ```` ```console ```` with `$ ` lines: each command is run, and every line below it must be in what it prints (white space apart)
//!
//! Lines of `cargo`, `./ci.sh`, `alias` and the like are about a fresh clone; they are listed in [`ELSEWHERE`] with who runs them.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use kinesic::face::{Landmarks, POINTS};
use kinesic_host::face::{Face, TrainOptions, synthetic, train};
use kinesic_host::pack::Provenance;
use rand::SeedableRng;
use rand::rngs::ChaCha8Rng;

/// Starts of command lines that are not run here.
const ELSEWHERE: [&str; 5] = [
    // .ci/run runs these in a fresh clone, and the demo's command in `cli.rs`.
    "cargo run --release",
    "./ci.sh test",
    // The binary is on the path of the shell below.
    "cargo build --release",
    "alias kinesic=",
    // A comment.
    "#",
];

/// Clips of the reader's own, made of the demo's.
const OWN: [(&str, &str); 8] = [
    ("my-walk.bvh", "neutral.bvh"),
    ("my-tired-walk.bvh", "weary.bvh"),
    ("my-other-walk.bvh", "unseen.bvh"),
    ("my-other-tired-walk.bvh", "expected.bvh"),
    ("boxing.bvh", "unseen.bvh"),
    ("walk.bvh", "neutral.bvh"),
    ("signal.bvh", "unseen.bvh"),
    ("old.bvh", "weary.bvh"),
];

struct Block {
    kind: String,
    line: usize,
    lines: Vec<String>,
}

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The fenced blocks of a page.
fn blocks(page: &str) -> Vec<Block> {
    let mut blocks = Vec::new();
    let mut open: Option<Block> = None;
    for (index, line) in page.lines().enumerate() {
        match (line.strip_prefix("```"), open.as_mut()) {
            (Some(kind), None) => open = Some(Block { kind: kind.to_owned(), line: index + 1, lines: Vec::new() }),
            (Some(_), Some(_)) => blocks.extend(open.take()),
            (None, Some(block)) => block.lines.push(line.to_owned()),
            (None, None) => {}
        }
    }
    blocks
}

/// A folder as a new user has it, with clips of their own.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let made = shell(folder.path(), "kinesic demo --out made");
    assert!(made.status.success(), "{}", text(&made));
    for (own, made) in OWN {
        std::fs::rename(folder.path().join("made").join(made), folder.path().join(own))
            .or_else(|_| std::fs::copy(folder.path().join(twin(own)), folder.path().join(own)).map(drop))
            .unwrap();
    }
    std::fs::remove_dir_all(folder.path().join("made")).unwrap();
    face(folder.path());
    robot(folder.path());
    let (emotion, rig) = kinesic_host::emotion::synthetic::model(2);
    std::fs::write(folder.path().join("moods.kin"), emotion.pack(&rig, &Provenance::default())).unwrap();
    std::os::unix::fs::symlink(repository().join("models").canonicalize().unwrap(), folder.path().join("models"))
        .unwrap();
    folder
}

/// A table of two servos, and moves of them: calm and lively, and an idle one.
fn robot(folder: &Path) {
    let servo = |name: &str| format!("[[servo]]\nname = \"{name}\"\nunit = \"deg\"\nmin = -90\nmax = 90\n");
    std::fs::write(folder.join("desk.toml"), format!("name = \"desk\"\n{}{}", servo("pan"), servo("tilt"))).unwrap();
    for (name, size, late, phase) in [("calm", 15.0, 0.0, 0.0), ("lively", 22.0, 0.1, 0.0), ("idle", 15.0, 0.0, 1.0)] {
        let at = |t: f64, pace: f64| size * ((t - late + phase) * pace).sin() * ((t + phase) * 0.7).cos();
        let row = |frame: usize| {
            let t = frame as f64 / 50.0;
            format!("{t},{},{}\n", at(t, 2.1), at(t, 3.3))
        };
        let rows: String = (0..600).map(row).collect();
        std::fs::write(folder.join(format!("{name}.csv")), format!("time_s,pan_deg,tilt_deg\n{rows}")).unwrap();
    }
}

/// A table of labelled faces, `smile.kin` made of it, and a picture `me.jpg` with its landmarks.
fn face(folder: &Path) {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let faces = synthetic::faces(300, &mut random);
    let options = TrainOptions { clusters: 1, ..TrainOptions::default() };
    let trained = train(&faces, "smile", &options).unwrap();
    std::fs::write(folder.join("smile.kin"), trained.model.pack(&Provenance::default())).unwrap();
    let columns = (0..POINTS).map(|i| format!(",x{i},y{i}")).collect::<String>();
    let numbers = |landmarks: &Landmarks| landmarks.map(|[x, y]| format!(",{x},{y}")).concat();
    let row =
        |face: &Face| format!("{},{},{}{}\n", face.picture, face.person, face.label.unwrap(), numbers(&face.landmarks));
    let rows = faces.iter().map(row).collect::<String>();
    std::fs::write(folder.join("faces.csv"), format!("image,subject,smile{columns}\n{rows}")).unwrap();
    let me = synthetic::landmarks(0.4, 0.0, &mut random);
    synthetic::draw(&me, 250).save(folder.join("me.jpg")).unwrap();
    std::fs::write(folder.join("me.csv"), format!("image{columns}\nme.jpg{}\n", numbers(&me))).unwrap();
}

/// The first name under which a clip of the demo was kept.
fn twin(own: &str) -> &'static str {
    let made = OWN.iter().find(|(name, _)| *name == own).map(|(_, made)| *made);
    OWN.iter().find(|(_, other)| Some(*other) == made).map_or("", |(name, _)| name)
}

fn shell(folder: &Path, script: &str) -> Output {
    let binary = Path::new(env!("CARGO_BIN_EXE_kinesic")).parent().unwrap();
    let path = format!("{}:{}", binary.display(), std::env::var("PATH").unwrap_or_default());
    Command::new("sh").arg("-c").arg(script).current_dir(folder).env("PATH", path).output().unwrap()
}

fn text(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr)
}

/// Reports wrap lines and draw bars: compare without them.
fn squeezed(text: &str) -> String {
    text.chars().filter(|c| !c.is_whitespace() && *c != '│').collect()
}

/// Runs a page; returns how many commands ran, and how many messages were compared.
fn run(page: &str) -> [usize; 2] {
    run_in(&folder(), page)
}

/// The same in a folder that is still there afterwards.
fn run_in(folder: &tempfile::TempDir, page: &str) -> [usize; 2] {
    let source = std::fs::read_to_string(repository().join(page)).unwrap();
    let (mut at, mut ran, mut compared) = (folder.path().to_owned(), 0, 0);
    for block in blocks(&source) {
        let place = format!("{page}, line {}", block.line);
        if block.kind == "sh" {
            let commands: Vec<&str> = block
                .lines
                .iter()
                .map(String::as_str)
                .filter(|line| !line.trim().is_empty() && !ELSEWHERE.iter().any(|start| line.trim().starts_with(start)))
                .collect();
            if commands.is_empty() {
                continue;
            }
            // One shell for the block, so that `cd` and here-documents work; it tells where it ends up.
            let output = shell(&at, &format!("set -e\n{}\npwd > {}/pwd", commands.join("\n"), folder.path().display()));
            assert!(output.status.success(), "{place}: {}", text(&output));
            at = PathBuf::from(std::fs::read_to_string(folder.path().join("pwd")).unwrap().trim());
            ran += commands.iter().filter(|command| command.starts_with("kinesic ")).count();
        }
        if block.kind == "console" && block.lines.iter().any(|line| line.starts_with("$ ")) {
            let mut printed = String::new();
            for line in &block.lines {
                if let Some(command) = line.strip_prefix("$ ") {
                    let output = shell(&at, command);
                    assert_ne!(output.status.code(), Some(101), "{place}: {command} panicked");
                    printed = squeezed(&text(&output));
                    ran += 1;
                } else {
                    assert!(printed.contains(&squeezed(line)), "{place}: no '{line}' in: {printed}");
                    compared += 1;
                }
            }
        }
    }
    [ran, compared]
}

#[test]
fn the_readme_runs_as_written() {
    let [ran, _] = run("README.md");
    assert!(ran >= 10, "{ran} commands");
}

#[test]
fn the_book_runs_as_written() {
    let pages = [
        "tour",
        "your-clips",
        "your-skeleton",
        "model-size",
        "edit",
        "export",
        "view",
        "precision",
        "moves",
        "player",
        "reachy-mini",
        "retarget",
        "body-limits",
    ];
    for page in pages {
        let [ran, _] = run(&format!("docs/{page}.md"));
        assert!(ran >= 2, "{page}: {ran} commands");
    }
}

#[test]
fn the_firmware_of_the_desk_robot_has_what_its_page_makes() {
    let folder = folder();
    let [ran, _] = run_in(&folder, "docs/robot.md");
    assert!(ran >= 6, "{ran} commands");
    for name in ["lively.kin", "calm.rs"] {
        let made = std::fs::read(folder.path().join(name)).unwrap();
        let kept = std::fs::read(repository().join("docs/board/examples/desk").join(name)).unwrap();
        assert!(
            same(&made, &kept),
            "docs/board/examples/desk/{name} is not what docs/robot.md makes: copy it from there"
        );
    }
}

/// The same files but for the last bits of a training's numbers, which depend on the processor, and the checksum of a pack over them.
fn same(a: &[u8], b: &[u8]) -> bool {
    const CHECKSUM: usize = 16;
    let words = |bytes: &[u8]| bytes.chunks_exact(4).map(|word| word.try_into().unwrap()).collect::<Vec<[u8; 4]>>();
    let near = |(at, (a, b)): (usize, (&[u8; 4], &[u8; 4]))| {
        a == b || 4 * at == CHECKSUM || (f32::from_le_bytes(*a) - f32::from_le_bytes(*b)).abs() < 1e-6
    };
    let (first, second) = (words(a), words(b));
    let rest = |bytes: &[u8]| bytes.chunks_exact(4).remainder().to_vec();
    a.len() == b.len() && rest(a) == rest(b) && first.iter().zip(&second).enumerate().all(near)
}

#[test]
fn every_message_of_the_troubleshooting_page_is_real() {
    let [ran, compared] = run("docs/troubleshooting.md");
    assert!(ran >= 20 && compared >= 20, "{ran} commands, {compared} messages");
}

#[test]
fn the_book_has_every_page() {
    let summary = std::fs::read_to_string(repository().join("docs/SUMMARY.md")).unwrap();
    for entry in std::fs::read_dir(repository().join("docs")).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        if name.ends_with(".md") && name != "SUMMARY.md" {
            assert!(summary.contains(&format!("({name})")), "docs/SUMMARY.md lacks {name}");
        }
    }
}
