//! Files of others: packs with hostile numbers and names, clips and robots without measure. Every command refuses them or stays
//! bounded in time and memory, and no name is a command to a terminal or a page.
#![cfg(unix)]

#[path = "../../tests/tests/common/hostile.rs"]
mod hostile;

use std::path::Path;
use std::process::{Command, Output};

use hostile::Hostile;
use kinesic::model::ModelMeta;
use kinesic_host::clip::WriteOptions;
use kinesic_host::emotion;
use kinesic_host::face::{TrainOptions, synthetic, train};
use kinesic_host::gait::{Manner, walk};
use kinesic_host::limit::{JointLimit, LimitsModel};
use kinesic_host::models;
use kinesic_host::pack::{PackFile, Provenance};
use kinesic_host::rig::Rig;
use rand::SeedableRng;
use rand::rngs::ChaCha8Rng;

const KINESIC: &str = env!("CARGO_BIN_EXE_kinesic");

/// A command line, with 20 s and 2 GB.
fn run(folder: &Path, line: &str) -> Output {
    let script = format!("ulimit -v 2000000; exec timeout 20 \"$0\" {line}");
    Command::new("sh").args(["-c", &script, KINESIC]).current_dir(folder).output().unwrap()
}

/// The message of a command that is refused in time and without a panic.
fn refused(folder: &Path, line: &str) -> String {
    let output = run(folder, line);
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{line}: {message}");
    // As one line: messages are wrapped.
    message.split_whitespace().filter(|word| *word != "│").collect::<Vec<_>>().join(" ")
}

