//! Where a journal's bytes are kept: a file, or in tests one that fails on purpose.

use input::files::{self, LARGEST_JOURNAL};
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// Append-only storage of a journal.
pub trait Store: Send {
    /// All bytes stored.
    fn read(&mut self) -> io::Result<Vec<u8>>;
    /// Whether it is still the same, and `len` bytes long; if not, what has happened to it.
    fn check(&mut self, _len: u64) -> Result<(), String> {
        Ok(())
    }
    /// Adds `bytes` at the end, in one write; when it returns they survive a power failure.
    fn append(&mut self, bytes: &[u8]) -> io::Result<()>;
    /// Cuts back to the first `len` bytes.
    fn truncate(&mut self, len: u64) -> io::Result<()>;
}

/// A journal in a file.
#[derive(Debug)]
pub struct FileStore {
    file: File,
    path: PathBuf,
}

impl FileStore {
    /// Opens the file, creating it if it is missing. It is locked, too: a folder's `.lock` may
    /// be removed by anyone. The error is [`io::ErrorKind::WouldBlock`] if another has it.
    pub fn open(path: &Path) -> io::Result<Self> {
        let mut options = OpenOptions::new();
        let file = files::open_own(path, options.read(true).append(true).create(true))?;
        // Elsewhere than here a lock would keep readers out.
        if cfg!(unix) {
            match file.try_lock() {
                Err(TryLockError::WouldBlock) => return Err(io::ErrorKind::WouldBlock.into()),
                Err(TryLockError::Error(error)) => return Err(error),
                Ok(()) => {}
            }
        }
        Ok(FileStore { file, path: path.to_owned() })
    }
}

impl Store for FileStore {
    fn read(&mut self) -> io::Result<Vec<u8>> {
        self.file.seek(SeekFrom::Start(0))?;
        files::read_up_to(&mut self.file, LARGEST_JOURNAL)
    }

    fn check(&mut self, len: u64) -> Result<(), String> {
        let found = match fs::symlink_metadata(&self.path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                return Err("was removed or renamed".to_owned());
            }
            found => found.map_err(|error| format!("cannot be looked at any more: {error}"))?,
        };
        match files::is_open_file(&found, &self.file) {
            Ok(true) if found.len() == len => Ok(()),
            Ok(true) => {
                let found = found.len();
                Err(format!("was changed by another: it has {found} bytes, {len} were written"))
            }
            Ok(false) => Err("was replaced by another file".to_owned()),
            Err(error) => Err(format!("cannot be looked at any more: {error}")),
        }
    }

    fn append(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.file.write_all(bytes)?;
        self.file.flush()?;
        self.file.sync_data()
    }

    fn truncate(&mut self, len: u64) -> io::Result<()> {
        self.file.set_len(len)?;
        self.file.sync_data()
    }
}
