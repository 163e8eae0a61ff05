//! A study's folder.
//!
//! ```text
//! study.toml       the resolved configuration
//! inputs/          copies of the input files, so that a study can be resumed
//!                  when the originals have changed or gone; inputs-2/ and so on
//!                  those of a further segment
//! journal.jsonl    what was measured
//! replay/          films of the trials at both ends of the recommended window
//! walk.json        what the walk and the repeats found of the best designs
//! bench.json       what measurements say of the fingers on the bench
//! evaluations.csv  the same as a table; convergence.svg and report.html beside it
//! .lock            held by the process that writes
//! ```

use super::config::{Conclusion, StudyConfig};
use super::error::StudyError;
use super::journal::{self, Contents, Journal};
use super::on_bench::{BENCH_FILE, OnBench};
use super::provenance::{Provenance, Segment};
use super::record::{Recorded, StudyRecord};
use super::rule::Rule;
use super::seal::sha256_hex;
use super::store::{FileStore, Store};
use super::walked;
use input::control_character;
use input::files::{self, LARGEST_INPUT, LARGEST_OWN};
use insertion::finger::file::FingerFile;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fs::{self, File, Metadata, OpenOptions, TryLockError};
use std::io::{self, Read, Seek, Write};
use std::path::{Path, PathBuf};

/// Name of the configuration's file.
pub const CONFIG_FILE: &str = "study.toml";
/// Name of the journal's file.
pub const JOURNAL_FILE: &str = "journal.jsonl";
const INPUTS: &str = "inputs";
/// Role of the finger file among the inputs.
pub const FINGER: &str = "finger";
/// Role of the file of a cell among the inputs.
pub const CELL: &str = "cell";
const LOCK_FILE: &str = ".lock";
/// Who has the lock, if that is not known.
const UNKNOWN_OWNER: &str = "of unknown number";

/// Texts of a study's input files by role (`task_1` and so on, `space`, `robot`, `stiffness`).
pub type Inputs = BTreeMap<String, String>;

/// SHA-256 of each input, in hexadecimal.
pub fn sha256(inputs: &Inputs) -> BTreeMap<String, String> {
    let hash = |text: &String| sha256_hex(text.as_bytes());
    inputs.iter().map(|(role, text)| (role.clone(), hash(text))).collect()
}

/// A study open for writing; no other process can open it meanwhile.
pub struct Study {
    /// Configuration, as asked for.
    pub config: StudyConfig,
    /// Measurements so far, by index.
    pub evaluations: Vec<Recorded>,
    /// Provenance of its evaluations.
    segments: Vec<Segment>,
    /// Records in the journal that another program wrote.
    foreign: usize,
    pub(super) journal: Journal,
    dir: PathBuf,
    // Dropping the file, or the end of the process, releases the lock.
    _lock: File,
}

/// Treatment of a study that the present program and inputs would measure otherwise.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum IfChanged {
    Refuse,
    NewSegment,
}

impl Study {
    /// Begins a study in `dir`, or continues the one that is there if its
    /// configuration is the same or has a smaller budget.
    pub fn create_or_continue(
        dir: &Path,
        config: &StudyConfig,
        inputs: &Inputs,
        if_changed: IfChanged,
    ) -> Result<Study, StudyError> {
        fs::create_dir_all(dir).map_err(StudyError::io("create the folder", dir))?;
        let lock = lock(dir)?;
        let file = dir.join(CONFIG_FILE);
        if file.try_exists().map_err(StudyError::io("look for", &file))? {
            let found = read_config(dir)?;
            if let Some(differences) = found.differences(config) {
                return Err(StudyError::file(
                    dir,
                    format!(
                        "holds a study of another configuration; give another --out, or the same \
                         configuration (only the budget may be raised):\n{differences}"
                    ),
                ));
            }
            let mut study = Study::open_locked(dir, lock, journal_file(dir)?)?;
            let before = (study.config.budget, study.config.settles);
            // Of one that settles the budget is but a limit.
            let least = if before.1 { study.evaluations.len() as u64 } else { before.0 };
            study.config.budget = config.budget.max(least);
            study.config.settles = config.settles;
            let raised = before != (study.config.budget, study.config.settles);
            study.measure_with(&config.provenance, inputs, if_changed)?;
            if raised {
                write_config(dir, &study.config)?;
            }
            return Ok(study);
        }
        let journal = dir.join(JOURNAL_FILE);
        if journal.exists() {
            return Err(StudyError::file(
                &journal,
                "not the journal of this study: there is no study.toml beside it; give another --out",
            ));
        }
        write_inputs(dir, 1, inputs)?;
        // Last, so that a folder with a configuration is complete.
        write_config(dir, config)?;
        Study::open_locked(dir, lock, journal_file(dir)?)
    }