fn succeed(folder: &Path, line: &str) -> String {
    let output = run(folder, line);
    assert!(output.status.success(), "{line}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

fn bvh(seconds: f64) -> String {
    walk(&Manner::NEUTRAL, seconds, 60.0, 0.0, 1).to_bvh(&WriteOptions::default()).unwrap()
}

/// A folder with a walk, its frames ten seconds apart, and the packs of the program.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, bytes: &[u8]| std::fs::write(folder.path().join(name), bytes).unwrap();
    write("walk.bvh", bvh(2.0).as_bytes());
    write("weary.kin", models::weary().bytes());
    write("mechanics.kin", models::mechanics().bytes());
    folder
}

fn write(folder: &Path, name: &str, pack: &Hostile) {
    std::fs::write(folder.join(name), pack.bytes()).unwrap();
}

fn emotions() -> PackFile {
    let (model, rig) = emotion::synthetic::model(1);
    PackFile::from_bytes(&model.pack(&rig, &Provenance::default()))
}

fn limits() -> PackFile {
    let file = models::weary();
    let rig = Rig::from_pack(&file.pack().unwrap()).unwrap();
    let mut limits = LimitsModel::free("arm", 60.0, &rig, 6.0, 60.0);
    limits.joints[2] = JointLimit::hinge([1.0, 0.0, 0.0], [-0.1, 2.3], 9.0, 110.0);
    PackFile::from_bytes(&limits.pack(&rig, &Provenance::default()).unwrap())
}

#[test]
fn a_root_that_is_its_own_parent_is_refused_by_every_command() {
    let folder = folder();
    let at = folder.path();
    for (name, file) in [("w.kin", models::weary()), ("m.kin", models::mechanics()), ("e.kin", emotions())] {
        let mut pack = Hostile::of(&file);
        pack.joints[0].1 = Some(0);
        write(at, name, &pack);
    }
    std::fs::write(at.join("arm.urdf"), "<robot/>").unwrap();
    for line in [
        "apply w.kin walk.bvh --out o.bvh",
        "view w.kin walk.bvh --out o.html",
        "view e.kin --out o.html",
        "eval translate w.kin --pair walk.bvh walk.bvh",
        "eval mechanics m.kin --clips walk.bvh",
        "modulate m.kin walk.bvh --amount 2 --out o.bvh",
        "decouple m.kin walk.bvh --mechanics o.bvh",
        "mix m.kin --mechanics walk.bvh --expressive walk.bvh --out o.bvh",
        "blend m.kin walk.bvh walk.bvh --mechanics-window 0..1 --expressive-window 0..1 --out o.bvh",
        "score e.kin walk.bvh",
        "synth e.kin --strength 1 --out o.bvh",
        "quantize w.kin --clips walk.bvh --out o.kin",
        "inspect w.kin",
        "export --rust w.kin --out o.rs",
        "limits w.kin",
    ] {
        let message = refused(at, line);
        assert!(message.contains("out of range: parent of a joint"), "{line}: {message}");
    }
    // The map is read before the pack.
    std::fs::write(at.join("arm.toml"), "acceleration = 20.0\n[joints]\nl_elbow = \"elbow\"\n").unwrap();
    let robot = "<robot name='a'><link name='b'/><link name='c'/><joint name='elbow' type='revolute'><parent link='b'/>\
                 <child link='c'/><limit lower='0' upper='1' velocity='5'/></joint></robot>";
    std::fs::write(at.join("arm.urdf"), robot).unwrap();
    for with in ["--with", "--skeleton"] {
        let message = refused(at, &format!("limits arm.urdf --map arm.toml {with} w.kin --out o.kin"));
        assert!(message.contains("out of range: parent of a joint"), "{with}: {message}");
    }
}

#[test]
fn frame_rates_and_clocks_that_would_fill_the_memory_are_refused() {
    let folder = folder();
    let at = folder.path();
    let mut pack = Hostile::of(&models::weary());
    pack.frame_rate = 9999.0;
    write(at, "rate.kin", &pack);
    let mut pack = Hostile::of(&emotions());
    pack.frame_rate = 1e6;
    write(at, "rate-e.kin", &pack);
    let walked = bvh(60.0);
    let frame_time = walked.lines().find(|line| line.starts_with("Frame Time")).unwrap();
    let slow = |frames: usize| {
        let (head, rows) = walked.split_once(frame_time).unwrap();
        let head = head.replace("Frames: 3600", &format!("Frames: {frames}"));
        let rows: Vec<&str> = rows.lines().skip(1).take(frames).collect();
        format!("{head}Frame Time: 10\n{}\n", rows.join("\n"))
    };
    std::fs::write(at.join("ft10-50.bvh"), slow(50)).unwrap();
    std::fs::write(at.join("ft10-800.bvh"), slow(800)).unwrap();
    for line in [
        "apply rate.kin ft10-50.bvh --out o.bvh",
        "eval translate rate.kin --pair walk.bvh walk.bvh",
        "view rate-e.kin --out o.html",
        "synth rate-e.kin --strength 1 --out o.bvh",
    ] {
        let message = refused(at, line);
        assert!(message.contains("frame rate, expected 1 to 1000"), "{line}: {message}");
    }
    let message = refused(at, "apply weary.kin ft10-800.bvh --out o.bvh");
    assert!(message.contains("ft10-800.bvh: at 60 frames per second its 7990 s take"), "{message}");
    assert!(message.contains("MB of memory, at most 20") && message.contains("800 frames"), "{message}");
    for (at_end, value) in [(2, 1e5), (1, -1e10), (2, 20.0), (2, 12.0)] {
        let mut pack = Hostile::of(&models::weary());
        pack.f32s("translate/timing", |timing| timing[at_end] = value);
        write(at, "timing.kin", &pack);
        let message = refused(at, "apply timing.kin walk.bvh --timing learned --out o.bvh");
        assert!(message.contains("tensor translate/timing: element"), "{message}");
    }
    // As far as a clock may go, the length of the result is known before.
    let mut pack = Hostile::of(&models::weary());
    pack.f32s("translate/timing", |timing| timing.copy_from_slice(&[4.0, -4.0, 4.0]));
    write(at, "timing.kin", &pack);
    succeed(at, "apply timing.kin walk.bvh --timing learned --out o.bvh");
    let message = refused(at, "apply timing.kin walk.bvh --timing learned --strength 4 --out o.bvh");
    assert!(message.contains("--timing learned") && message.contains("MB of memory, at most"), "{message}");
}

/// A picture of a drawn face, its landmarks, and the parts of a pack of smiles.
fn faces(folder: &Path) -> Hostile {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let options = TrainOptions { clusters: 3, ..TrainOptions::default() };
    let trained = train(&synthetic::faces(300, &mut random), "smile", &options).unwrap();
    let landmarks = synthetic::landmarks(0.3, 0.2, &mut random).map(|point| point.map(|x| 2.0 * x));
    synthetic::draw(&landmarks, 500).save(folder.join("me.png")).unwrap();
    let head: String = (0..68).map(|i| format!(",x{i},y{i}")).collect();
    let row: String = landmarks.iter().map(|[x, y]| format!(",{x},{y}")).collect();
    std::fs::write(folder.join("me.csv"), format!("image{head}\nme.png{row}\n")).unwrap();
    Hostile::of(&PackFile::from_bytes(&trained.model.pack(&Provenance::default())))
}

#[test]
fn faces_that_would_leave_the_picture_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let parts = faces(at);
    let show = "view face.kin --image me.png --landmarks me.csv --out o.html";
    for [low, high] in [[0.0, 1e10], [-1e20, 1e20]] {
        let mut pack = parts.clone();
        pack.models.iter_mut().for_each(|model| {
            if let ModelMeta::Face(meta) = model {
                meta.strength = [low, high];
            }
        });
        write(at, "face.kin", &pack);
        assert!(refused(at, show).contains("range of strengths"));
    }
    // Two hundred strengths, or as many units of a face for one strength, are no face.
    for (strength, slope) in [(200.0, 0.0), (1.0, 2.0), (1.0, 50.0)] {
        let mut pack = parts.clone();
        pack.models.iter_mut().for_each(|model| {
            if let ModelMeta::Face(meta) = model {
                meta.strength = [-strength, strength];
            }
        });
        if slope > 0.0 {
            pack.f32s("face/linear", |linear| linear.iter_mut().for_each(|x| *x = slope * x.signum()));
        }
        write(at, "face.kin", &pack);
        for line in [show, "face face.kin --image me.png --landmarks me.csv --change 100 --out x.png"] {
            let message = refused(at, line);
            assert!(message.contains("is to move by") && message.contains("at most"), "{line}: {message}");
        }
    }
}

