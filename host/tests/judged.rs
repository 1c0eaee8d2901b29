//! What trainings and evaluations say of clips in which there is little to find: no figure is `NaN`, `inf` or minus zero, and what learned
//! nothing is refused.

use std::path::Path;
use std::process::Command;

use kinesic_host::clip::{Clip, WriteOptions};
use kinesic_host::emotion::synthetic;
use kinesic_host::gait::{Manner, walk};
use kinesic_host::models;
use kinesic_host::pack::Provenance;

/// A word that is no figure.
fn is_no_figure(word: &str) -> bool {
    let word = word.trim_matches(|c: char| !c.is_alphanumeric() && c != '-' && c != '.');
    let zero = |rest: &str| rest.contains('0') && rest.bytes().all(|byte| matches!(byte, b'0' | b'.'));
    ["nan", "inf", "-inf"].contains(&word.to_lowercase().as_str()) || word.strip_prefix('-').is_some_and(zero)
}

/// Runs a command line, without and with `--json`: it succeeds or is refused, and all that it says are figures. Gives its last exit code and all
/// that it said.
fn says(folder: &Path, line: &str) -> (i32, String) {
    let mut said = String::new();
    let mut code = 0;
    for more in ["", " --json"] {
        let line = format!("{line}{more}");
        let command =
            Command::new(env!("CARGO_BIN_EXE_kinesic")).args(line.split_whitespace()).current_dir(folder).output();
        let output = command.unwrap();
        code = output.status.code().unwrap();
        let text = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap()).concat();
        assert!(code == 0 || code == 1, "{line}: {code}: {text}");
        let wrong = text.split_whitespace().find(|word| is_no_figure(word));
        assert!(wrong.is_none(), "{line}: {wrong:?} in {text}");
        said += &text.split_whitespace().filter(|word| *word != "│").collect::<Vec<_>>().join(" ");
    }
    (code, said)
}

fn refused(folder: &Path, line: &str, why: &str) {
    let (code, said) = says(folder, line);
    assert!(code == 1 && said.contains(why), "{line}: {code}: {said}");
    let named =
        |out: &str| line.split_whitespace().skip_while(|word| *word != out).nth(1).map(|name| folder.join(name));
    if let Some(out) = named("--out") {
        assert!(!out.exists(), "{line} wrote {}", out.display());
    }
}

/// A walk, the same again, one frame of it for ever, and the walk with one frame that differs.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, clip: &Clip| {
        let text = clip.to_bvh(&WriteOptions::default()).unwrap();
        std::fs::write(folder.path().join(name), text).unwrap();
    };
    let plain = walk(&Manner::NEUTRAL, 2.5, 60.0, 0.0, 1);
    let mut still = plain.clone();
    let first = still.pose(0).to_vec();
    still.rotations = first.iter().cycle().take(still.rotations.len()).copied().collect();
    let place = still.root[0];
    still.root.fill(place);
    let mut near = plain.clone();
    near.root[40].y += 0.01;
    for (name, clip) in [("walk.bvh", &plain), ("same.bvh", &plain), ("still.bvh", &still), ("near.bvh", &near)] {
        write(name, clip);
    }
    write("weary.bvh", &walk(&Manner::WEARY, 2.5, 60.0, 0.0, 2));
    std::fs::write(folder.path().join("weary.kin"), models::weary().bytes()).unwrap();
    std::fs::write(folder.path().join("mechanics.kin"), models::mechanics().bytes()).unwrap();
    let (model, rig) = synthetic::model(2);
    std::fs::write(folder.path().join("moods.kin"), model.pack(&rig, &Provenance::default())).unwrap();
    folder
}

