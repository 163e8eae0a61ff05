//! The journal: everything a study measured, one line per evaluation.
//!
//! A line is appended in one write and synced before anything builds on it, so
//! a process killed at any moment leaves whole lines and at most one torn
//! tail, which opening cuts off. Damage anywhere else is an error.

use super::config::StudyConfig;
use super::error::{LineError, StudyError};
use super::provenance::Segment;
use super::record::Recorded;
use super::store::Store;
use super::{fits, header, line};
use input::files::{self, LARGEST_JOURNAL};
use std::fs::OpenOptions;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

pub struct Journal {
    pub(super) path: PathBuf,
    store: Box<dyn Store>,
    config: StudyConfig,
    /// Bytes of whole, synced lines.
    len: u64,
    /// A write failed: what follows could not be trusted.
    broken: bool,
}

pub struct Contents {
    pub evaluations: Vec<Recorded>,
    /// Where what they were measured with changed; the first begins at 0.
    pub segments: Vec<Segment>,
    /// Records that another program wrote (a note made in Optuna's dashboard): they stay where they
    /// are and say nothing here.
    pub foreign: usize,
    /// How many of its bytes are whole lines.
    whole: usize,
}

impl Journal {
    /// Opens the journal of a study, or begins it if the store is empty, and
    /// gives what it already holds; `path` is named in errors.
    pub fn open(
        mut store: Box<dyn Store>,
        path: &Path,
        config: &StudyConfig,
    ) -> Result<(Journal, Contents), StudyError> {
        let bytes = store.read().map_err(StudyError::io("read", path))?;
        let parsed = parse(&bytes, path, config)?;
        if parsed.whole < bytes.len() {
            store
                .truncate(parsed.whole as u64)
                .map_err(StudyError::io("cut the torn last line off", path))?;
        }
        let mut journal = Journal {
            path: path.to_owned(),
            store,
            config: config.clone(),
            len: parsed.whole as u64,
            broken: false,
        };
        if parsed.whole == 0 {
            let header = header::encode(config).map_err(|error| journal.failed(error.into()))?;
            journal.write(&header)?;
        }
        Ok((journal, parsed))
    }

    /// Adds one evaluation; when this returns it survives a power failure.
    pub fn append(&mut self, recorded: &Recorded) -> Result<(), StudyError> {
        let line = line::encode(recorded, &self.config.space);
        self.write(&line.map_err(|error| self.failed(error.into()))?)
    }

    /// Begins the segment of this number, counted from 1: what is appended from now on belongs to it.
    pub(super) fn begin_segment(&mut self, n: usize, segment: &Segment) -> Result<(), StudyError> {
        let line = header::encode_segment(n, segment);
        self.write(&line.map_err(|error| self.failed(error.into()))?)
    }

    /// Whether the journal is still what was written.
    ///
    /// # Errors
    /// [`StudyError::Interfered`], with nothing saved yet.
    pub fn check(&mut self) -> Result<(), StudyError> {
        self.store.check(self.len).map_err(|problem| StudyError::Interfered {
            path: self.path.clone(),
            problem,
            kept: Err("nothing was tried".to_owned()),
        })
    }

    /// Writes a whole journal of these evaluations beside the lost one.
    pub(super) fn rescue(
        &self,
        evaluations: &[Recorded],
        segments: &[Segment],
    ) -> io::Result<PathBuf> {
        let mut text = header::encode(&self.config)?;
        let mut further = (2..).zip(segments.iter().skip(1)).peekable();
        for index in 0..=evaluations.len() {
            let begins = |(_, segment): &(usize, &Segment)| segment.first == index as u64;
            while let Some((number, segment)) = further.next_if(begins) {
                text.push_str(&header::encode_segment(number, segment)?);
            }
            if let Some(recorded) = evaluations.get(index) {
                text.push_str(&line::encode(recorded, &self.config.space)?);
            }
        }
        let folder = self.path.parent().unwrap_or(Path::new("."));
        std::fs::create_dir_all(folder)?;
        for number in 1u64.. {
            let path = folder.join(format!("journal.rescued-{number}.jsonl"));
            match OpenOptions::new().write(true).create_new(true).open(&path) {
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
                file => {
                    let mut file = file?;
                    file.write_all(text.as_bytes())?;
                    file.sync_all()?;
                    return Ok(path);
                }
            }
        }
        Err(io::Error::other("no name is left"))
    }

