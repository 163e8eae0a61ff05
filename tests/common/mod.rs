//! Runs the real binary on the fake engine.
#![allow(dead_code, reason = "each test file uses its own part of this")]

pub mod in_process;
mod ran;
pub mod shipped;

pub use ran::{Ran, read, run};

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// The binary with these arguments, not yet started.
pub fn command(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_optimize"));
    command.args(arguments).stdin(Stdio::null());
    command
}

/// Runs the binary to its end.
pub fn optimize(arguments: &[&str]) -> Ran {
    run(&mut command(arguments))
}

/// Runs a command line without spaces in its words.
pub fn optimize_line(line: &str) -> Ran {
    run(command(&[]).args(line.split_whitespace()))
}

/// The same on the fake engine.
pub fn fake(line: &str) -> Ran {
    optimize_line(&format!("{line} --engine fake"))
}

/// First line of a table of measurements of windows on the bench.
pub const HEAD: &str = "task,infill_density_percent,infill_direction_deg,range_mm\n";
/// Options that make a prediction for the bench quick.
pub const FEW: [&str; 6] = ["--task", "ket8", "--simulations", "24", "--samples", "20"];

/// Options that leave out what follows the search of a study, where only its journal matters.
pub const SEARCH: [&str; 3] = ["--no-confirm", "--no-levers", "--no-map"];

/// A number from the environment, which makes a test longer than it is by default.
pub fn setting(name: &str, default: u64) -> u64 {
    std::env::var(name).ok().and_then(|text| text.parse().ok()).unwrap_or(default)
}

/// Microseconds per trial: a study of 22 evaluations takes some tenths of a second, one of a thousand
/// longer than any test.
pub const SLOW: (&str, &str) = ("FINGER_OPT_FAKE_DELAY_US", "200");

/// Starts a command with slow trials.
pub fn start(command: &mut Command) -> Child {
    let command = command.env(SLOW.0, SLOW.1).stdout(Stdio::null()).stderr(Stdio::piped());
    command.spawn().expect("the command starts")
}

/// Exit code and standard error of a process that ends by itself.
pub fn end(child: Child) -> (Option<i32>, String) {
    let output = child.wait_with_output().expect("it ends");
    (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
}

/// Sends a signal and waits for the end; gives how long that took.
pub fn kill(mut child: Child, signal: &str) -> Duration {
    let sent = Instant::now();
    let id = child.id().to_string();
    assert!(Command::new("kill").args([&format!("-{signal}"), &id]).status().is_ok());
    child.wait().expect("it ends");
    sent.elapsed()
}

/// Returns the answer of a study without where it is and what it took from the cache.
pub fn answer(ran: &Ran) -> serde_json::Value {
    let mut json = ran.json();
    let fields = json.as_object_mut().expect("an object");
    fields.remove("study");
    fields.remove("cached");
    // It may name the study's folder.
    fields["answer"].as_object_mut().expect("an object").remove("next");
    json
}

/// Number of lines of a file; 0 if it is not there.
pub fn lines(path: &Path) -> usize {
    std::fs::read_to_string(path).unwrap_or_default().lines().count()
}

/// A path in the project.
pub fn root(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// All files in a folder and below it, in no order.
pub fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).expect("a folder");
    let paths = entries.map(|entry| entry.expect("an entry").path());
    paths.flat_map(|path| if path.is_dir() { files(&path) } else { vec![path] }).collect()
}

/// A folder for one test's studies.
pub struct Studies(pub TempDir);

impl Studies {
    pub fn new() -> Self {
        Studies(tempfile::tempdir().expect("a temporary folder"))
    }

