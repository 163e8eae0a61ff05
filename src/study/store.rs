//! Where a journal's bytes are kept: a file, or in tests one that fails on purpose.

use std::fs::{File, OpenOptions};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::Path;

/// Append-only storage of a journal.
pub trait Store: Send {
    /// All bytes stored.
    fn read(&mut self) -> io::Result<Vec<u8>>;
    /// Adds `bytes` at the end, in one write; when it returns they survive a power failure.
    fn append(&mut self, bytes: &[u8]) -> io::Result<()>;
    /// Cuts back to the first `len` bytes.
    fn truncate(&mut self, len: u64) -> io::Result<()>;
}

/// A journal in a file.
#[derive(Debug)]
pub struct FileStore(File);

impl FileStore {
    /// Opens the file, creating it if it is missing.
    pub fn open(path: &Path) -> io::Result<Self> {
        Ok(FileStore(OpenOptions::new().read(true).append(true).create(true).open(path)?))
    }
}

impl Store for FileStore {
    fn read(&mut self) -> io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        self.0.seek(SeekFrom::Start(0))?;
        self.0.read_to_end(&mut bytes)?;
        Ok(bytes)
    }

    fn append(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.0.write_all(bytes)?;
        self.0.flush()?;
        self.0.sync_data()
    }

    fn truncate(&mut self, len: u64) -> io::Result<()> {
        self.0.set_len(len)?;
        self.0.sync_data()
    }
}
