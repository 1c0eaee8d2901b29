//! Host and image have a lock file each: what both compile must be the same version, or equal bits mean nothing.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

fn versions(lock: &Path) -> BTreeMap<String, BTreeSet<String>> {
    let lock: toml::Table = toml::from_str(&std::fs::read_to_string(lock).unwrap()).unwrap();
    let mut versions: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for package in lock["package"].as_array().unwrap() {
        let text = |key: &str| package[key].as_str().unwrap().to_owned();
        versions.entry(text("name")).or_default().insert(text("version"));
    }
    versions
}

#[test]
fn host_and_image_compile_the_same_versions() {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let host = versions(&here.join("../Cargo.lock"));
    let image = versions(&here.join("image/Cargo.lock"));
    let both: Vec<&String> = image.keys().filter(|name| host.contains_key(*name)).collect();
    assert!(both.iter().any(|name| *name == "libm") && both.iter().any(|name| *name == "nalgebra"), "{both:?}");
    for name in both {
        assert!(
            image[name].is_subset(&host[name]),
            "{name}: the image has {:?}, the host {:?}; run `cargo update -p {name} --precise VERSION` in firmware-sim/image",
            image[name],
            host[name]
        );
    }
}

/// A dependency that core loses or gains must reach the image's lock file too: `--locked` refuses to build otherwise.
#[test]
fn the_image_knows_the_dependencies_of_what_it_shares() {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let (host, image) = (dependencies(&here.join("../Cargo.lock")), dependencies(&here.join("image/Cargo.lock")));
    for (name, folder) in [("kinesic", "../core"), ("kinesic-workloads", "workloads")] {
        let manifest = std::fs::read_to_string(here.join(folder).join("Cargo.toml")).unwrap();
        let manifest: toml::Table = toml::from_str(&manifest).unwrap();
        let mut expected = host[name].clone();
        // The workspace's lock file lists them too.
        let of_tests = manifest.get("dev-dependencies").and_then(toml::Value::as_table);
        of_tests.into_iter().flat_map(toml::Table::keys).for_each(|test| _ = expected.remove(test));
        assert_eq!(image[name], expected, "{name}: run `cargo metadata` in firmware-sim/image and commit Cargo.lock");
    }
}

/// What each package of this repository depends on.
fn dependencies(lock: &Path) -> BTreeMap<String, BTreeSet<String>> {
    let lock: toml::Table = toml::from_str(&std::fs::read_to_string(lock).unwrap()).unwrap();
    let own = lock["package"].as_array().unwrap().iter().filter(|package| package.get("source").is_none());
    let names = |package: &toml::Value| -> BTreeSet<String> {
        let list = package.get("dependencies").and_then(toml::Value::as_array).cloned().unwrap_or_default();
        list.iter().map(|name| name.as_str().unwrap().split(' ').next().unwrap().to_owned()).collect()
    };
    own.map(|package| (package["name"].as_str().unwrap().to_owned(), names(package))).collect()
}
