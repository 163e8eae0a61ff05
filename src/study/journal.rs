//! The journal: everything a study measured, one line per evaluation.
//!
//! A line is appended in one write and synced before anything builds on it, so
//! a process killed at any moment leaves whole lines and at most one torn
//! tail, which opening cuts off. Damage anywhere else is an error.

use super::config::StudyConfig;
use super::error::StudyError;
use super::record::Recorded;
use super::store::Store;
use super::{header, line};
use crate::input::space::Space;
use std::io;
use std::path::{Path, PathBuf};

/// An open journal.
pub struct Journal {
    path: PathBuf,
    store: Box<dyn Store>,
    space: Space,
    /// Bytes of whole, synced lines.
    len: u64,
    /// A write failed: what follows could not be trusted.
    broken: bool,
}

/// A journal's contents, and how many of its bytes are whole lines.
struct Parsed {
    evaluations: Vec<Recorded>,
    whole: usize,
}

impl Journal {
    /// Opens the journal of a study, or begins it if the store is empty, and
    /// gives what it already holds; `path` is named in errors.
    pub fn open(
        mut store: Box<dyn Store>,
        path: &Path,
        config: &StudyConfig,
    ) -> Result<(Journal, Vec<Recorded>), StudyError> {
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
            space: config.space.clone(),
            len: parsed.whole as u64,
            broken: false,
        };
        if parsed.whole == 0 {
            let header = header::encode(config).map_err(|error| journal.failed(error.into()))?;
            journal.write(&header)?;
        }
        Ok((journal, parsed.evaluations))
    }

    /// Adds one evaluation; when this returns it survives a power failure.
    pub fn append(&mut self, recorded: &Recorded) -> Result<(), StudyError> {
        let line =
            line::encode(recorded, &self.space).map_err(|error| self.failed(error.into()))?;
        self.write(&line)
    }

    /// Where it is kept.
    pub fn path(&self) -> &Path {
        &self.path
    }

    fn write(&mut self, lines: &str) -> Result<(), StudyError> {
        if self.broken {
            return Err(self.failed(io::Error::other("an earlier write failed")));
        }
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

/// What a journal holds; a torn tail is passed over, and nothing is written.
pub fn read(path: &Path, config: &StudyConfig) -> Result<Vec<Recorded>, StudyError> {
    let bytes = std::fs::read(path).map_err(StudyError::io("read", path))?;
    Ok(parse(&bytes, path, config)?.evaluations)
}

fn parse(bytes: &[u8], path: &Path, config: &StudyConfig) -> Result<Parsed, StudyError> {
    let foreign = |problem: String| StudyError::Foreign { path: path.to_owned(), problem };
    let whole = bytes.iter().rposition(|&byte| byte == b'\n').map_or(0, |last| last + 1);
    let lines: Vec<&[u8]> = bytes[..whole].split_inclusive(|&byte| byte == b'\n').collect();
    let [first, second, evaluations @ ..] = lines.as_slice() else {
        // Killed while the header was written; anything else is not ours to overwrite.
        let header = header::encode(config).map_err(|error| foreign(error.to_string()))?;
        let written = bytes.trim_ascii_end();
        let written = &written[..written.iter().take_while(|&&byte| byte != 0).count()];
        return if header.as_bytes().starts_with(written) {
            Ok(Parsed { evaluations: Vec::new(), whole: 0 })
        } else {
            Err(foreign("it does not begin with this study's header".to_owned()))
        };
    };
    let text = |line: &[u8]| String::from_utf8_lossy(line).trim_end_matches('\n').to_owned();
    header::check(&text(first), &text(second), config).map_err(foreign)?;
    let evaluations = evaluations.iter().enumerate().map(|(index, line)| {
        line::decode(&text(line), index as u64).map_err(|source| StudyError::Line {
            path: path.to_owned(),
            line: index + 3,
            source,
        })
    });
    Ok(Parsed { evaluations: evaluations.collect::<Result<_, _>>()?, whole })
}