    /// Opens the study in `dir` to continue it.
    pub fn resume(dir: &Path) -> Result<Study, StudyError> {
        // Before the lock: nothing is to be created in a folder that holds no study.
        read_config(dir)?;
        let lock = lock(dir)?;
        Study::open_locked(dir, lock, journal_file(dir)?)
    }

    /// The same with the journal in another store than its file.
    pub fn resume_with(dir: &Path, store: Box<dyn Store>) -> Result<Study, StudyError> {
        read_config(dir)?;
        Study::open_locked(dir, lock(dir)?, store)
    }

    fn open_locked(dir: &Path, lock: File, store: Box<dyn Store>) -> Result<Study, StudyError> {
        let config = read_config(dir)?;
        let (journal, contents) = Journal::open(store, &dir.join(JOURNAL_FILE), &config)?;
        // Makes the names of new files survive a power failure; not every system can.
        if cfg!(unix) {
            let sync = File::open(dir).and_then(|folder| folder.sync_all());
            sync.map_err(StudyError::io("sync the folder", dir))?;
        }
        files::remove_abandoned(dir);
        let Contents { evaluations, segments, foreign, .. } = contents;
        let dir = dir.to_owned();
        Ok(Study { config, evaluations, segments, foreign, journal, dir, _lock: lock })
    }

    /// Makes sure that what is measured from now on belongs to what was measured before; a new
    /// segment is in the journal when this returns.
    ///
    /// # Errors
    /// If it does not belong, and no new segment is wanted or none of its evaluations is left.
    pub fn measure_with(
        &mut self,
        now: &Provenance,
        inputs: &Inputs,
        if_changed: IfChanged,
    ) -> Result<(), StudyError> {
        let Some(differences) = self.provenance().differences(now) else { return Ok(()) };
        if if_changed == IfChanged::Refuse {
            return Err(StudyError::file(
                &self.dir,
                format!(
                    "was measured with other settings than now:\n{differences}\ngive another --out, \
                     or --accept-changed to go on in a new segment (the best design is then taken \
                     from that)"
                ),
            ));
        }
        let (first, evaluations) = (self.evaluations.len() as u64, self.config.evaluations());
        if first >= evaluations && !self.provenance().simulates_like(now) {
            return Err(StudyError::file(
                &self.dir,
                format!(
                    "simulates otherwise than before, and all its {evaluations} evaluations are \
                     done:\n{differences}\nraise --budget to measure with that, or give another --out"
                ),
            ));
        }
        let number = self.segments.len() + 1;
        write_inputs(&self.dir, number, inputs)?;
        let segment = Segment { first, provenance: now.clone() };
        self.journal.begin_segment(number, &segment)?;
        self.segments.push(segment);
        Ok(())
    }

    /// Settles how the study ends, whoever goes on with it.
    pub fn conclude_by(&mut self, conclusion: Conclusion) -> Result<(), StudyError> {
        if self.config.conclusion != conclusion {
            self.config.conclusion = conclusion;
            write_config(&self.dir, &self.config)?;
        }
        Ok(())
    }

    /// Whether the journal is still what was written; if not, all that was measured is saved
    /// beside it.
    pub fn check_journal(&mut self) -> Result<(), StudyError> {
        self.journal.check().map_err(|error| self.rescue(error))
    }

    /// Saves what was measured, if the error says that the journal is lost.
    pub fn rescue(&self, error: StudyError) -> StudyError {
        match error {
            StudyError::Interfered { path, problem, .. } => {
                let kept = self.journal.rescue(&self.evaluations, &self.segments);
                StudyError::Interfered { path, problem, kept: kept.map_err(|e| e.to_string()) }
            }
            other => other,
        }
    }

    /// Provenance of its next evaluation.
    pub fn provenance(&self) -> &Provenance {
        self.segments.last().map_or(&self.config.provenance, |segment| &segment.provenance)
    }

    pub(super) fn segments(&self) -> &[Segment] {
        &self.segments
    }