/// Title, clear screen, clipboard, link, carriage return, one byte of C1, writing direction.
const SENT: &str = "n\x1b]0;title\x07\x1b[2J\x1b]52;c;aGk=\x07\r\u{9b}2J\u{202e}";

/// No character that a terminal obeys.
fn harmless(text: &str, line: &str) {
    let sent = text.chars().find(|c| c.is_control() && !"\n\t".contains(*c) || *c == '\u{202e}');
    assert_eq!(sent, None, "{line}: {text:?}");
}

#[test]
fn names_are_shown_and_not_sent_to_the_terminal() {
    let folder = folder();
    let at = folder.path();
    let renamed = |file: &PackFile, name: &str| {
        let mut pack = Hostile::of(file);
        pack.name = SENT.to_owned();
        // A motion with such joints is not written.
        if name != "e.kin" {
            pack.joints.iter_mut().for_each(|(joint, _)| *joint += SENT);
        }
        pack.models.iter_mut().for_each(|model| match model {
            ModelMeta::Translator(meta) => meta.style = SENT,
            ModelMeta::Emotion(meta) => {
                meta.motion = SENT;
                meta.attributes.iter_mut().flatten().for_each(|attribute| attribute.name = SENT);
            }
            _ => {}
        });
        pack.provenance.command = SENT.to_owned();
        pack.provenance.notes.push(SENT.to_owned());
        write(at, name, &pack);
    };
    renamed(&models::weary(), "w.kin");
    renamed(&emotions(), "e.kin");
    renamed(&limits(), "l.kin");
    let named = bvh(1.0).replace("LeftUpLeg", "Left\x1b[2J\u{202e}Leg");
    std::fs::write(at.join("named.bvh"), named).unwrap();
    std::fs::write(at.join("f\x1b[2J.bvh"), bvh(2.0)).unwrap();
    for line in [
        "inspect w.kin",
        "inspect e.kin",
        "inspect l.kin",
        "inspect e.kin --json",
        "inspect named.bvh",
        "limits l.kin",
        "synth e.kin --strength 9 --out o.bvh",
        "score e.kin f*.bvh",
        "score e.kin f*.bvh --json",
    ] {
        let shown = succeed(at, line);
        harmless(&shown, line);
        if line.ends_with("--json") {
            let json: serde_json::Value = serde_json::from_str(&shown).unwrap();
            assert!(
                json.to_string().contains("202e") || json.to_string().contains('\u{202e}') || line.contains("score"),
                "{shown}"
            );
        } else {
            assert!(shown.contains(r"\u{1b}[2J"), "{line}: {shown}");
        }
    }
    for line in [
        "apply w.kin f*.bvh --out o.bvh --mask Nose=1",
        "synth e.kin --strength x=1 --out o.bvh",
        "apply weary.kin named.bvh --out o.bvh",
        "apply gone\x1b[2J.kin walk.bvh --out o.bvh",
        "export w.kin --out o.bvh",
    ] {
        let output = run(at, line);
        assert_eq!(output.status.code(), Some(1), "{line}");
        harmless(&String::from_utf8_lossy(&output.stderr), line);
    }
}

