//! What we depend on: every crate has its reason in ARCHITECTURE.md, a licence that deny.toml allows, and comes from crates.io.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Every workspace of the repository.
const WORKSPACES: [&str; 8] =
    ["", "c", "docs/board", "firmware-sim/image", "firmware-sim/plugin", "fuzz", "tests/no-std-link", "wasm"];

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn read(path: &str) -> String {
    std::fs::read_to_string(repository().join(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// Platforms that a workspace is built for beside the host's: `ci.sh` fetches the crates of the same ones.
fn platforms(workspace: &str) -> Vec<&'static str> {
    let bare_metal =
        ["thumbv6m-none-eabi", "thumbv7em-none-eabihf", "thumbv8m.main-none-eabihf", "riscv32imc-unknown-none-elf"];
    match workspace {
        "c" | "docs/board" | "firmware-sim/image" | "tests/no-std-link" => bare_metal.to_vec(),
        "wasm" => vec!["wasm32-unknown-unknown"],
        _ => Vec::new(),
    }
}

/// The compiler's own platform.
fn host() -> String {
    let output = Command::new("rustc").arg("-vV").output().expect("rustc");
    let text = String::from_utf8(output.stdout).unwrap();
    text.lines().find_map(|line| line.strip_prefix("host: ")).expect("rustc -vV names the host").to_owned()
}

/// `cargo metadata` of a workspace. With `all`, of every crate that its platforms need: cargo downloads what is missing.
fn metadata(workspace: &str, all: bool) -> serde_json::Value {
    let mut cargo = Command::new(env!("CARGO"));
    cargo.args(["metadata", "--format-version", "1", "--locked", "--manifest-path"]);
    cargo.arg(repository().join(workspace).join("Cargo.toml"));
    if all {
        cargo.args(["--filter-platform", &host()]);
        platforms(workspace).into_iter().for_each(|platform| _ = cargo.args(["--filter-platform", platform]));
    } else {
        cargo.arg("--no-deps");
    }
    let output = cargo.output().unwrap();
    assert!(
        output.status.success(),
        "the crates of '{workspace}' cannot be read; with a network, run `./ci.sh fetch`\n{}",
        String::from_utf8_lossy(&output.stderr)
    );
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Names of the crates that ours ask for.
fn wanted() -> BTreeSet<String> {
    let mut names = BTreeSet::new();
    for workspace in WORKSPACES {
        let metadata = metadata(workspace, false);
        for package in metadata["packages"].as_array().unwrap() {
            for dependency in package["dependencies"].as_array().unwrap() {
                if !dependency["source"].is_null() {
                    names.insert(dependency["name"].as_str().unwrap().to_owned());
                }
            }
        }
    }
    names
}

/// Names in the first column of the table under "Dependencies", with their reasons.
fn listed() -> BTreeMap<String, String> {
    let page = read("ARCHITECTURE.md");
    let (_, table) = page.split_once("## Dependencies, and why each").expect("the heading");
    let table = table.split("\n## ").next().unwrap_or_default();
    let rows = table.lines().filter(|line| line.starts_with("| ") && !line.starts_with("| crate |"));
    let mut names = BTreeMap::new();
    for row in rows {
        let mut cells = row.trim_matches('|').split(" | ");
        let (crates, reason) = (cells.next().unwrap(), cells.next().unwrap_or_default().trim());
        assert!(reason.len() > 8, "no reason in: {row}");
        // What stands in brackets says how a crate is used.
        let mut depth = 0;
        let plain: String = crates
            .chars()
            .filter(|c| {
                depth += i32::from(*c == '(');
                let keep = depth == 0;
                depth -= i32::from(*c == ')');
                keep
            })
            .collect();
        for name in plain.split(',').map(str::trim).filter(|name| !name.is_empty()) {
            assert!(names.insert(name.to_owned(), reason.to_owned()).is_none(), "{name} is listed twice");
        }
    }
    names
}

#[test]
fn every_dependency_has_its_reason_in_the_architecture() {
    let (wanted, listed) = (wanted(), listed());
    assert!(wanted.len() > 20);
    let without: Vec<_> = wanted.iter().filter(|name| !listed.contains_key(*name)).collect();
    assert!(without.is_empty(), "ARCHITECTURE.md, Dependencies: give a reason for {without:?}");
    let gone: Vec<_> = listed.keys().filter(|name| !wanted.contains(*name)).collect();
    assert!(gone.is_empty(), "ARCHITECTURE.md, Dependencies: no Cargo.toml asks for {gone:?}");
}

/// Whether `allowed` fulfils an SPDX expression: `OR` (also written `/`) of `AND`s.
fn allows(expression: &str, allowed: &BTreeSet<String>) -> bool {
    let expression = expression.replace('/', " OR ");
    // In what is on crates.io, brackets are only ever round the choices: (A OR B) AND C.
    let conjuncts = if expression.contains('(') { expression.split(" AND ").collect() } else { vec![&expression[..]] };
    conjuncts.into_iter().all(|choices| {
        let choices = choices.trim().trim_matches(['(', ')']);
        choices.split(" OR ").any(|choice| choice.split(" AND ").all(|licence| allowed.contains(licence.trim())))
    })
}

#[test]
fn licences_and_sources_are_those_of_the_policy() {
    let policy: toml::Table = read("deny.toml").parse().unwrap();
    let names = |value: &toml::Value| -> BTreeSet<String> {
        value.as_array().unwrap().iter().map(|name| name.as_str().unwrap().to_owned()).collect()
    };
    let allowed = names(&policy["licenses"]["allow"]);
    let exceptions = policy["licenses"]["exceptions"].as_array().unwrap();
    let registries = names(&policy["sources"]["allow-registry"]);
    let mut seen = 0;
    for workspace in WORKSPACES {
        let metadata = metadata(workspace, true);
        for package in metadata["packages"].as_array().unwrap().iter().filter(|package| !package["source"].is_null()) {
            let name = package["name"].as_str().unwrap();
            let source = package["source"].as_str().unwrap();
            let registry = source.strip_prefix("registry+").unwrap_or(source);
            assert!(registries.contains(registry), "{name} comes from {source}");
            let licence = package["license"].as_str().unwrap_or_else(|| panic!("{name} names no licence"));
            let excepted = exceptions.iter().any(|exception| {
                exception["crate"].as_str() == Some(name) && allows(licence, &names(&exception["allow"]))
            });
            assert!(excepted || allows(licence, &allowed), "{name}: {licence} is not in deny.toml");
            seen += 1;
        }
    }
    assert!(seen > 200, "{seen} crates");
    println!("{seen} crates");
}

#[test]
fn licence_expressions_are_understood() {
    let allowed: BTreeSet<String> = ["MIT", "Zlib"].map(str::to_owned).into();
    for yes in ["MIT", "MIT OR GPL-3.0", "GPL-2.0/MIT", "(MIT OR GPL-3.0) AND Zlib", "MIT AND Zlib"] {
        assert!(allows(yes, &allowed), "{yes}");
    }
    for no in ["GPL-3.0", "MIT AND GPL-3.0", "(MIT OR Zlib) AND GPL-3.0", ""] {
        assert!(!allows(no, &allowed), "{no}");
    }
}
