//! Folder of a study.
//!
//! ```text
//! study.toml       resolved configuration
//! inputs/          copies of the input files, with which the study is resumed; inputs-2/ and so on
//!                  for further segments
//! journal.jsonl    evaluations
//! replay/          animations of the trials at both ends of the recommended window
//! walk.json        confirmation of the best designs
//! bench.json       prediction for the bench (the real robot) from measurements
//! robot_stop.json  evaluation that would insert without robot stop, if no design inserts
//! evaluations.csv  evaluations as a table; convergence.svg and report.html beside it
//! .lock            lock of the writing process
//! ```

use super::confirmed::{ConfirmationFile, confirmed_designs};
use super::header;
use super::journal::{self, Contents, JOURNAL_FILE, Journal};
use super::lock::{Lock, lock};
use super::record::first_current;
use super::rule::Rule;
use super::{
    AnalysisSettings, BenchPrediction, ForceLimits, Provenance, Recorded, Segment, StudyConfig,
    StudyError, StudyRecord, sha256_hex,
};
use input::files::{self, LARGEST_INPUT, LARGEST_OWN};
use insertion::FingerFile;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

/// File of the configuration.
pub const CONFIG_FILE: &str = "study.toml";
const INPUTS: &str = "inputs";
/// Role of the finger file among the inputs.
pub const FINGER: &str = "finger";
/// Role of the cell file among the inputs.
pub const CELL: &str = "cell";

/// Texts of the input files of a study by role (`task_1` and so on, `space`, `robot`, `stiffness`).
pub type Inputs = BTreeMap<String, String>;

/// Returns the SHA-256 of each input, in hexadecimal.
pub fn sha256(inputs: &Inputs) -> BTreeMap<String, String> {
    let hash = |text: &String| sha256_hex(text.as_bytes());
    inputs.iter().map(|(role, text)| (role.clone(), hash(text))).collect()
}

/// Study that is open for writing; no other process can open it for writing.
pub struct Study {
    /// Requested configuration.
    pub config: StudyConfig,
    /// Evaluations so far, by index.
    pub evaluations: Vec<Recorded>,
    /// Segments of equal provenance.
    pub(super) segments: Vec<Segment>,
    pub(super) journal: Journal,
    dir: PathBuf,
    _lock: Lock,
}

impl Study {
    /// Begins a study in `dir`, or continues the study there if it has the same configuration, apart from a raised
    /// budget. If `accept_changed` is set, a study of another provenance is continued in a new segment.
    ///
    /// # Errors
    /// If the folder holds another study or cannot be used.
    pub fn create_or_continue(
        dir: &Path,
        config: &StudyConfig,
        inputs: &Inputs,
        accept_changed: bool,
    ) -> Result<Study, StudyError> {
        fs::create_dir_all(dir).map_err(StudyError::io("create the folder", dir))?;
        let lock = lock(dir)?;
        if has_config(dir) && has_begun(dir) {
            check_continues(dir, config)?;
            let mut study = Study::open_locked(dir, lock)?;
            let before = (study.config.budget, study.config.settles);
            // With early stopping the budget is only a limit.
            let least = if before.1 { study.evaluations.len() as u64 } else { before.0 };
            study.config.budget = config.budget.max(least);
            study.config.settles = config.settles;
            let raised = before != (study.config.budget, study.config.settles);
            study.set_provenance(&config.provenance, inputs, accept_changed)?;
            if raised {
                write_config(dir, &study.config)?;
            }
            return Ok(study);
        }
        if has_config(dir) {
            // Created without a journal: the batch may depend on the number of workers.
            let batch = read_config(dir)?.batch;
            check_continues(dir, &StudyConfig { batch, ..config.clone() })?;
        }
        begin(dir, config, inputs)?;
        Study::open_locked(dir, lock)
    }

    /// Writes a study without a journal to `dir`; an existing study is not changed.
    ///
    /// # Errors
    /// If the folder holds a study of another configuration or cannot be written.
    pub fn create(dir: &Path, config: &StudyConfig, inputs: &Inputs) -> Result<(), StudyError> {
        if has_config(dir) {
            return check_continues(dir, config);
        }
        fs::create_dir_all(dir).map_err(StudyError::io("create the folder", dir))?;
        let _lock = lock(dir)?;
        begin(dir, config, inputs)
    }