#[test]
fn lines_of_broken_files_are_cut_in_messages() {
    let folder = folder();
    let at = folder.path();
    let text = bvh(0.5);
    let (before, after) = text.split_once("Frame Time").unwrap();
    let (line, rows) = after.split_once('\n').unwrap();
    let word = "x".repeat(3_000_000);
    std::fs::write(at.join("long.bvh"), format!("{before}Frame Time{line}\n{word}{rows}")).unwrap();
    std::fs::write(at.join("map.toml"), format!("[joints]\n{word} = 1\n")).unwrap();
    for line in ["inspect long.bvh", "inspect walk.bvh --map map.toml"] {
        let output = run(at, line);
        assert_eq!(output.status.code(), Some(1), "{line}");
        assert!(output.stderr.len() < 50_000, "{line}: {} bytes", output.stderr.len());
    }
}

#[test]
fn robots_and_manifests_are_read_in_time_that_is_linear() {
    let folder = folder();
    let at = folder.path();
    // A chain of links, and one element with very many attributes.
    let joint = |k: usize| {
        format!(
            "<link name='l{k}'/><joint name='j{k}' type='revolute'><origin xyz='0 0 0.1'/><parent link='l{}'/>\
             <child link='l{k}'/><limit lower='0' upper='1' velocity='5'/></joint>\n",
            k - 1
        )
    };
    let chain: String = (1..=60_000).map(joint).collect();
    std::fs::write(at.join("chain.urdf"), format!("<robot name='chain'><link name='l0'/>{chain}</robot>")).unwrap();
    let attributes: String = (0..200_000).map(|k| format!(" a{k}='1'")).collect();
    std::fs::write(at.join("crowd.urdf"), format!("<robot name='r'{attributes}><link name='a'/></robot>")).unwrap();
    std::fs::write(at.join("arm.toml"), "acceleration = 20.0\n[joints]\nl_elbow = \"j59999\"\n").unwrap();
    succeed(at, "limits chain.urdf --map arm.toml --skeleton weary.kin --out o.kin");
    let message = refused(at, "limits crowd.urdf --map arm.toml --skeleton weary.kin --out o.kin");
    assert!(message.contains("more than 1000 attributes"), "{message}");
    std::fs::write(at.join("e.kin"), emotions().bytes()).unwrap();
    let rows: String = (0..200_000).map(|k| format!("gone{k}.bvh\n")).collect();
    std::fs::write(at.join("m.tsv"), format!("file\n{rows}")).unwrap();
    assert!(refused(at, "score e.kin m.tsv").contains("gone0.bvh"));
}

#[test]
fn only_regular_files_are_read_unless_asked() {
    let folder = folder();
    let at = folder.path();
    assert!(Command::new("mkfifo").arg(at.join("in.bvh")).status().unwrap().success());
    std::os::unix::fs::symlink("/dev/zero", at.join("z.bvh")).unwrap();
    std::os::unix::fs::symlink("walk.bvh", at.join("link.bvh")).unwrap();
    for (line, what) in [
        ("inspect in.bvh", "a pipe"),
        ("inspect z.bvh", "a device"),
        ("apply weary.kin in.bvh --out o.bvh", "a pipe"),
        ("apply z.bvh walk.bvh --out o.bvh", "a device"),
        ("score in.bvh in.bvh", "a pipe"),
        ("inspect walk.bvh --map in.bvh", "a pipe"),
        ("limits in.bvh --map z.bvh --skeleton weary.kin --out o.kin", "a pipe"),
        ("train translate --pairs in.bvh --out o.kin", "a pipe"),
    ] {
        let message = refused(at, line);
        assert!(message.contains(what) && message.contains("expected a regular file"), "{line}: {message}");
    }
    assert_eq!(succeed(at, "inspect link.bvh").replace("link", "walk"), succeed(at, "inspect walk.bvh"));
    let piped = succeed(at, "inspect - < walk.bvh");
    assert!(piped.starts_with("-: 120 frames"), "{piped}");
    assert!(run(at, "inspect - < /dev/zero").status.code() == Some(1));
}

