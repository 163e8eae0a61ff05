//! Journal of a study: one line per evaluation.
//!
//! Each line is appended in one write and synced before anything depends on it. A process killed at any
//! moment therefore leaves complete lines and at most one torn line at the end, which is cut off when the
//! journal is opened. Damage anywhere else is an error.

use super::error::LineError;
use super::{Recorded, Segment, StudyConfig, StudyError};
use super::{header, line};
use input::files::{self, LARGEST_JOURNAL};
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// File of the journal in the folder of a study.
pub const JOURNAL_FILE: &str = "journal.jsonl";

/// Journal that is open for writing.
pub struct Journal {
    pub(super) path: PathBuf,
    file: File,
    /// Length of the complete, synced lines, bytes.
    len: u64,
    /// Whether a write failed; later ones are then refused.
    broken: bool,
}

/// Contents of a journal.
pub struct Contents {
    /// The evaluations, by index.
    pub evaluations: Vec<Recorded>,
    /// Segments of equal provenance; the first begins at 0.
    pub segments: Vec<Segment>,
}

impl Journal {
    /// Opens the journal of the study in `dir`, or begins it if there is none, and returns its contents.
    ///
    /// # Errors
    /// If it is damaged, or cannot be read or written.
    pub fn open(dir: &Path, config: &StudyConfig) -> Result<(Journal, Contents), StudyError> {
        let path = dir.join(JOURNAL_FILE);
        let file = File::options().read(true).append(true).create(true).open(&path);
        let file = file.map_err(StudyError::io("open", &path))?;
        let bytes =
            files::read_up_to(&file, LARGEST_JOURNAL).map_err(StudyError::io("read", &path))?;
        let (contents, len) = parse(&bytes, &path, config)?;
        let mut journal = Journal { path, file, len, broken: false };
        if len < bytes.len() as u64 {
            let cut = journal.truncate();
            cut.map_err(StudyError::io("cut the torn last line off", &journal.path))?;
        }
        if len == 0 {
            journal.write(header::encode(config))?;
        }
        Ok((journal, contents))
    }

    /// Checks that the journal was not changed by another program.
    pub fn check(&self) -> Result<(), StudyError> {
        let changed = |problem| StudyError::JournalChanged { path: self.path.clone(), problem };
        self.unchanged().map_err(changed)
    }

    /// Checks that the file is there and has the length that was written; the error is the change.
    fn unchanged(&self) -> Result<(), String> {
        let found = fs::metadata(&self.path).map_err(|error| match error.kind() {
            io::ErrorKind::NotFound => "was removed or renamed".to_owned(),
            _ => format!("is no longer accessible: {error}"),
        })?;
        let (bytes, written) = (found.len(), self.len);
        if bytes == written {
            return Ok(());
        }
        Err(format!("was changed by another program: it has {bytes} bytes, {written} were written"))
    }

    /// Appends encoded lines; they then survive a power failure.
    pub fn write(&mut self, lines: serde_json::Result<String>) -> Result<(), StudyError> {
        let lines = lines.map_err(|error| self.failed(error.into()))?;
        if self.broken {
            return Err(self.failed(io::Error::other("an earlier write failed")));
        }
        self.check()?;
        let appended = self.file.write_all(lines.as_bytes());
        if let Err(error) = appended.and_then(|()| self.file.sync_data()) {
            self.broken = true;
            // If this fails, too, the torn line is cut off when the journal is opened again.
            let _ = self.truncate();
            return Err(self.failed(error));
        }
        self.len += lines.len() as u64;
        Ok(())
    }

    /// Truncates the file to its complete lines.
    fn truncate(&self) -> io::Result<()> {
        self.file.set_len(self.len)?;
        self.file.sync_data()
    }

    fn failed(&self, source: io::Error) -> StudyError {
        StudyError::Io { action: "write", path: self.path.clone(), source }
    }
}

/// Reads a journal without writing to it; a torn last line is ignored, and a missing file counts as empty.
pub fn read(path: &Path, config: &StudyConfig) -> Result<Contents, StudyError> {
    let read = File::open(path).and_then(|file| files::read_up_to(file, LARGEST_JOURNAL));
    let bytes = match read {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Vec::new(),
        read => read.map_err(StudyError::io("read", path))?,
    };
    Ok(parse(&bytes, path, config)?.0)
}

/// Returns the contents and the length of the complete lines, bytes.
fn parse(bytes: &[u8], path: &Path, config: &StudyConfig) -> Result<(Contents, u64), StudyError> {
    let foreign = |problem: String| {
        StudyError::file(path, format!("not the journal of this study: {problem}"))
    };
    let whole = bytes.iter().rposition(|&byte| byte == b'\n').map_or(0, |last| last + 1);
    let lines: Vec<&[u8]> = bytes[..whole].split_inclusive(|&byte| byte == b'\n').collect();
    let beginning = Segment { first: 0, provenance: config.provenance.clone() };
    let mut contents = Contents { evaluations: Vec::new(), segments: vec![beginning] };
    let [first, second, rest @ ..] = lines.as_slice() else {
        // The process was killed while it wrote the header; anything else must not be overwritten.
        let header = header::encode(config).map_err(|error| foreign(error.to_string()))?;
        let written = bytes.trim_ascii_end();
        let written = &written[..written.iter().take_while(|&&byte| byte != 0).count()];
        return if header.as_bytes().starts_with(written) {
            Ok((contents, 0))
        } else {
            Err(foreign("it does not begin with this study's header".to_owned()))
        };
    };
    let text = |line: &[u8]| String::from_utf8_lossy(line).trim_end_matches('\n').to_owned();
    header::check(&text(first), &text(second), config).map_err(foreign)?;
    for (number, line) in (3..).zip(rest) {
        contents.add(&text(line)).map_err(|problem| {
            let remedy = format!(
                "restore the file from a copy, or delete line {number} and all below it to measure \
                 them again"
            );
            StudyError::file(path, format!("line {number}: {problem}; {remedy}"))
        })?;
    }
    Ok((contents, whole as u64))
}

impl Contents {
    /// Adds a line after the header. Records of other programs (notes of Optuna's dashboard) are ignored.
    fn add(&mut self, line: &str) -> Result<(), LineError> {
        let expected = self.evaluations.len() as u64;
        if line::is_foreign(line) {
            return Ok(());
        }
        match header::decode_segment(line)? {
            None => self.evaluations.push(line::decode(line, expected)?),
            Some(segment) if segment.first != expected => {
                return Err(LineError::Order(segment.first, expected));
            }
            Some(segment) => self.segments.push(segment),
        }
        Ok(())
    }
}