    /// The copies of the input files that its next evaluation is measured with.
    pub fn inputs(&self) -> Result<Inputs, StudyError> {
        read_inputs(&self.dir, &self.segments)
    }

    /// The folder.
    pub fn dir(&self) -> &Path {
        &self.dir
    }

    /// Whether its search has settled with these evaluations.
    pub fn settled(&self) -> bool {
        walked::settled(&self.dir, Some(self.provenance()), self.evaluations.len())
    }

    /// Keeps what measurements say of its fingers.
    pub fn keep_on_bench(&self, found: &OnBench) -> Result<(), StudyError> {
        let path = self.dir.join(BENCH_FILE);
        let text = serde_json::to_string(found).map_err(|error| StudyError::file(&path, error))?;
        write_own_file(&path, &(text + "\n"))
    }

    /// A copy that needs no open study.
    pub fn record(&self) -> StudyRecord {
        let (segments, evaluations) = (self.segments.clone(), self.evaluations.clone());
        StudyRecord::new(&self.dir, self.config.clone(), segments, evaluations, self.foreign)
    }
}

impl StudyRecord {
    /// Reads the study in `dir`, running or not, and writes nothing.
    pub fn load(dir: &Path) -> Result<StudyRecord, StudyError> {
        let config = read_config(dir)?;
        let contents = journal::read(&dir.join(JOURNAL_FILE), &config)?;
        let Contents { evaluations, segments, foreign, .. } = contents;
        Ok(StudyRecord::new(dir, config, segments, evaluations, foreign))
    }

    fn new(
        dir: &Path,
        config: StudyConfig,
        segments: Vec<Segment>,
        evaluations: Vec<Recorded>,
        foreign: usize,
    ) -> Self {
        let finger = read_inputs(dir, &segments)
            .ok()
            .and_then(|inputs| FingerFile::parse(inputs.get(FINGER)?, "inputs/finger").ok());
        let on_bench = segments
            .last()
            .and_then(|segment| OnBench::read(dir, &segment.provenance, &config.space));
        let (walked, firm_values) = Default::default();
        let mut record = StudyRecord {
            config,
            segments,
            evaluations,
            foreign,
            walked,
            finger,
            firm_values,
            on_bench,
            settled: false,
        };
        let provenance = record.segments.last().map(|segment| &segment.provenance);
        let goals = record.config.goals();
        let rule = Rule { goals: &goals, space: &record.config.space };
        (record.walked, record.firm_values) =
            walked::read(dir, &rule, provenance, record.current());
        record.settled =
            record.config.settles && walked::settled(dir, provenance, record.evaluations.len());
        record
    }

    /// The copies of the input files of the last segment.
    pub fn inputs(&self, dir: &Path) -> Result<Inputs, StudyError> {
        read_inputs(dir, &self.segments)
    }
}

fn journal_file(dir: &Path) -> Result<Box<dyn Store>, StudyError> {
    let path = dir.join(JOURNAL_FILE);
    match FileStore::open(&path) {
        Ok(store) => Ok(Box::new(store)),
        Err(error) if error.kind() == io::ErrorKind::WouldBlock => {
            Err(StudyError::Locked { dir: dir.to_owned(), owner: UNKNOWN_OWNER.to_owned() })
        }
        Err(error) => Err(StudyError::io("open", &path)(error)),
    }
}

/// The configuration of the study in `dir`.
pub fn read_config(dir: &Path) -> Result<StudyConfig, StudyError> {
    let path = dir.join(CONFIG_FILE);
    let text = match files::read_own(&path, LARGEST_OWN) {
        Ok(text) => text,
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            return Err(StudyError::file(dir, "not a study: it has no study.toml"));
        }
        Err(error) => return Err(StudyError::io("read", &path)(error)),
    };
    let wrong = |problem: String| {
        StudyError::file(&path, format!("{}; restore the file from a copy", problem.trim_end()))
    };
    let config: StudyConfig = toml::from_str(&text).map_err(|error| wrong(error.to_string()))?;
    let table = toml::from_str(&text).map_err(|error| wrong(error.to_string()))?;
    if let Some(key) = control_character(&table) {
        return Err(wrong(format!("{key}: has a control character")));
    }
    config.check().map_err(wrong)?;
    Ok(config)
}