#[test]
fn a_pack_does_not_decide_which_joints_count() {
    let folder = folder();
    let at = folder.path();
    let figure = |pack: &str, key: &str| {
        let text = succeed(at, &format!("eval mechanics {pack} --clips walk.bvh --json"));
        let json: serde_json::Value = serde_json::from_str(&text).unwrap();
        assert_eq!(json["as_the_pack_states"], serde_json::json!(["autoencoder_mse", "linear_deg", "mean_pose_deg"]));
        json[key].as_f64().unwrap()
    };
    let honest = figure("mechanics.kin", "geodesic_deg");
    assert!(honest > 1.0 && figure("mechanics.kin", "moving_joints") >= 8.0, "{honest}");
    // The regression says that no joint depends on anything; the network's decoder is turned over.
    let mut pack = Hostile::of(&models::mechanics());
    pack.provenance.baselines.affine.fill(0.0);
    write(at, "m.kin", &pack);
    assert_eq!(figure("m.kin", "geodesic_deg"), honest);
    pack.f32s("mechanics/decoder_bias", |bias| bias.iter_mut().for_each(|x| *x = -*x));
    write(at, "m.kin", &pack);
    assert!(figure("m.kin", "geodesic_deg") > 2.0 * honest);
    // Baselines of another shape are no baselines.
    pack.provenance.baselines.offset.clear();
    write(at, "m.kin", &pack);
    assert!(refused(at, "eval mechanics m.kin --clips walk.bvh").contains("of the baselines in the provenance"));
}

#[test]
fn an_output_that_is_an_input_or_given_twice_is_refused() {
    let folder = folder();
    let at = folder.path();
    std::fs::create_dir(at.join("sub")).unwrap();
    std::os::unix::fs::symlink("walk.bvh", at.join("link.bvh")).unwrap();
    std::fs::hard_link(at.join("walk.bvh"), at.join("hard.bvh")).unwrap();
    std::fs::copy(at.join("walk.bvh"), at.join("n.kin")).unwrap();
    std::fs::copy(at.join("walk.bvh"), at.join("s.bvh")).unwrap();
    std::fs::write(at.join("e.kin"), emotions().bytes()).unwrap();
    let contents = || {
        let mut files: Vec<_> = std::fs::read_dir(at).unwrap().map(|entry| entry.unwrap().path()).collect();
        files.sort();
        files
            .into_iter()
            .filter(|path| path.is_file())
            .map(|path| (std::fs::read(&path).unwrap(), path))
            .collect::<Vec<_>>()
    };
    let before = contents();
    for line in [
        "apply weary.kin walk.bvh --out walk.bvh",
        "apply weary.kin walk.bvh --out ./sub/../walk.bvh",
        "apply weary.kin walk.bvh --out link.bvh",
        "apply weary.kin link.bvh --out walk.bvh",
        "apply weary.kin hard.bvh --out walk.bvh",
        "export walk.bvh --out walk.bvh",
        "quantize weary.kin --out weary.kin",
        "modulate mechanics.kin walk.bvh --amount 2 --out walk.bvh",
        "mix mechanics.kin --mechanics walk.bvh --expressive s.bvh --out s.bvh",
        "blend mechanics.kin walk.bvh s.bvh --mechanics-window 0..1 --expressive-window 0..1 --out s.bvh",
        "decouple mechanics.kin walk.bvh --mechanics walk.bvh",
        "train translate --pair n.kin s.bvh --out n.kin",
        "train mechanics --clips n.kin --out n.kin",
        "train components --content walk.bvh --style n.kin --out n.kin",
        "limits e.kin --with e.kin --out e.kin",
    ] {
        assert!(refused(at, line).contains("would be replaced"), "{line}");
    }
    for line in [
        "decouple mechanics.kin walk.bvh --mechanics x.bvh --expressive x.bvh",
        "decouple mechanics.kin walk.bvh --mechanics x.bvh --expressive sub/../x.bvh",
    ] {
        assert!(refused(at, line).contains("would be written twice"), "{line}");
    }
    assert!(contents() == before, "a file was changed");
    // What is neither is replaced as ever; the rest when it is said.
    succeed(at, "apply weary.kin walk.bvh --out o.bvh");
    succeed(at, "apply weary.kin walk.bvh --out o.bvh");
    succeed(at, "quantize weary.kin --out weary.kin --overwrite");
    succeed(at, "apply weary.kin walk.bvh --out walk.bvh --overwrite");
    assert!(std::fs::read(at.join("walk.bvh")).unwrap() != std::fs::read(at.join("s.bvh")).unwrap());
}