    /// Opens the study in `dir` to continue it.
    ///
    /// # Errors
    /// If the folder holds no study or cannot be used.
    pub fn resume(dir: &Path) -> Result<Study, StudyError> {
        // Before the lock, which would create a file in a folder without a study.
        read_config(dir)?;
        Study::open_locked(dir, lock(dir)?)
    }

    fn open_locked(dir: &Path, lock: Lock) -> Result<Study, StudyError> {
        let config = read_config(dir)?;
        let (journal, contents) = Journal::open(dir, &config)?;
        // New file names then survive a power failure; not every system supports this.
        if cfg!(unix) {
            let sync = File::open(dir).and_then(|folder| folder.sync_all());
            sync.map_err(StudyError::io("sync the folder", dir))?;
        }
        files::remove_abandoned(dir);
        let Contents { evaluations, segments } = contents;
        let dir = dir.to_owned();
        Ok(Study { config, evaluations, segments, journal, dir, _lock: lock })
    }

    /// Sets the provenance of further evaluations; begins a new segment in the journal if it differs.
    ///
    /// # Errors
    /// If it differs without `accept_changed`, or no evaluation is left for a new segment.
    pub fn set_provenance(
        &mut self,
        now: &Provenance,
        inputs: &Inputs,
        accept_changed: bool,
    ) -> Result<(), StudyError> {
        let Some(differences) = self.provenance().differences(now) else { return Ok(()) };
        if !accept_changed {
            let problem = format!(
                "was measured with different settings:\n{differences}\ngive another --out, or \
                 --accept-changed to continue in a new segment (the best design is then taken from it)"
            );
            return Err(StudyError::file(&self.dir, problem));
        }
        let (first, evaluations) = (self.evaluations.len() as u64, self.config.evaluations());
        if first >= evaluations && !self.provenance().simulates_like(now) {
            let problem = format!(
                "would now be simulated differently, and all its {evaluations} evaluations are done:\n\
                 {differences}\nraise --budget to measure with the new settings, or give another --out"
            );
            return Err(StudyError::file(&self.dir, problem));
        }
        let number = self.segments.len() + 1;
        write_inputs(&self.dir, number, inputs)?;
        let segment = Segment { first, provenance: now.clone() };
        self.journal.write(header::encode_segment(number, &segment))?;
        self.segments.push(segment);
        Ok(())
    }

    /// Sets the settings of the analyses after the search.
    ///
    /// # Errors
    /// If the configuration cannot be written.
    pub fn set_analyses(&mut self, conclusion: AnalysisSettings) -> Result<(), StudyError> {
        if self.config.conclusion != conclusion {
            self.config.conclusion = conclusion;
            write_config(&self.dir, &self.config)?;
        }
        Ok(())
    }

    /// Checks that the journal was not changed by another program.
    ///
    /// # Errors
    /// If it was.
    pub fn check_journal(&self) -> Result<(), StudyError> {
        self.journal.check()
    }

    /// Returns the provenance of the next evaluation.
    pub fn provenance(&self) -> &Provenance {
        self.segments.last().map_or(&self.config.provenance, |segment| &segment.provenance)
    }

    /// Returns the copies of the input files for the next evaluation.
    ///
    /// # Errors
    /// If one cannot be read or was changed.
    pub fn inputs(&self) -> Result<Inputs, StudyError> {
        read_inputs(&self.dir, &self.segments)
    }

    /// Returns the folder.
    pub fn dir(&self) -> &Path {
        &self.dir
    }

    /// Returns whether the search has settled (stopped early) with these evaluations.
    pub fn settled(&self) -> bool {
        ConfirmationFile::read(&self.dir, Some(self.provenance()))
            .is_some_and(|file| file.settled(self.evaluations.len()))
    }

    /// Returns a copy of the study with its analyses.
    pub fn record(&self) -> StudyRecord {
        let (evaluations, segments) = (self.evaluations.clone(), self.segments.clone());
        StudyRecord::new(&self.dir, self.config.clone(), Contents { evaluations, segments })
    }
}

/// File with [`StudyRecord::robot_stop`] in the folder of a study.
pub const ROBOT_STOP_FILE: &str = "robot_stop.json";

