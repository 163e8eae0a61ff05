//! The binary under limits: 10 s of processor time, 1 GB, an exit code that is documented.

use std::io::{Read, Write};
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::LazyLock;
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// Processor time that a case may take, s, also in a build for tests, which takes 1.7 times as long.
pub const CPU_S: u32 = 10;
/// The same of a simulated trial, of which 60 s are simulated at most, in a build for tests.
pub const TRIAL_S: u32 = 100;
/// Address space that it may take, KiB.
const MEMORY_KIB: u32 = 1 << 20;
/// After so long it hangs, whatever the machine is busy with.
const HANGS: Duration = Duration::from_secs(120);

/// What came of a case.
pub enum Verdict {
    /// As it should be: `accepted` or `refused`.
    Fine(&'static str),
    /// A panic, a hang, a limit: what was seen.
    Wrong(String),
}

/// What a process left.
pub struct Ended {
    pub code: Option<i32>,
    pub stdout: String,
    pub stderr: String,
}

/// The binary of this build, or another: long runs outlast builds.
fn program() -> String {
    let built = || env!("CARGO_BIN_EXE_optimize").to_owned();
    std::env::var("FINGER_OPT_FUZZ_PROGRAM").unwrap_or_else(|_| built())
}

/// Where cases run, and leave what a mutated name makes them write.
pub fn folder() -> &'static Path {
    static FOLDER: LazyLock<TempDir> = LazyLock::new(|| tempfile::tempdir().unwrap());
    FOLDER.path()
}

/// Runs the binary; `Err` says what no input may lead to.
pub fn run(arguments: &[String], input: &[u8], cpu_s: u32) -> Result<Ended, String> {
    let limits = format!("ulimit -v {MEMORY_KIB} -t {cpu_s} -c 0; exec \"$0\" \"$@\"");
    let child = Command::new("bash")
        .args(["-c", &limits, &program()])
        .args(arguments)
        .current_dir(folder())
        .env("RUST_BACKTRACE", "0")
        .env("RAYON_NUM_THREADS", "2")
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn();
    let mut child = match child {
        Ok(child) => child,
        // More words than the system takes: it has refused them.
        Err(error) if error.kind() == std::io::ErrorKind::ArgumentListTooLong => {
            let (stdout, stderr) = (String::new(), error.to_string());
            return Ok(Ended { code: Some(2), stdout, stderr });
        }
        Err(error) => return Err(format!("cannot start: {error}")),
    };
    let (stdin, stdout, stderr) = (child.stdin.take(), child.stdout.take(), child.stderr.take());
    let input = input.to_vec();
    // All three at once, or a full pipe would hold the program up.
    std::thread::spawn(move || stdin.map(|mut stdin| stdin.write_all(&input)));
    let reader = |pipe: Option<Box<dyn Read + Send>>| {
        std::thread::spawn(move || {
            let mut bytes = Vec::new();
            let _ = pipe.map(|mut pipe| pipe.read_to_end(&mut bytes));
            String::from_utf8_lossy(&bytes).into_owned()
        })
    };
    let out = reader(stdout.map(|pipe| Box::new(pipe) as Box<dyn Read + Send>));
    let err = reader(stderr.map(|pipe| Box::new(pipe) as Box<dyn Read + Send>));
    let begun = Instant::now();
    let status = loop {
        match child.try_wait().map_err(|error| error.to_string())? {
            Some(status) => break status,
            None if begun.elapsed() > HANGS => {
                let _ = child.kill();
                let _ = child.wait();
                return Err(format!("hangs: optimize {arguments:?}"));
            }
            None => std::thread::sleep(Duration::from_millis(2)),
        }
    };
    let (stdout, stderr) = (out.join().unwrap_or_default(), err.join().unwrap_or_default());
    let ended = Ended { code: status.code(), stdout, stderr };
    match ended.problem() {
        None => Ok(ended),
        Some(problem) => {
            let tail: String = ended.stderr.chars().take(2000).collect();
            Err(format!("{problem}: optimize {arguments:?}: {status}\n{tail}"))
        }
    }
}

impl Ended {
    fn problem(&self) -> Option<&'static str> {
        let control = |text: &str| text.chars().any(|c| c.is_control() && !"\n\t".contains(c));
        if !matches!(self.code, Some(0..=2)) {
            return Some("ended by a signal, a limit or an unknown exit code");
        }
        if ["panicked", "RUST_BACKTRACE", "memory allocation"]
            .iter()
            .any(|word| self.stderr.contains(word))
        {
            return Some("panicked");
        }
        if control(&self.stdout) || control(&self.stderr) {
            return Some("prints control characters");
        }
        if self.code != Some(0) && self.stderr.trim().is_empty() {
            return Some("fails without a word");
        }
        let number = |text: &str| {
            text.split(|c: char| !c.is_alphanumeric()).any(|w| w == "NaN" || w == "inf")
        };
        (self.code == Some(0) && number(&self.stdout)).then_some("succeeds with what is no number")
    }
}
