//! What the file system does to a command: full disks, folders that may not be written to, odd names, readers that go away.
#![cfg(unix)]

#[path = "refuse/files.rs"]
mod files;

use std::ffi::OsStr;
use std::os::unix::ffi::OsStrExt;
use std::os::unix::fs::PermissionsExt;
use std::os::unix::process::CommandExt;
use std::path::Path;
use std::process::{Command, Output};

const KINESIC: &str = env!("CARGO_BIN_EXE_kinesic");

/// A script in which `$0` is the command.
fn shell(folder: &Path, script: &str) -> Output {
    Command::new("sh").args(["-c", script, KINESIC]).current_dir(folder).output().unwrap()
}

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    files::make(folder.path());
    folder
}

fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    let mut names: Vec<_> = entries.map(|e| e.unwrap().file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

/// Refused with a message, not with a panic.
fn refused(output: &Output, cause: &str) {
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{:?}: {message}", output.status);
    assert!(message.contains(cause) && !message.contains("panicked"), "no '{cause}' in: {message}");
}

/// Commands that write, with the file that they write.
const WRITERS: [(&str, &str); 5] = [
    ("apply weary.kin walk.bvh --out x.bvh", "x.bvh"),
    ("modulate mechanics.kin walk.bvh --amount 2 --out x.bvh", "x.bvh"),
    ("decouple mechanics.kin walk.bvh --mechanics x.bvh", "x.bvh"),
    ("train translate --pair walk.bvh weary.bvh --form per-joint --order 2 --align uniform --out x.kin", "x.kin"),
    ("train mechanics --clips walk.bvh --hold-out 0 --hidden 4 --epochs 1 --force --out x.kin", "x.kin"),
];

#[test]
fn a_full_disk_leaves_the_older_file_and_no_half_of_the_new_one() {
    let folder = folder();
    let at = folder.path();
    for (command, file) in WRITERS {
        std::fs::write(at.join(file), "older").unwrap();
        let before = names(at);
        // A limit on the size of a file stops a write as a full disk does; blocks of 512 bytes.
        let output = shell(at, &format!("trap '' XFSZ; ulimit -f 4; exec \"$0\" {command}"));
        refused(&output, "x.");
        refused(&output, "cannot be written");
        assert_eq!(names(at), before, "{command}");
        assert_eq!(std::fs::read(at.join(file)).unwrap(), b"older", "{command}");
        std::fs::remove_file(at.join(file)).unwrap();
    }
}

#[test]
fn a_folder_that_may_not_be_written_to_is_named() {
    let folder = folder();
    let at = folder.path();
    // The administrator may write everywhere: the command runs as somebody else, from a place that this one may read.
    let open = |path: &Path, mode: u32| std::fs::set_permissions(path, std::fs::Permissions::from_mode(mode)).unwrap();
    let program = at.join("program");
    std::fs::copy(KINESIC, &program).unwrap();
    open(&program, 0o755);
    open(at, 0o555);
    for (command, file) in WRITERS {
        let before = names(at);
        let mut run = Command::new(&program);
        run.args(command.split(' ')).current_dir(at);
        if std::fs::File::create(at.join("probe")).is_ok() {
            std::fs::remove_file(at.join("probe")).unwrap();
            run.uid(65_534).gid(65_534);
        }
        let output = run.output().unwrap();
        refused(&output, file);
        refused(&output, "ermission denied");
        assert_eq!(names(at), before, "{command}");
    }
    open(at, 0o755);
}

#[test]
fn a_full_disk_behind_standard_output_is_no_panic() {
    let folder = folder();
    let at = folder.path();
    for command in
        ["inspect walk.bvh", "inspect weary.kin --json", "eval translate weary.kin --pair walk.bvh weary.bvh"]
    {
        let output = shell(at, &format!("\"$0\" {command} >/dev/full"));
        refused(&output, "standard output cannot be written");
        // Nothing at all can be said here; the exit code still tells.
        let output = shell(at, &format!("\"$0\" {command} >/dev/full 2>/dev/full"));
        assert_eq!(output.status.code(), Some(1), "{command}");
    }
    let output = shell(at, "\"$0\" inspect gone.bvh 2>/dev/full");
    assert_eq!(output.status.code(), Some(1));
}

#[test]
fn a_reader_that_goes_away_is_no_panic() {
    let folder = folder();
    for command in ["inspect weary.kin", "inspect walk.bvh --json", "--help"] {
        let output = shell(folder.path(), &format!("{{ \"$0\" {command}; echo \"code $?\" >&2; }} | true"));
        let message = String::from_utf8_lossy(&output.stderr);
        assert!(message.contains("code 0") && !message.contains("panicked"), "{command}: {message}");
    }
}

#[test]
fn odd_names_are_files_like_any_other() {
    let folder = folder();
    let at = folder.path();
    // Blanks, quotes, another script, a dash in front, a line break, bytes that are no Unicode.
    let odd: [&[u8]; 7] =
        [b"my walk", b"it's \"me\"", "歩く-ходьба-🚶".as_bytes(), b"-dash", b"two\nlines", b"caf\xe9", b"%s {0} $HOME"];
    for stem in odd {
        let name = |extension: &str| OsStr::from_bytes(&[b"./", stem, extension.as_bytes()].concat()).to_owned();
        let [walk, pack, out, report] = [".bvh", ".kin", ".out.bvh", ".report.html"].map(name);
        std::fs::copy(at.join("walk.bvh"), at.join(&walk)).unwrap();
        let run = |args: &[&OsStr]| {
            let output = Command::new(KINESIC).args(args).current_dir(at).output().unwrap();
            let message = String::from_utf8_lossy(&output.stderr).into_owned();
            assert!(output.status.success(), "{}: {message}", stem.escape_ascii());
        };
        let word = OsStr::new;
        let train =
            ["train", "translate", "--form", "per-joint", "--order", "2", "--align", "uniform", "--pair"].map(word);
        run(&[&train[..], &[&walk, word("weary.bvh"), word("--out"), &pack]].concat());
        run(&[word("inspect"), &walk]);
        run(&[word("inspect"), &pack, word("--json")]);
        run(&[word("apply"), &pack, &walk, word("--out"), &out]);
        for file in [&pack, &out, &report] {
            assert!(at.join(file).is_file(), "{}", stem.escape_ascii());
        }
    }
}

#[test]
fn a_second_process_never_sees_half_a_file() {
    let folder = folder();
    let at = folder.path();
    let whole = |name: &str| std::fs::read(at.join(name)).unwrap();
    shell(at, "\"$0\" apply weary.kin walk.bvh --out x.bvh");
    let expected = whole("x.bvh");
    let mut writers: Vec<_> = (0..3)
        .map(|_| {
            let script = "for i in 1 2 3 4; do \"$0\" apply weary.kin walk.bvh --out x.bvh || exit 1; done";
            Command::new("sh")
                .args(["-c", script, KINESIC])
                .current_dir(at)
                .stdout(std::process::Stdio::null())
                .spawn()
                .unwrap()
        })
        .collect();
    while writers.iter_mut().any(|writer| writer.try_wait().unwrap().is_none()) {
        assert!(whole("x.bvh") == expected);
    }
    assert!(writers.iter_mut().all(|writer| writer.wait().unwrap().success()));
}

#[test]
fn what_a_kill_in_mid_write_leaves_is_gone_after_the_next_run() {
    let folder = folder();
    let at = folder.path();
    let command = "apply weary.kin walk.bvh --out x.bvh";
    shell(at, &format!("\"$0\" {command}"));
    let expected = std::fs::read(at.join("x.bvh")).unwrap();
    let left = || names(at).into_iter().filter(|name| name.starts_with(".kinesic-x.bvh-")).count();
    let mut tries = 0;
    while left() == 0 {
        let mut child = Command::new(KINESIC)
            .args(command.split(' '))
            .current_dir(at)
            .stdout(std::process::Stdio::null())
            .spawn()
            .unwrap();
        // As soon as there is a temporary file.
        while child.try_wait().unwrap().is_none() && left() == 0 {}
        let _ = child.kill();
        child.wait().unwrap();
        assert!(std::fs::read(at.join("x.bvh")).unwrap() == expected, "half a file under the final name");
        tries += 1;
        assert!(tries < 500, "no kill came in mid-write");
    }
    println!("killed in mid-write at try {tries}");
    shell(at, &format!("\"$0\" {command}"));
    assert_eq!(left(), 0);
    assert!(std::fs::read(at.join("x.bvh")).unwrap() == expected);
}