impl StudyRecord {
    /// Reads the study in `dir`, which may be running, without writing to it.
    ///
    /// # Errors
    /// If the folder holds no study or a file is damaged.
    pub fn load(dir: &Path) -> Result<StudyRecord, StudyError> {
        let config = read_config(dir)?;
        let contents = journal::read(&dir.join(JOURNAL_FILE), &config)?;
        Ok(StudyRecord::new(dir, config, contents))
    }

    fn new(dir: &Path, config: StudyConfig, contents: Contents) -> Self {
        let Contents { evaluations, segments } = contents;
        let inputs = read_inputs(dir, &segments).unwrap_or_default();
        let finger =
            inputs.get(FINGER).and_then(|text| FingerFile::parse(text, "inputs/finger").ok());
        let limits = ForceLimits::of(&inputs, config.tasks.len());
        let provenance = segments.last().map(|segment| &segment.provenance);
        let on_bench = provenance.and_then(|provenance| BenchPrediction::read(dir, provenance));
        let current = evaluations.get(first_current(&segments) as usize..).unwrap_or_default();
        let file = ConfirmationFile::read(dir, provenance);
        let settled =
            config.settles && file.as_ref().is_some_and(|file| file.settled(evaluations.len()));
        let confirms = config.optimizes_windows() && !config.conclusion.no_confirm;
        // A study of another version may have been confirmed in another file.
        let begun = || provenance.is_some_and(Provenance::is_of_this_program);
        let confirmation_due = confirms && file.as_ref().map_or_else(begun, |file| !file.complete);
        let file = file.filter(|file| file.complete);
        let (walked, firm_values) = confirmed_designs(file, &Rule::of(&config), current);
        StudyRecord {
            config,
            segments,
            evaluations,
            walked,
            finger,
            limits,
            firm_values,
            on_bench,
            robot_stop: read_analysis(dir, ROBOT_STOP_FILE),
            settled,
            confirmation_due,
        }
    }

    /// Returns the copies of the input files of the last segment.
    ///
    /// # Errors
    /// If one cannot be read or was changed.
    pub fn inputs(&self, dir: &Path) -> Result<Inputs, StudyError> {
        read_inputs(dir, &self.segments)
    }
}

/// Writes the inputs and the configuration of a study to `dir`.
fn begin(dir: &Path, config: &StudyConfig, inputs: &Inputs) -> Result<(), StudyError> {
    if has_begun(dir) {
        let problem =
            "not the journal of this study: there is no study.toml beside it; give another --out";
        return Err(StudyError::file(&dir.join(JOURNAL_FILE), problem));
    }
    write_inputs(dir, 1, inputs)?;
    // Written last: a folder with a configuration is complete.
    write_config(dir, config)
}

/// Returns whether a folder holds the journal of a study.
pub fn has_begun(dir: &Path) -> bool {
    dir.join(JOURNAL_FILE).exists()
}

/// Returns whether a folder holds the configuration of a study.
fn has_config(dir: &Path) -> bool {
    dir.join(CONFIG_FILE).exists()
}

/// Checks that the study in a folder can be continued with a configuration.
///
/// # Errors
/// If the configuration of the study differs, with the differences, or cannot be read.
fn check_continues(dir: &Path, config: &StudyConfig) -> Result<(), StudyError> {
    let Some(differences) = read_config(dir)?.differences(config) else { return Ok(()) };
    let problem = format!(
        "holds a study of another configuration; give another --out, or the same configuration (only \
         the budget may be raised):\n{differences}"
    );
    Err(StudyError::file(dir, problem))
}

/// Reads the configuration of the study in `dir`.
///
/// # Errors
/// If there is none or it is invalid.
pub fn read_config(dir: &Path) -> Result<StudyConfig, StudyError> {
    let path = dir.join(CONFIG_FILE);
    let text = files::read_text(&path, LARGEST_OWN).map_err(|error| match error.kind() {
        io::ErrorKind::NotFound if !dir.is_dir() => {
            StudyError::file(dir, "not a study: there is no such folder")
        }
        io::ErrorKind::NotFound => StudyError::file(dir, "not a study: it has no study.toml"),
        _ => StudyError::io("read", &path)(error),
    })?;
    let wrong = |problem: String| {
        StudyError::file(&path, format!("{}; restore the file from a copy", problem.trim_end()))
    };
    let config: StudyConfig = toml::from_str(&text).map_err(|error| wrong(error.to_string()))?;
    config.check().map_err(wrong)?;
    Ok(config)
}

