//! Code that decides a number: libraries are pinned, and our crates counted by provenance and by scripts/stale.sh.

use std::collections::BTreeSet;
use std::path::Path;
use toml::{Table, Value};

/// Libraries whose version changes no number: they read, write, draw, name or schedule.
const INDIFFERENT: &str = "clap csv jiff libc maud plotters rayon roxmltree serde serde_json sha2 strsim \
                           thiserror toml toml_edit zip";

fn read(path: &str) -> String {
    std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(path)).unwrap()
}

fn manifest(path: &str) -> Table {
    read(&format!("{path}Cargo.toml")).parse().unwrap()
}

/// The libraries that a crate of ours names, and those of our crates.
fn named(krate: &str) -> impl Iterator<Item = String> {
    let manifest = manifest(&format!("crates/{krate}/"));
    manifest["dependencies"].as_table().unwrap().clone().into_iter().map(|(name, _)| name)
}

fn is_ours(name: &str) -> bool {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("crates").join(name).exists()
}

/// A crate of ours and all of ours that it uses.
fn with_all_below(krate: &str) -> BTreeSet<String> {
    let mut found = BTreeSet::from([krate.to_owned()]);
    for name in named(krate).filter(|name| is_ours(name)) {
        found.extend(with_all_below(&name));
    }
    found
}

/// Our crates that decide a number of a study, a prediction or an analysis.
fn deciding() -> BTreeSet<String> {
    ["study", "calibration", "analysis"].into_iter().flat_map(with_all_below).collect()
}

/// Libraries pinned to a version, with it.
fn pinned() -> Vec<(String, String)> {
    let manifest = manifest("");
    let all = manifest["workspace"]["dependencies"].as_table().unwrap();
    let version = |value: &Value| {
        let version = value.as_str().or_else(|| value.get("version")?.as_str())?;
        version.strip_prefix('=').map(str::to_owned)
    };
    all.iter().filter_map(|(name, value)| Some((name.clone(), version(value)?))).collect()
}

/// The versions of a library in Cargo.lock.
fn locked(name: &str) -> Vec<String> {
    let lock: Table = read("Cargo.lock").parse().unwrap();
    let packages = lock["package"].as_array().unwrap().iter();
    let version = |package: &Value| package["version"].as_str().unwrap().to_owned();
    packages.filter(|package| package["name"].as_str() == Some(name)).map(version).collect()
}

/// The libraries that our deciding crates name and that compute.
fn computing() -> BTreeSet<String> {
    let named: BTreeSet<String> = deciding().iter().flat_map(|krate| named(krate)).collect();
    let computes =
        |name: &String| !is_ours(name) && !INDIFFERENT.split(' ').any(|other| other == name);
    named.into_iter().filter(computes).collect()
}

#[test]
fn a_library_that_computes_is_pinned_to_the_version_of_the_lock_file() {
    let pinned = pinned();
    for name in computing() {
        let pin = pinned.iter().find(|(pinned, _)| *pinned == name);
        let Some((_, version)) = pin else {
            panic!("{name} is not pinned with `=` in Cargo.toml; or it is one of INDIFFERENT")
        };
        let plain = |locked: &String| locked.split('+').next() == Some(version);
        assert!(locked(&name).iter().any(plain), "{name} {version} is not in Cargo.lock");
    }
    for name in ["rapier3d-f64", "parry3d-f64", "nalgebra", "linfa", "ndarray", "libm", "rand"] {
        assert!(computing().contains(name), "{name}");
    }
}

/// The paths between two marks of a text, those with the crates' folder as their beginning.
fn crates_between<'a>(text: &'a str, from: &str, to: &str) -> BTreeSet<&'a str> {
    let after = text.split_once(from).unwrap_or_else(|| panic!("no {from}")).1;
    let part = after.split_once(to).map_or(after, |(part, _)| part);
    let paths = part.split(|c: char| c.is_whitespace() || matches!(c, '"' | ','));
    paths.filter_map(|path| path.strip_prefix("crates/")).collect()
}

/// Our crates that decide no number.
const NEVER_DECIDES: [&str; 1] = ["drawing"];

/// Those of our crates that may decide numbers and of which none of the paths is a part.
fn missing<'a>(crates: &'a BTreeSet<String>, paths: &BTreeSet<&str>) -> Vec<&'a String> {
    let counted = |krate: &str| paths.iter().any(|path| path.split('/').next() == Some(krate));
    let decides = |krate: &&String| !NEVER_DECIDES.contains(&krate.as_str());
    crates.iter().filter(decides).filter(|krate| !counted(krate)).collect()
}

#[test]
fn every_crate_that_decides_is_counted_by_provenance() {
    let build = read("crates/study/build.rs");
    let simulation = crates_between(&build, "const SIMULATION", "];");
    let study = crates_between(&build, "const STUDY", "];");
    let none = Vec::<&String>::new();
    assert_eq!(missing(&with_all_below("insertion"), &simulation), none, "SIMULATION");
    let either = simulation.union(&study).copied().collect();
    for krate in ["study", "calibration"] {
        assert_eq!(missing(&with_all_below(krate), &either), none, "{krate}");
    }
    // Whole, not some of its files.
    assert!(study.contains("ask-tell"));
}

#[test]
fn every_crate_that_decides_a_figure_is_in_its_scope() {
    let script = read("scripts/stale.sh");
    let build = read("crates/study/build.rs");
    let simulation = crates_between(&build, "const SIMULATION", "];");
    for (scope, krate) in [
        ("windows)", "insertion"),
        ("studies)", "study"),
        ("bench)", "calibration"),
        ("levers)", "analysis"),
        ("maps)", "analysis"),
    ] {
        let listed = crates_between(&script, scope, ";;");
        let all = listed.union(&simulation).copied().collect();
        let mut needed = with_all_below(krate);
        if scope == "maps)" {
            // Of the crate it is the map alone, which tunes nothing.
            needed.remove("connector");
        }
        assert_eq!(missing(&needed, &all), Vec::<&String>::new(), "{scope}");
    }
}

/// README's first command: `cargo run` finds the program only if exactly one package names a default.
#[test]
fn cargo_run_runs_optimize() {
    let root = manifest("");
    let members = root["workspace"]["default-members"].as_array().unwrap().iter();
    let folders = members.flat_map(|member| match member.as_str().unwrap().strip_suffix("/*") {
        Some(folder) => std::fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join(folder))
            .unwrap()
            .map(|entry| format!("{folder}/{}", entry.unwrap().file_name().display()))
            .collect(),
        None => vec![member.as_str().unwrap().to_owned()],
    });
    let defaults: Vec<_> = folders
        .filter_map(|folder| manifest(&format!("{folder}/"))["package"].get("default-run").cloned())
        .collect();
    assert_eq!(defaults, [Value::from("optimize")]);
}