/// The copies of the input files of the last segment, checked against its provenance.
fn read_inputs(dir: &Path, segments: &[Segment]) -> Result<Inputs, StudyError> {
    let Some(segment) = segments.last() else { return Ok(Inputs::new()) };
    let (number, expected) = (segments.len(), &segment.provenance.input_sha256);
    let mut inputs = Inputs::new();
    for role in expected.keys() {
        let path = input_path(dir, number, role);
        let text = files::read_own(&path, LARGEST_INPUT).map_err(StudyError::io("read", &path))?;
        inputs.insert(role.clone(), text);
    }
    let found = sha256(&inputs);
    for (role, hash) in expected {
        if found.get(role) != Some(hash) {
            let problem = format!("was changed: its SHA-256 is not the {hash} of the study");
            return Err(StudyError::file(&input_path(dir, number, role), problem));
        }
    }
    Ok(inputs)
}

/// Keeps copies of the input files of the segment with this number, counted from 1.
fn write_inputs(dir: &Path, segment: usize, inputs: &Inputs) -> Result<(), StudyError> {
    for (role, text) in inputs {
        let path = input_path(dir, segment, role);
        let folder = path.parent().unwrap_or(dir);
        match fs::create_dir(folder) {
            // Not through a link to who knows where.
            Err(_) if fs::symlink_metadata(folder).is_ok_and(|found| found.is_dir()) => {}
            made => made.map_err(StudyError::io("create the folder", folder))?,
        }
        // As it is: its hash is recorded.
        files::write_own(&path, text.as_bytes()).map_err(StudyError::io("write", &path))?;
    }
    Ok(())
}

/// Where the copy of an input of the segment with this number, counted from 1, is kept.
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

/// Writes a file that the user has named, and the folders to it: see [`files::write_named`].
/// A text is written without control characters.
pub fn write_file(path: &Path, content: &(impl AsRef<[u8]> + ?Sized)) -> Result<(), StudyError> {
    if let Some(parent) = path.parent() {
        fs::create_dir_all(parent).map_err(StudyError::io("create the folder", parent))?;
    }
    files::write_named(path, &plain(content.as_ref())).map_err(StudyError::io("write", path))
}

/// Writes a file of a study's folder: see [`files::write_own`]. A text is written without
/// control characters.
pub fn write_own_file(
    path: &Path,
    content: &(impl AsRef<[u8]> + ?Sized),
) -> Result<(), StudyError> {
    files::write_own(path, &plain(content.as_ref())).map_err(StudyError::io("write", path))
}

/// A text without control characters; what is none, as a solid in binary form, as it is.
fn plain(content: &[u8]) -> Cow<'_, [u8]> {
    match std::str::from_utf8(content) {
        Ok(text) if !content.contains(&0) => files::visible(text).into_bytes().into(),
        _ => content.into(),
    }
}

/// Whether a file has one name only: a second one would be overwritten with it.
fn only_name(found: &Metadata) -> bool {
    #[cfg(unix)]
    return std::os::unix::fs::MetadataExt::nlink(found) == 1;
    #[cfg(not(unix))]
    return found.is_file();
}

/// The folder's lock. The system drops it when its process ends, however it ends.
fn lock(dir: &Path) -> Result<File, StudyError> {
    let path = dir.join(LOCK_FILE);
    let mut options = OpenOptions::new();
    options.read(true).write(true).create(true).truncate(false);
    let mut file = files::open_own(&path, &mut options).map_err(StudyError::io("open", &path))?;
    match file.try_lock() {
        Ok(()) => {}
        Err(TryLockError::WouldBlock) => {
            let mut owner = String::new();
            // Only for the message: some systems let nobody read a locked file.
            let _ = file.read_to_string(&mut owner);
            let owner = if owner.is_empty() { UNKNOWN_OWNER.to_owned() } else { owner };
            return Err(StudyError::Locked { dir: dir.to_owned(), owner });
        }
        Err(TryLockError::Error(error)) => return Err(StudyError::io("lock", &path)(error)),
    }
    let sign = |file: &mut File| {
        // Who removes the file lets another process lock a new one.
        let here = fs::symlink_metadata(&path).is_ok_and(|found| {
            only_name(&found) && files::is_open_file(&found, file).unwrap_or(false)
        });
        if !here {
            return Err(io::Error::other("it was replaced, or has another name, too; remove it"));
        }
        file.set_len(0)?;
        file.rewind()?;
        write!(file, "number {}", std::process::id())
    };
    sign(&mut file).map_err(StudyError::io("write", &path))?;
    Ok(file)
}