#[test]
fn a_training_that_learns_nothing_is_refused() {
    let folder = folder();
    let at = folder.path();
    refused(at, "train translate --pair walk.bvh same.bvh --out t.kin", "nothing to learn");
    refused(at, "train translate --pair still.bvh still.bvh --out t.kin", "nothing to learn");
    refused(at, "train components --content walk.bvh --style same.bvh -k 5 --out c.kin", "learned nothing");
    refused(at, "train components --content walk.bvh --style still.bvh -k 5 --out c.kin", "does not move");
    let nothing = "train components --content walk.bvh --style weary.bvh -k 5 --style-weight 0 --posture 0 --out c.kin";
    refused(at, nothing, "learned nothing");
    refused(at, "train mechanics --clips still.bvh --hidden 8 --feature-hidden 8 --epochs 2 --out m.kin", "--force");
    let (code, said) = says(at, "train translate --pair walk.bvh same.bvh --out t.kin --force");
    assert!(code == 0 && said.contains("note: the clips of the pairs are the same motion"), "{said}");
    let (code, said) = says(at, "train components --content walk.bvh --style same.bvh -k 5 --out c.kin --force");
    assert!(code == 0 && said.contains("note: "), "{said}");
}

#[test]
fn whatever_is_trained_or_measured_has_figures() {
    let folder = folder();
    let at = folder.path();
    for line in [
        "train translate --pair walk.bvh near.bvh --out near.kin --force",
        "train translate --pair walk.bvh still.bvh --out still.kin --force",
        "train translate --pair still.bvh walk.bvh --out moved.kin --force",
        "train components --content walk.bvh --style near.bvh -k 5 --out near-c.kin --force",
        "train mechanics --clips walk.bvh --hidden 8 --feature-hidden 8 --epochs 2 --hold-out 0 --out m.kin --force",
        "eval translate weary.kin --pair walk.bvh same.bvh",
        "eval translate weary.kin --pair still.bvh still.bvh",
        "eval translate near.kin --pair walk.bvh near.bvh",
        "eval components near-c.kin --target still.bvh",
        "eval components near-c.kin --target walk.bvh",
        "eval mechanics mechanics.kin --clips still.bvh",
        "eval mechanics mechanics.kin --clips still.bvh walk.bvh",
        "apply weary.kin still.bvh --out o.bvh",
        "apply weary.kin walk.bvh --strength 0 --out o.bvh",
        "apply near-c.kin --stored --strength 0 --out o.bvh",
        "score moods.kin walk.bvh still.bvh",
        "synth moods.kin --strength weary=0,swaying=-0 --out o.bvh",
        "inspect still.bvh",
        "inspect near.kin",
        "inspect near-c.kin",
    ] {
        says(at, line);
    }
    let pages = std::fs::read_dir(at).unwrap().map(|entry| entry.unwrap().path());
    let pages: Vec<_> = pages.filter(|path| path.to_string_lossy().ends_with(".report.html")).collect();
    assert!(pages.len() >= 4, "{pages:?}");
    for page in pages {
        let text = std::fs::read_to_string(&page).unwrap();
        let cells = text.split("<td>").skip(1).filter_map(|cell| cell.split("</td>").next());
        let wrong = cells.flat_map(str::split_whitespace).find(|word| is_no_figure(word));
        assert!(wrong.is_none() && !text.contains("NaN"), "{}: {wrong:?}", page.display());
    }
}

#[test]
fn labels_that_say_nothing_teach_nothing() {
    let folder = folder();
    let at = folder.path();
    let table = |name: &str, rows: &[(&str, &str)]| {
        let rows: String = rows.iter().map(|(file, label)| format!("{file}\t{label}\n")).collect();
        std::fs::write(at.join(name), format!("file\tlabel\n{rows}")).unwrap();
    };
    // One clip is all labels: whatever order is found is chance.
    table("one.tsv", &[("walk.bvh", "calm"), ("same.bvh", "weary"), ("near.bvh", "calm"), ("walk.bvh", "weary")]);
    let train =
        "train emotion --labels one.tsv --order weary>calm --hold-out 0 --keyframes 5 --components 4 --out e.kin";
    let (code, said) = says(at, train);
    assert!(code == 1 && !at.join("e.kin").exists(), "{said}");
    table("two.tsv", &[("walk.bvh", "calm"), ("same.bvh", "calm"), ("weary.bvh", "weary"), ("weary.bvh", "weary")]);
    let train = train.replace("one.tsv", "two.tsv");
    let (code, said) = says(at, &train);
    assert!(code == 0, "{said}");
    says(at, "eval emotion e.kin --labels two.tsv");
    table("alike.tsv", &[("walk.bvh", "calm"), ("still.bvh", "calm")]);
    says(at, "eval emotion e.kin --labels alike.tsv --order weary:weary>calm");
}
