//! Lock of a study's folder, for one writing process.

use super::StudyError;
use std::fs::{File, TryLockError};
use std::io::{Read, Seek, Write};
use std::path::Path;

const LOCK_FILE: &str = ".lock";

/// Locked file. The system releases the lock when the process ends.
pub(super) struct Lock(File);

impl Drop for Lock {
    fn drop(&mut self) {
        // Closing the file would not unlock it while a child process that is being started has inherited it.
        let _ = self.0.unlock();
    }
}

/// Locks a folder.
///
/// # Errors
/// If another process holds the lock, or its file cannot be written.
pub(super) fn lock(dir: &Path) -> Result<Lock, StudyError> {
    let path = dir.join(LOCK_FILE);
    let file = File::options().read(true).write(true).create(true).truncate(false).open(&path);
    let mut file = file.map_err(StudyError::io("open", &path))?;
    match file.try_lock() {
        Ok(()) => {}
        Err(TryLockError::WouldBlock) => {
            let mut owner = String::new();
            // Only for the message: on some systems a locked file cannot be read.
            let _ = file.read_to_string(&mut owner);
            let owner = if owner.is_empty() { "of unknown number".to_owned() } else { owner };
            return Err(StudyError::Locked { dir: dir.to_owned(), owner });
        }
        Err(TryLockError::Error(error)) => return Err(StudyError::io("lock", &path)(error)),
    }
    let sign = |file: &mut File| {
        file.set_len(0)?;
        file.rewind()?;
        write!(file, "number {}", std::process::id())
    };
    sign(&mut file).map_err(StudyError::io("write", &path))?;
    Ok(Lock(file))
}
