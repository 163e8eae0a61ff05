//! Storage of a journal: a file, or a failing substitute in tests.

use input::files::{self, LARGEST_JOURNAL};
use std::fs::{self, File};
use std::io::{self, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// Append-only storage of a journal.
pub trait Store: Send {
    /// Returns all bytes.
    ///
    /// # Errors
    /// If they cannot be read.
    fn read(&mut self) -> io::Result<Vec<u8>>;
    /// Checks that the storage is unchanged and `len` bytes long.
    ///
    /// # Errors
    /// If it is not, with the change.
    fn check(&mut self, _len: u64) -> Result<(), String> {
        Ok(())
    }
    /// Appends `bytes` in one write and syncs them to the disk.
    ///
    /// # Errors
    /// If they cannot be written.
    fn append(&mut self, bytes: &[u8]) -> io::Result<()>;
    /// Truncates to the first `len` bytes.
    ///
    /// # Errors
    /// If that fails.
    fn truncate(&mut self, len: u64) -> io::Result<()>;
}

/// Journal in a file.
#[derive(Debug)]
pub struct FileStore {
    file: File,
    path: PathBuf,
}

impl FileStore {
    /// Opens the file, or creates it, and locks it, since the folder's `.lock` may be removed.
    ///
    /// # Errors
    /// [`io::ErrorKind::WouldBlock`] if another process has locked it.
    pub fn open(path: &Path) -> io::Result<Self> {
        let file = File::options().read(true).append(true).create(true).open(path)?;
        // On other systems a lock would block readers.
        if cfg!(unix) {
            file.try_lock()?;
        }
        Ok(FileStore { file, path: path.to_owned() })
    }
}

impl Drop for FileStore {
    fn drop(&mut self) {
        // Closing the file might not unlock it, as in `lock.rs`.
        let _ = self.file.unlock();
    }
}

impl Store for FileStore {
    fn read(&mut self) -> io::Result<Vec<u8>> {
        self.file.seek(SeekFrom::Start(0))?;
        files::read_up_to(&mut self.file, LARGEST_JOURNAL)
    }

    fn check(&mut self, len: u64) -> Result<(), String> {
        let inaccessible = |error: io::Error| format!("is no longer accessible: {error}");
        let found = match fs::symlink_metadata(&self.path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                return Err("was removed or renamed".to_owned());
            }
            found => found.map_err(inaccessible)?,
        };
        if !files::is_open_file(&found, &self.file).map_err(inaccessible)? {
            return Err("was replaced by another file".to_owned());
        }
        match found.len() {
            found if found == len => Ok(()),
            found => Err(format!(
                "was changed by another program: it has {found} bytes, {len} were written"
            )),
        }
    }

    fn append(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.file.write_all(bytes)?;
        self.file.sync_data()
    }

    fn truncate(&mut self, len: u64) -> io::Result<()> {
        self.file.set_len(len)?;
        self.file.sync_data()
    }
}