    pub fn dir(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// The path of a study or a file as a word of a command line.
    pub fn word(&self, name: &str) -> String {
        self.dir(name).to_str().expect("a path in UTF-8").to_owned()
    }

    /// Writes a file; gives its path as a word of a command line.
    pub fn file(&self, name: &str, text: impl AsRef<[u8]>) -> String {
        std::fs::write(self.dir(name), text).expect("the file is written");
        self.word(name)
    }

    /// A text file below the folder.
    pub fn read(&self, name: &str) -> String {
        read(&self.dir(name))
    }

    /// A study's page.
    pub fn page(&self, name: &str) -> String {
        self.read(&format!("{name}/report.html"))
    }

    /// Cells of a column of a study's table.
    pub fn column(&self, name: &str, key: &str) -> Vec<String> {
        let mut table = csv::Reader::from_path(self.dir(name).join("evaluations.csv")).unwrap();
        let at = table.headers().unwrap().iter().position(|header| header == key);
        let at = at.unwrap_or_else(|| panic!("no column {key}"));
        table.records().map(|row| row.unwrap()[at].to_owned()).collect()
    }

    /// Numbers of a column of a study's table.
    pub fn numbers(&self, name: &str, key: &str) -> Vec<f64> {
        let cells = self.column(name, key).into_iter();
        cells.map(|cell| cell.parse().unwrap_or_else(|_| panic!("{key}: {cell}"))).collect()
    }

    /// Makes a study's report anew.
    pub fn report(&self, name: &str) -> Ran {
        optimize(&["report", &self.word(name)])
    }

    /// A quiet study on the fake engine, of usb unless `more` names a task, not yet started;
    /// `more` comes last.
    pub fn command(&self, name: &str, budget: u32, more: &[&str]) -> Command {
        let (budget, dir) = (budget.to_string(), self.dir(name));
        let mut command = command(&["--engine", "fake", "--quiet"]);
        if !more.contains(&"--task") {
            command.args(["--task", "usb"]);
        }
        command.args(["--budget", &budget]).arg("--out").arg(dir).args(more);
        command
    }

    /// Starts a slow study and waits until its journal has so many lines.
    pub fn begun(&self, name: &str, budget: u32, more: &[&str], lines: usize) -> Child {
        let mut child = start(&mut self.command(name, budget, more));
        self.wait_for_lines(name, lines, &mut child);
        child
    }

    /// Waits until a study's journal has so many lines or it has ended, at most a minute.
    pub fn wait_for_lines(&self, name: &str, least: usize, child: &mut Child) {
        let path = self.dir(name).join("journal.jsonl");
        let begun = Instant::now();
        while lines(&path) < least && child.try_wait().expect("it can be asked").is_none() {
            assert!(begun.elapsed() < Duration::from_secs(60), "no journal of {least} lines");
            std::thread::sleep(Duration::from_millis(1));
        }
    }

    /// Runs a study to its end.
    pub fn study(&self, name: &str, budget: u32, more: &[&str]) -> Ran {
        run(&mut self.command(name, budget, more))
    }

    /// Resumes a study to its end.
    pub fn resume(&self, name: &str) -> Ran {
        run(command(&["resume", "--quiet"]).arg(self.dir(name)))
    }

    /// A study's journal without its times.
    pub fn journal(&self, name: &str) -> String {
        strip_times(&self.read(&format!("{name}/journal.jsonl")))
    }
}

/// A journal without the fields that differ between two runs of a study.
pub fn strip_times(journal: &str) -> String {
    let content = |line: &str| line.split(",\"datetime_start\":").next().unwrap_or(line).to_owned();
    journal.lines().map(|line| content(line) + "\n").collect()
}

/// Logs attempts of usb from these starts, mm, or probes, with fingers of these infills; gives the table of the logs.
pub fn logged(
    folder: &Studies,
    below: &str,
    fingers: [[u32; 2]; 2],
    starts: [&str; 4],
    more: &str,
) -> String {
    let mut runs = "log,infill_density_percent,infill_direction_deg,offset_mm,outcome\n".to_owned();
    for [density, direction] in fingers {
        for (i, offset) in starts.into_iter().enumerate() {
            let name = format!("{below}{density}-{i}.csv");
            let what =
                if offset.is_empty() { "--probe".into() } else { format!("--offset-mm {offset}") };
            let finger = format!("trial --task usb --density {density} --direction {direction}");
            let log = folder.word(&name);
            let found = optimize_line(&format!("{finger} {what} --json --log {log} {more}")).json();
            let outcome = match &found["failure"] {
                _ if offset.is_empty() => "probe".to_owned(),
                serde_json::Value::Null => "inserted".to_owned(),
                class => class.to_string(),
            };
            runs += &format!("{name},{density},{direction},{offset},{outcome}\n");
        }
    }
    runs
}

/// A prior of friction alone, so that few replays are enough.
pub const FRICTION: &str = "name = \"few\"\ndescription = \"of a test\"\n\
    [[parameter]]\nname = \"friction\"\nsets = \"task.friction.plug_socket\"\nas = \"factor\"\n\
    scale = \"log\"\nlow = 0.5\nhigh = 2.0\nshared = false\nsource = \"made up\"\n";

/// A journal all of whose checks fit again.
pub fn sealed(text: &str) -> String {
    use sha2::{Digest, Sha256};
    let line = |line: &str| match line.rsplit_once(",\"check\":\"") {
        Some((content, rest)) if rest.len() > 16 && rest.is_char_boundary(16) => {
            let digest = Sha256::digest(content.as_bytes());
            let check: String = digest[..8].iter().map(|byte| format!("{byte:02x}")).collect();
            format!("{content},\"check\":\"{check}{}\n", &rest[16..])
        }
        _ => format!("{line}\n"),
    };
    text.lines().map(line).collect()
}