#[test]
fn private_packs_and_pages_hold_no_path_and_no_command() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let secret = at.join("client-7");
    std::fs::create_dir(&secret).unwrap();
    for (name, manner) in [("a.bvh", Manner::NEUTRAL), ("b.bvh", Manner::WEARY)] {
        std::fs::write(secret.join(name), walk(&manner, 2.0, 60.0, 0.0, 1).to_bvh(&WriteOptions::default()).unwrap())
            .unwrap();
    }
    std::fs::write(secret.join("m.kin"), models::mechanics().bytes()).unwrap();
    let made = [
        "train translate --pair client-7/a.bvh client-7/b.bvh --style tired --form per-joint --order 2 --align uniform --out t.kin",
        "train mechanics --clips client-7/a.bvh client-7/b.bvh --hidden 4 --epochs 1 --force --out n.kin",
        "train components --content client-7/a.bvh --style client-7/b.bvh -k 4 --out c.kin",
        "quantize t.kin --clips client-7/a.bvh --out q.kin",
        "view t.kin client-7/a.bvh --target client-7/b.bvh --out v.html",
    ];
    let leaks = || -> Vec<String> {
        let entries = std::fs::read_dir(at).unwrap().map(|entry| entry.unwrap().path()).filter(|path| path.is_file());
        let holds = |path: &Path| String::from_utf8_lossy(&std::fs::read(path).unwrap()).contains("client-7");
        entries.filter(|path| holds(path)).map(|path| path.display().to_string()).collect()
    };
    for line in made {
        succeed(at, line);
    }
    // Packs, reports and the page say how they were made; a pack that is made from such a one does not.
    assert_eq!(leaks().len(), 8, "{:?}", leaks());
    for line in made.iter().rev() {
        succeed(at, &format!("{line} --private"));
    }
    // The page was made before its pack was made again.
    succeed(at, &format!("{} --private", made[4]));
    succeed(at, &format!("--private {}", made[3]));
    assert_eq!(leaks(), [] as [String; 0]);
    // Names and digests stay.
    let inspected = succeed(at, "inspect t.kin");
    assert!(
        inspected.contains("trained on a.bvh (sha256 ") && inspected.contains("left out: --private"),
        "{inspected}"
    );
}

#[test]
fn nothing_panics_where_nobody_reads() {
    let folder = folder();
    for script in ["\"$0\" completions bash | head -1; test ${PIPESTATUS[0]} = 0", "\"$0\" completions zsh | true"] {
        let output = Command::new("bash").args(["-c", script, KINESIC]).current_dir(&folder).output().unwrap();
        assert!(output.status.success() && output.stderr.is_empty(), "{script}: {output:?}");
    }
    for line in ["completions bash > /dev/full", "inspect walk.bvh > /dev/full", "inspect walk.bvh --json > /dev/full"]
    {
        assert!(refused(folder.path(), line).contains("standard output cannot be written"), "{line}");
    }
}

#[test]
fn a_path_is_no_template_of_the_page() {
    let folder = folder();
    let at = folder.path();
    let name = "{{data}}<img src=x onerror=window.PWN=3>";
    std::fs::create_dir(at.join("walks {{data}}")).unwrap();
    std::fs::copy(at.join("walk.bvh"), at.join(format!("{name}.bvh"))).unwrap();
    let mut pack = Hostile::of(&models::weary());
    pack.joints[3].0 = "<!--<script>{{script}}".to_owned();
    write(at, "walks {{data}}/p.kin", &pack);
    succeed(at, &format!("view 'walks {{{{data}}}}/p.kin' '{name}.bvh' --out 'walks {{{{data}}}}/x.html'"));
    let html = std::fs::read_to_string(at.join("walks {{data}}/x.html")).unwrap();
    assert_eq!((html.matches("<script").count(), html.matches("</script").count()), (2, 2));
    assert!(!html.contains("<img") && !html.contains("<!--"));
    let (_, data) = html.split_once("id=\"data\">").unwrap();
    let data: serde_json::Value = serde_json::from_str(data.split_once("</script>").unwrap().0).unwrap();
    assert_eq!(data["clips"][0]["name"], name);
    assert_eq!(data["packs"][0]["joints"][3]["name"], "<!--<script>{{script}}");
}
