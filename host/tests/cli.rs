//! The command as a user meets it.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use kinesic_tests::{data, table};

fn kinesic(args: &[&str], folder: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_kinesic")).args(args).current_dir(folder).output().unwrap()
}

fn succeed(args: &[&str], folder: &Path) -> String {
    let output = kinesic(args, folder);
    assert!(output.status.success(), "{args:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// The demo's files in a folder of their own.
fn demo() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    succeed(&["demo", "--out", "."], folder.path());
    folder
}

fn number(json: &str, key: &str) -> f64 {
    let json: serde_json::Value = serde_json::from_str(json).unwrap();
    json[key].as_f64().unwrap_or_else(|| panic!("no {key} in {json}"))
}

#[test]
fn the_demo_is_better_than_the_baselines_and_its_files_open() {
    let folder = tempfile::tempdir().unwrap();
    let json = succeed(&["demo", "--json"], folder.path());
    assert!(number(&json, "error_cm") < number(&json, "affine_cm"));
    assert!(number(&json, "affine_cm") < number(&json, "identity_cm"));
    let demo = folder.path().join("kinesic-demo");
    for file in ["neutral.bvh", "weary.bvh", "unseen.bvh", "unseen-weary.bvh", "expected.bvh", "weary.kin"] {
        succeed(&["inspect", file], &demo);
    }
    // Without a subcommand the demo runs.
    let bare = tempfile::tempdir().unwrap();
    assert!(succeed(&[], bare.path()).contains("doing nothing"));
}

#[test]
fn the_same_command_gives_the_same_bytes() {
    let folder = demo();
    let train = ["train", "translate", "--pair", "neutral.bvh", "weary.bvh", "--out", "a.kin"];
    let read = || std::fs::read(folder.path().join("a.kin")).unwrap();
    succeed(&train, folder.path());
    let first = read();
    succeed(&train, folder.path());
    assert!(first == read());
}

#[test]
fn train_apply_and_eval_work_together() {
    let folder = demo();
    let at = folder.path();
    succeed(
        &[
            "train",
            "translate",
            "--pair",
            "neutral.bvh",
            "weary.bvh",
            "--form",
            "per-joint",
            "--order",
            "12",
            "--out",
            "a.kin",
        ],
        at,
    );
    let eval = succeed(&["eval", "translate", "a.kin", "--pair", "unseen.bvh", "expected.bvh", "--json"], at);
    for key in ["error_cm", "identity_cm", "offset_cm", "affine_cm"] {
        assert!(number(&eval, key) > 0.0);
    }
    assert!(number(&eval, "error_cm") < number(&eval, "identity_cm"));
    succeed(&["apply", "a.kin", "unseen.bvh", "--out", "kept.bvh"], at);
    let kept: serde_json::Value = serde_json::from_str(&succeed(&["inspect", "kept.bvh", "--json"], at)).unwrap();
    assert_eq!(kept["frames"], 360);
    // The weary manner is slower: its clip is longer.
    succeed(&["apply", "a.kin", "unseen.bvh", "--out", "timed.bvh", "--timing", "learned"], at);
    let timed: serde_json::Value = serde_json::from_str(&succeed(&["inspect", "timed.bvh", "--json"], at)).unwrap();
    assert!(timed["frames"].as_f64().unwrap() > 420.0, "{}", timed["frames"]);
    // Strength 0 writes the source.
    succeed(&["apply", "a.kin", "unseen.bvh", "--out", "same.bvh", "--strength", "0"], at);
    let same = succeed(&["eval", "translate", "a.kin", "--pair", "same.bvh", "unseen.bvh", "--json"], at);
    assert!(number(&same, "identity_cm") < 1e-3);
    succeed(&["apply", "a.kin", "unseen.bvh", "--out", "masked.bvh", "--mask", "*=0,Head=1,l_elbow=0.5"], at);
}

#[test]
fn bad_command_lines_are_refused_with_a_cause() {
    let folder = demo();
    let at = folder.path();
    std::fs::write(at.join("cut.bvh"), &std::fs::read(at.join("unseen.bvh")).unwrap()[..3000]).unwrap();
    std::fs::write(at.join("cut.kin"), &std::fs::read(at.join("weary.kin")).unwrap()[..3000]).unwrap();
    std::fs::write(at.join("text.kin"), "hello, this is no pack at all").unwrap();
    std::fs::write(at.join("pairs.tsv"), "neutral\tstyled\tstyle\nneutral.bvh\tweary.bvh\tsad\n").unwrap();
    std::fs::write(at.join("map.toml"), "[joints]\npelvis = \"Hip\"\n").unwrap();
    let cases: [(&[&str], &str); 17] = [
        (&["inspect", "nothing.bvh"], "no such file"),
        (&["inspect", "cut.bvh"], "line"),
        (&["inspect", "cut.kin"], "truncated"),
        (&["inspect", "text.kin"], "not a pack"),
        (&["inspect", "."], "folder"),
        (&["inspect", "unseen.bvh", "--map", "map.toml"], "Hip"),
        (&["apply", "weary.kin", "unseen.bvh", "--out", "out.txt"], ".bvh"),
        (&["apply", "weary.kin", "unseen.bvh", "--out", "no/such/out.bvh"], "does not exist"),
        (&["apply", "weary.kin", "unseen.bvh", "--out", "o.bvh", "--mask", "Tail=1"], "no such joint"),
        (&["apply", "weary.kin", "unseen.bvh", "--out", "o.bvh", "--mask", "Head=2"], "0 to 1"),
        (&["apply", "weary.kin", "unseen.bvh", "--out", "o.bvh", "--strength", "nan"], "number"),
        (&["apply", "unseen.bvh", "unseen.bvh", "--out", "o.bvh"], "not a pack"),
        (&["train", "translate", "--out", "o.kin"], "no pair"),
        (&["train", "translate", "--pairs", "pairs.tsv", "--where", "style=glad", "--out", "o.kin"], "no row"),
        (&["train", "translate", "--pairs", "pairs.tsv", "--where", "mood=sad", "--out", "o.kin"], "no column"),
        (&["train", "translate", "--pair", "neutral.bvh", "--out", "o.kin"], "2 values"),
        (&["train", "translate", "--pair", "neutral.bvh", "weary.bvh", "--out", "o.kin", "--fps", "-3"], "frame rate"),
    ];
    for (args, cause) in cases {
        let output = kinesic(args, at);
        // The report wraps lines: compare without white space.
        let squeeze = |text: &str| text.chars().filter(|c| !c.is_whitespace() && *c != '│').collect::<String>();
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(matches!(output.status.code(), Some(1 | 2)), "{args:?}: {:?} {message}", output.status);
        assert!(squeeze(&message).contains(&squeeze(cause)), "{args:?}: {message}");
    }
    for left in ["o.bvh", "o.kin", "out.txt"] {
        assert!(!at.join(left).exists(), "{left} was left behind");
    }
}

#[test]
fn help_has_examples() {
    let folder = tempfile::tempdir().unwrap();
    let commands: [&[&str]; 6] =
        [&[], &["demo"], &["inspect"], &["train", "translate"], &["apply"], &["eval", "translate"]];
    for command in commands {
        let help = succeed(&[command, &["--help"]].concat(), folder.path());
        assert!(help.contains("Examples:\n  kinesic "), "{help}");
    }
}

#[test]
fn every_clip_of_the_manifest_is_inspected() {
    let Some(folder) = data("every_clip_of_the_manifest_is_inspected") else { return };
    let files: Vec<PathBuf> = table(&folder.join("manifest.tsv")).iter().map(|row| folder.join(&row["file"])).collect();
    assert!(files.len() > 900);
    std::thread::scope(|scope| {
        for half in files.chunks(files.len().div_ceil(2)) {
            let folder = &folder;
            scope.spawn(move || {
                for file in half {
                    let text = succeed(&["inspect", &file.display().to_string()], folder);
                    assert!(text.contains("frames at"), "{text}");
                }
            });
        }
    });
}

#[test]
fn every_training_writes_a_report_beside_its_pack() {
    let folder = demo();
    let at = folder.path();
    let read = |name: &str| std::fs::read_to_string(at.join(name)).unwrap();
    succeed(&["train", "translate", "--pair", "neutral.bvh", "weary.bvh", "--out", "a.kin"], at);
    let page = read("a.report.html");
    for part in ["doing nothing", "<svg", "polyline", "Translator::&lt;", "neutral.bvh", "kinesic train translate"] {
        assert!(page.contains(part), "no {part} in the report of translate");
    }
    succeed(
        &["train", "components", "--content", "neutral.bvh", "--style", "weary.bvh", "-k", "8", "--out", "c.kin"],
        at,
    );
    for part in ["result to style clip", "<svg", "polyline", "weary.bvh"] {
        assert!(read("c.report.html").contains(part), "no {part} in the report of components");
    }
    let clips = ["neutral.bvh", "unseen.bvh", "expected.bvh"];
    let train = [
        "train",
        "mechanics",
        "--hidden",
        "8",
        "--epochs",
        "2",
        "--force",
        "--out",
        "m.kin",
        "--report",
        "page.html",
        "--clips",
    ];
    succeed(&[&train[..], &clips].concat(), at);
    for part in ["linear regression", "fine-tuning", "<svg", "polyline"] {
        assert!(read("page.html").contains(part), "no {part} in the report of mechanics");
    }
    // Pictures and styles are in the file: it opens from disk without a network.
    assert!(!page.contains("src=") && !page.contains("href="));
    succeed(&["train", "translate", "--pair", "neutral.bvh", "weary.bvh", "--no-report", "--out", "b.kin"], at);
    assert!(!at.join("b.report.html").exists());
    let refused = kinesic(
        &["train", "translate", "--pair", "neutral.bvh", "weary.bvh", "--report", "no/r.html", "--out", "b.kin"],
        at,
    );
    assert!(!refused.status.success() && String::from_utf8_lossy(&refused.stderr).contains("does not exist"));
}
