//! Names the commit for `optimize --version`.
#![allow(clippy::print_stdout, reason = "cargo reads it")]

use std::path::Path;
use std::process::Command;

fn main() {
    println!("cargo::rustc-env=FINGER_OPT_COMMIT={}", commit());
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
