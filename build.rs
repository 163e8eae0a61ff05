//! Names the sources that decide numbers: results that other sources computed are not the program's own.
//! And the commit, for `optimize --version`.

use sha2::{Digest, Sha256};
use std::io;
use std::path::{Path, PathBuf};
use std::process::Command;

/// What decides the evaluation of a design.
const SIMULATION: [&str; 9] = [
    "Cargo.lock",
    "crates/ask-tell/src/normal.rs",
    "crates/ask-tell/src/process",
    "crates/ask-tell/src/stream.rs",
    "crates/contact",
    "crates/finray",
    "crates/input",
    "crates/insertion",
    "data",
];
/// What else decides the course of a study and what it recommends.
const STUDY: [&str; 3] = ["crates/ask-tell", "src/calibration", "src/study"];

fn main() -> io::Result<()> {
    name("FINGER_OPT_SIMULATION_SHA256", &SIMULATION)?;
    let sources = name("FINGER_OPT_STUDY_SHA256", &[&SIMULATION[..], &STUDY[..]].concat())?;
    let (version, commit) = (env!("CARGO_PKG_VERSION"), commit());
    println!("cargo::rustc-env=FINGER_OPT_VERSION={version} ({commit}, sources {})", &sources[..8]);
    Ok(())
}

/// Seven digits of the commit: git's in a clone, else those that `git archive` writes into the file COMMIT.
/// (An archive that was unpacked inside another project's clone is not of that clone.)
fn commit() -> String {
    println!("cargo::rerun-if-changed=COMMIT");
    let git = |arguments: &[&str]| {
        let output = Command::new("git").args(arguments).output().ok()?;
        let text = String::from_utf8(output.stdout).ok()?.trim().to_owned();
        (output.status.success() && !text.is_empty()).then_some(text)
    };
    let short = |text: String| text.trim().get(..7).map(str::to_owned);
    let known = if Path::new(".git").exists() {
        // HEAD names a branch; its log is what every commit appends to. A file that is not there would build
        // the package each time.
        for name in ["HEAD", "logs/HEAD"] {
            let path = git(&["rev-parse", "--git-path", name]);
            if let Some(path) = path.filter(|path| Path::new(path).exists()) {
                println!("cargo::rerun-if-changed={path}");
            }
        }
        git(&["rev-parse", "HEAD"])
    } else {
        std::fs::read_to_string("COMMIT").ok().filter(|text| !text.starts_with('$'))
    };
    known.and_then(short).unwrap_or_else(|| "unknown".to_owned())
}

/// Sets a variable to the hash of all files below these paths, and returns it.
fn name(variable: &str, paths: &[&str]) -> io::Result<String> {
    let mut files = Vec::new();
    for path in paths {
        println!("cargo::rerun-if-changed={path}");
        collect(Path::new(path), &mut files)?;
    }
    files.sort();
    files.dedup();
    let mut hash = Sha256::new();
    for file in &files {
        let bytes = std::fs::read(file)?;
        hash.update(file.to_string_lossy().replace('\\', "/").as_bytes());
        hash.update((bytes.len() as u64).to_le_bytes());
        hash.update(&bytes);
    }
    let hash = format!("{:x}", hash.finalize());
    println!("cargo::rustc-env={variable}={hash}");
    Ok(hash)
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