    fn write(&mut self, lines: &str) -> Result<(), StudyError> {
        if self.broken {
            return Err(self.failed(io::Error::other("an earlier write failed")));
        }
        self.check()?;
        match self.store.append(lines.as_bytes()) {
            Ok(()) => {
                self.len += lines.len() as u64;
                Ok(())
            }
            Err(error) => {
                self.broken = true;
                // If this fails too, the next opening does it.
                let _ = self.store.truncate(self.len);
                Err(self.failed(error))
            }
        }
    }

    fn failed(&self, source: io::Error) -> StudyError {
        StudyError::Io { action: "write", path: self.path.clone(), source }
    }
}

/// Contents of a journal; a torn tail is passed over, and nothing is written.
pub fn read(path: &Path, config: &StudyConfig) -> Result<Contents, StudyError> {
    let bytes = files::bytes_own(path, LARGEST_JOURNAL).map_err(StudyError::io("read", path))?;
    parse(&bytes, path, config)
}

fn parse(bytes: &[u8], path: &Path, config: &StudyConfig) -> Result<Contents, StudyError> {
    let foreign = |problem: String| {
        StudyError::file(path, format!("not the journal of this study: {problem}"))
    };
    let whole = bytes.iter().rposition(|&byte| byte == b'\n').map_or(0, |last| last + 1);
    let lines: Vec<&[u8]> = bytes[..whole].split_inclusive(|&byte| byte == b'\n').collect();
    let beginning = Segment { first: 0, provenance: config.provenance.clone() };
    let mut contents =
        Contents { evaluations: Vec::new(), segments: vec![beginning], foreign: 0, whole };
    let [first, second, rest @ ..] = lines.as_slice() else {
        // Killed while the header was written; anything else is not ours to overwrite.
        let header = header::encode(config).map_err(|error| foreign(error.to_string()))?;
        let written = bytes.trim_ascii_end();
        let written = &written[..written.iter().take_while(|&&byte| byte != 0).count()];
        return if header.as_bytes().starts_with(written) {
            Ok(Contents { whole: 0, ..contents })
        } else {
            Err(foreign("it does not begin with this study's header".to_owned()))
        };
    };
    let text = |line: &[u8]| String::from_utf8_lossy(line).trim_end_matches('\n').to_owned();
    header::check(&text(first), &text(second), config).map_err(foreign)?;
    for (number, line) in (3..).zip(rest) {
        contents.add(&text(line), config).map_err(|problem| {
            let mend = format!(
                "restore the file from a copy, or delete line {number} and all below it to measure \
                 them again"
            );
            StudyError::file(path, format!("line {number}: {problem}; {mend}"))
        })?;
    }
    Ok(contents)
}

impl Contents {
    /// Reads one line after the header.
    fn add(&mut self, line: &str, config: &StudyConfig) -> Result<(), LineError> {
        let expected = self.evaluations.len() as u64;
        if line::is_foreign(line) {
            self.foreign += 1;
            return Ok(());
        }
        match header::decode_segment(line)? {
            None => {
                let mut recorded = line::decode(line, expected)?;
                fits::fits(&recorded, config)?;
                fits::refuse_doubtful(&mut recorded, &config.goals());
                self.evaluations.push(recorded);
            }
            Some(segment) if segment.first != expected => {
                return Err(LineError::Order(segment.first, expected));
            }
            Some(segment) => {
                segment.provenance.check().map_err(LineError::Format)?;
                self.segments.push(segment);
            }
        }
        Ok(())
    }
}
