//! Hashes the sources that determine results, to recognise results of other sources.
#![allow(clippy::print_stdout, reason = "cargo reads it")]

use sha2::{Digest, Sha256};
use std::io;
use std::path::{Path, PathBuf};

/// Sources that determine the evaluation of a design.
const SIMULATION: [&str; 11] = [
    "Cargo.lock",
    "crates/ask-tell/src/normal.rs",
    "crates/ask-tell/src/process",
    "crates/ask-tell/src/statistics.rs",
    "crates/ask-tell/src/stream.rs",
    "crates/contact",
    "crates/finray",
    "crates/input",
    "crates/insertion",
    "crates/parameters",
    "data",
];
/// Further sources that determine the search and the recommendation of a study.
const STUDY: [&str; 3] = ["crates/ask-tell", "crates/calibration", "crates/study"];
/// The workspace, to which these paths are relative.
const WORKSPACE: &str = "../..";

fn main() -> io::Result<()> {
    set_hash("FINGER_OPT_SIMULATION_SHA256", &SIMULATION)?;
    set_hash("FINGER_OPT_STUDY_SHA256", &[&SIMULATION[..], &STUDY[..]].concat())
}

/// Sets an environment variable of the compilation to the hash of all files below these paths.
fn set_hash(variable: &str, paths: &[&str]) -> io::Result<()> {
    let mut files = Vec::new();
    for path in paths {
        let path = Path::new(WORKSPACE).join(path);
        println!("cargo::rerun-if-changed={}", path.display());
        collect(&path, &mut files)?;
    }
    files.sort();
    files.dedup();
    let mut hash = Sha256::new();
    for file in &files {
        let bytes = std::fs::read(file)?;
        let name = file.strip_prefix(WORKSPACE).unwrap_or(file);
        hash.update(name.to_string_lossy().replace('\\', "/").as_bytes());
        hash.update((bytes.len() as u64).to_le_bytes());
        hash.update(&bytes);
    }
    println!("cargo::rustc-env={variable}={:x}", hash.finalize());
    Ok(())
}

fn collect(path: &Path, files: &mut Vec<PathBuf>) -> io::Result<()> {
    if !path.is_dir() {
        files.push(path.to_owned());
        return Ok(());
    }
    for entry in std::fs::read_dir(path)? {
        collect(&entry?.path(), files)?;
    }
    Ok(())
}
