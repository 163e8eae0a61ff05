//! The binary under limits: 10 s of processor time, 1 GB, an exit code that is documented.

use crate::common::Ran;
use anyhow::{Result, bail};
use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::LazyLock;
use tempfile::TempDir;

/// Processor time of a case, s, also in a build for tests, which takes 1.7 times as long.
const CPU_S: u32 = 10;
/// Processor time of a simulated trial, of which 60 s are simulated at most, in a build for tests.
const TRIAL_S: u32 = 100;
/// Processor time of a mesh that is made a task.
const IMPORT_S: u32 = 30;
/// Address space of a case, KiB.
const MEMORY_KIB: u32 = 1 << 20;
/// Wall time after which a case hangs, whatever the machine is busy with, s.
const HANGS_S: u32 = 120;

/// The binary of this build, or another: long runs outlast builds.
fn program() -> String {
    let built = || env!("CARGO_BIN_EXE_optimize").to_owned();
    std::env::var("FINGER_OPT_FUZZ_PROGRAM").unwrap_or_else(|_| built())
}

/// Folder in which cases run, and leave what a mutated name makes them write.
pub fn folder() -> &'static Path {
    static FOLDER: LazyLock<TempDir> = LazyLock::new(|| tempfile::tempdir().unwrap());
    FOLDER.path()
}

/// Runs the binary; an error is what no input may lead to.
pub fn run<S: AsRef<str>>(arguments: &[S], input: &[u8]) -> Result<Ran> {
    let arguments: Vec<&str> = arguments.iter().map(AsRef::as_ref).collect();
    let cpu_s = match arguments.first() {
        Some(&"trial") => TRIAL_S,
        Some(&"task") => IMPORT_S,
        _ => CPU_S,
    };
    let limits = format!(
        "ulimit -v {MEMORY_KIB} -t {cpu_s} -c 0; exec timeout -s KILL {HANGS_S} \"$0\" \"$@\""
    );
    let child = Command::new("bash")
        .args(["-c", &limits, &program()])
        .args(&arguments)
        .current_dir(folder())
        .env("RUST_BACKTRACE", "0")
        .env("RAYON_NUM_THREADS", "2")
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn();
    let mut child = match child {
        // More words than the system takes: it has refused them.
        Err(error) if error.kind() == std::io::ErrorKind::ArgumentListTooLong => {
            let (stdout, stderr) = (String::new(), error.to_string());
            return Ok(Ran { code: Some(2), stdout, stderr });
        }
        child => child?,
    };
    let (stdin, input) = (child.stdin.take(), input.to_vec());
    // At the same time, or a full pipe would hold the program up.
    std::thread::spawn(move || stdin.map(|mut stdin| stdin.write_all(&input)));
    let output = child.wait_with_output()?;
    let [stdout, stderr] =
        [output.stdout, output.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
    let ended = Ran { code: output.status.code(), stdout, stderr };
    if let Some(problem) = problem(&ended) {
        let tail: String = ended.stderr.chars().take(2000).collect();
        bail!("{problem}: optimize {arguments:?}: {}\n{tail}", output.status);
    }
    Ok(ended)
}

/// Whether a text has a word that is no number where one belongs.
pub fn no_number(text: &str) -> bool {
    text.split(|c: char| !c.is_alphanumeric()).any(|word| word == "NaN" || word == "inf")
}

fn problem(Ran { code, stdout, stderr }: &Ran) -> Option<&'static str> {
    let control = |text: &str| text.chars().any(|c| c.is_control() && !"\n\t".contains(c));
    let panics = ["panicked", "RUST_BACKTRACE", "memory allocation"];
    let problems = [
        (!matches!(code, Some(0..=2)), "ended by a signal, a limit or an unknown exit code"),
        (panics.iter().any(|word| stderr.contains(word)), "panicked"),
        (control(stdout) || control(stderr), "prints control characters"),
        (*code != Some(0) && stderr.trim().is_empty(), "fails without a word"),
        (*code == Some(0) && no_number(stdout), "succeeds with what is no number"),
    ];
    problems.into_iter().find_map(|(seen, problem)| seen.then_some(problem))
}