/// Reads the copies of the input files of the last segment and checks them against its provenance.
fn read_inputs(dir: &Path, segments: &[Segment]) -> Result<Inputs, StudyError> {
    let read = |(role, hash): (&String, &String)| {
        let path = input_path(dir, segments.len(), role);
        let text = files::read_text(&path, LARGEST_INPUT).map_err(StudyError::io("read", &path))?;
        if sha256_hex(text.as_bytes()) != *hash {
            let problem = format!("was changed: its SHA-256 is not the {hash} of the study");
            return Err(StudyError::file(&path, problem));
        }
        Ok((role.clone(), text))
    };
    let copied = segments.last().map(|segment| &segment.provenance.input_sha256);
    copied.into_iter().flatten().map(read).collect()
}

/// Writes copies of the input files of the segment with this number, counted from 1.
fn write_inputs(dir: &Path, segment: usize, inputs: &Inputs) -> Result<(), StudyError> {
    for (role, text) in inputs {
        let path = input_path(dir, segment, role);
        let folder = path.parent().unwrap_or(dir);
        fs::create_dir_all(folder).map_err(StudyError::io("create the folder", folder))?;
        // Not through `plain`: the hash of the exact text is recorded.
        files::write_atomic(&path, text.as_bytes()).map_err(StudyError::io("write", &path))?;
    }
    Ok(())
}

/// Returns the path of the copy of an input of the segment with this number, counted from 1.
pub fn input_path(dir: &Path, segment: usize, role: &str) -> PathBuf {
    let extension = if ["stiffness", "measurements"].contains(&role) { "csv" } else { "toml" };
    let folder = if segment == 1 { INPUTS.to_owned() } else { format!("{INPUTS}-{segment}") };
    dir.join(folder).join(format!("{role}.{extension}"))
}

fn write_config(dir: &Path, config: &StudyConfig) -> Result<(), StudyError> {
    let path = dir.join(CONFIG_FILE);
    let text = toml::to_string(config).map_err(|error| StudyError::file(&path, error))?;
    write_own_file(&path, &text)
}

/// Writes a file named by the user, and its folders: see [`files::write_named`]. A text is written without
/// control characters.
///
/// # Errors
/// If it cannot be written.
pub fn write_file(path: &Path, content: &(impl AsRef<[u8]> + ?Sized)) -> Result<(), StudyError> {
    if let Some(parent) = path.parent() {
        fs::create_dir_all(parent).map_err(StudyError::io("create the folder", parent))?;
    }
    files::write_named(path, &plain(content.as_ref())).map_err(StudyError::io("write", path))
}

/// Reads an analysis from a file in a study's folder; returns `None` if it is missing or damaged, since it
/// can be repeated.
pub fn read_analysis<T: DeserializeOwned>(dir: &Path, file: &str) -> Option<T> {
    serde_json::from_str(&files::read_text(&dir.join(file), LARGEST_OWN).ok()?).ok()
}

/// Writes an analysis to a file in a study's folder.
///
/// # Errors
/// If the file cannot be written.
pub fn write_analysis(dir: &Path, file: &str, found: &impl Serialize) -> Result<(), StudyError> {
    let path = dir.join(file);
    let text = serde_json::to_string(found).map_err(|error| StudyError::file(&path, error))?;
    write_own_file(&path, &(text + "\n"))
}

/// Writes a file of a study's folder: see [`files::write_atomic`]. A text is written without control
/// characters.
///
/// # Errors
/// If it cannot be written.
pub fn write_own_file(
    path: &Path,
    content: &(impl AsRef<[u8]> + ?Sized),
) -> Result<(), StudyError> {
    files::write_atomic(path, &plain(content.as_ref())).map_err(StudyError::io("write", path))
}

/// Removes control characters from a text; binary content is unchanged.
fn plain(content: &[u8]) -> Cow<'_, [u8]> {
    match std::str::from_utf8(content) {
        Ok(text) if !content.contains(&0) => files::visible(text).into_bytes().into(),
        _ => content.into(),
    }
}
