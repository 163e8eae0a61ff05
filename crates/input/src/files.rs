//! Files: reading up to a size limit, atomic writing, and escaping of texts for terminals.
//!
//! A path from the user may lead to a symbolic link, a pipe or a device.

use std::fmt::Display;
use std::fs::{self, File, Metadata, OpenOptions, Permissions};
use std::io::{self, Read, Write};
use std::path::{MAIN_SEPARATOR, Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

/// Largest size of an input file, bytes: hundreds of times that of the longest shipped one.
pub const LARGEST_INPUT: u64 = 4 << 20;
/// Largest size of a file that the program has written, except for journals, bytes.
pub const LARGEST_OWN: u64 = 64 << 20;
/// Largest size of a journal, bytes: over a million evaluations.
pub const LARGEST_JOURNAL: u64 = 2 << 30;

/// Prefix and suffix of a temporary file's name; process ID and counter are between them.
const TEMPORARY: [&str; 2] = [".optimize-", ".new"];
/// Age from which a temporary file is assumed to have been left by a killed process.
const ABANDONED: Duration = Duration::from_secs(3600);

/// Returns the text of a file.
///
/// # Errors
/// If it cannot be read, is not UTF-8 or is longer than `limit` bytes.
pub fn read_text(path: &Path, limit: u64) -> io::Result<String> {
    utf8(read_up_to(File::open(path)?, limit)?)
}

/// Returns the bytes of an open file.
///
/// # Errors
/// If it cannot be read, or is longer than `limit` bytes.
pub fn read_up_to(file: impl Read, limit: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    file.take(limit + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > limit {
        let problem = format!("it is longer than {limit} bytes, the limit");
        return Err(io::Error::new(io::ErrorKind::FileTooLarge, problem));
    }
    Ok(bytes)
}

fn utf8(bytes: Vec<u8>) -> io::Result<String> {
    let problem = "stream did not contain valid UTF-8";
    String::from_utf8(bytes).map_err(|_| io::Error::new(io::ErrorKind::InvalidData, problem))
}

/// Writes a file at a path given by the user. A regular file keeps its permissions and is written atomically; a device,
/// a pipe or the target of a symbolic link is written in place.
///
/// # Errors
/// If it cannot be written, or is read-only.
pub fn write_named(path: &Path, content: &[u8]) -> io::Result<()> {
    match fs::symlink_metadata(path) {
        Ok(found) if found.is_file() && found.permissions().readonly() => Err(read_only()),
        Ok(found) if found.is_file() => write_whole(path, content, Some(found.permissions())),
        Ok(found) if !found.is_dir() => fs::write(path, content),
        _ => write_whole(path, content, None),
    }
}

fn read_only() -> io::Error {
    io::Error::new(io::ErrorKind::PermissionDenied, "it is read-only")
}

/// Writes a file atomically, even if the process is killed. A symbolic link is replaced.
///
/// # Errors
/// If it cannot be written.
pub fn write_atomic(path: &Path, content: &[u8]) -> io::Result<()> {
    write_whole(path, content, None)
}

fn write_whole(path: &Path, content: &[u8], mode: Option<Permissions>) -> io::Result<()> {
    let folder = path.parent().filter(|parent| !parent.as_os_str().is_empty());
    let (temporary, mut file) = create_temporary(folder.unwrap_or(Path::new(".")))?;
    let written = (|| {
        // Set before the file has any content.
        mode.map_or(Ok(()), |mode| file.set_permissions(mode))?;
        file.write_all(content)?;
        file.sync_all()?;
        fs::rename(&temporary, path)
    })();
    if written.is_err() {
        let _ = fs::remove_file(&temporary);
    }
    written
}

/// Text file of the user, locked against other processes.
#[derive(Debug)]
pub struct LockedFile {
    /// Holds the lock.
    _file: File,
    path: PathBuf,
    text: String,
    /// Whether this process created the file.
    created: bool,
}

impl LockedFile {
    /// Opens the file, which need not exist, and waits for its lock.
    ///
    /// # Errors
    /// If it cannot be read and written, is not UTF-8 or is longer than `limit` bytes.
    pub fn open(path: &Path, limit: u64) -> io::Result<Self> {
        loop {
            let created = !path.try_exists()?;
            let file = File::options().read(true).append(true).create(true).open(path)?;
            let found = file.metadata()?;
            if !found.is_file() {
                return Err(io::Error::other("it is a folder, a pipe or a device"));
            }
            if found.permissions().readonly() {
                return Err(read_only());
            }
            file.lock()?;
            // The previous owner of the lock may have removed or replaced the file.
            if fs::metadata(path).is_ok_and(|now| is_open_file(&now, &file).unwrap_or(false)) {
                let text = utf8(read_up_to(&file, limit)?)?;
                // A symbolic link stays.
                let path = fs::canonicalize(path)?;
                return Ok(LockedFile { _file: file, path, text, created });
            }
        }
    }

    /// Returns the text of the file.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Replaces the text atomically; the file keeps its permissions.
    ///
    /// # Errors
    /// If the file cannot be written; it is then unchanged.
    pub fn replace(mut self, new: &str) -> io::Result<()> {
        write_named(&self.path, new.as_bytes())?;
        self.created = false;
        Ok(())
    }
}

impl Drop for LockedFile {
    /// Removes a new file to which nothing was added.
    fn drop(&mut self) {
        if self.created && self.text.is_empty() {
            let _ = fs::remove_file(&self.path);
        }
    }
}

/// Creates a file under a name that no other thread, process or machine uses.
fn create_temporary(folder: &Path) -> io::Result<(PathBuf, File)> {
    static WRITES: AtomicU64 = AtomicU64::new(0);
    let [begin, end] = TEMPORARY;
    loop {
        let write = WRITES.fetch_add(1, Ordering::Relaxed);
        let path = folder.join(format!("{begin}{}-{write}{end}", std::process::id()));
        match OpenOptions::new().write(true).create_new(true).open(&path) {
            // Left by a killed process, or used by a process with the same number on another machine.
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
            opened => return Ok((path, opened?)),
        }
    }
}

/// Removes the temporary files that killed processes have left in a folder.
pub fn remove_abandoned(folder: &Path) {
    let [begin, end] = TEMPORARY;
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let ours = name.to_str().is_some_and(|name| name.starts_with(begin) && name.ends_with(end));
        let age = || entry.metadata().ok()?.modified().ok()?.elapsed().ok();
        if ours && age().is_some_and(|age| age > ABANDONED) {
            // A file that cannot be removed does no harm.
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// Returns whether the metadata are those of an open file; on a system other than Unix, only whether both are of a
/// regular file or both are not.
///
/// # Errors
/// If the system does not provide them.
pub fn is_open_file(found: &Metadata, open: &File) -> io::Result<bool> {
    let open = open.metadata()?;
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        Ok((found.dev(), found.ino()) == (open.dev(), open.ino()))
    }
    #[cfg(not(unix))]
    Ok(found.is_file() == open.is_file())
}

/// Escapes control characters, which terminals interpret, and those that change the text direction, as `\u001b`, so
/// that JSON stays valid. Line breaks and tabs stay.
pub fn visible(text: &str) -> String {
    let mut shown = String::with_capacity(text.len());
    for c in text.chars() {
        let turns = matches!(c, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
        match turns || (c.is_control() && !"\n\t\r".contains(c)) {
            true => shown += &format!("\\u{:04x}", u32::from(c)),
            false => shown.push(c),
        }
    }
    shown
}

/// Returns a name or path as a word of a shell command, within quotation marks if it needs them.
pub fn shell_word(text: impl Display) -> String {
    let text = text.to_string();
    let plain = |c: char| c.is_alphanumeric() || "-_./,:=+@%".contains(c) || c == MAIN_SEPARATOR;
    match !text.is_empty() && text.chars().all(plain) {
        true => text,
        false => format!("'{}'", text.replace('\'', r"'\''")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_word_of_a_shell_is_quoted_if_it_would_be_split_or_expanded() {
        for (text, word) in [
            ("results/usb-gp-seed0", "results/usb-gp-seed0"),
            ("my studies/ü.toml", "'my studies/ü.toml'"),
            ("it's", r"'it'\''s'"),
            ("~/a", "'~/a'"),
            ("", "''"),
        ] {
            assert_eq!(shell_word(text), word);
        }
    }

    #[test]
    fn control_characters_are_shown_and_json_stays_json() {
        let text = "red \u{1b}[31m, C1 \u{9b}2J, turned \u{202e}, kept \t\n ä";
        let shown = "red \\u001b[31m, C1 \\u009b2J, turned \\u202e, kept \t\n ä";
        assert_eq!(visible(text), shown);
        let value = serde_json::json!({"name": "\u{9b}2J\u{1b}"});
        let line = visible(&value.to_string());
        assert!(!line.chars().any(char::is_control), "{line}");
        assert_eq!(serde_json::from_str::<serde_json::Value>(&line).unwrap(), value);
    }

    #[test]
    fn a_file_is_read_up_to_its_limit() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("file");
        fs::write(&path, "12345").unwrap();
        assert_eq!(read_text(&path, 5).unwrap(), "12345");
        assert!(read_text(&path, 4).unwrap_err().to_string().contains("longer than 4 bytes"));
        // A sparse file, which takes no space on the disk.
        File::options().write(true).open(&path).unwrap().set_len(1 << 40).unwrap();
        assert!(read_text(&path, LARGEST_INPUT).is_err());
    }

    #[test]
    fn only_old_temporary_files_are_removed() {
        let dir = tempfile::tempdir().unwrap();
        let [old, new, other] = [".optimize-1-0.new", ".optimize-1-1.new", "my.new"];
        for name in [old, new, other] {
            let file = File::create(dir.path().join(name)).unwrap();
            if name != new {
                file.set_modified(std::time::SystemTime::now() - 2 * ABANDONED).unwrap();
            }
        }
        remove_abandoned(dir.path());
        let left = |name: &str| dir.path().join(name).exists();
        assert_eq!([old, new, other].map(left), [false, true, true]);
    }

    #[cfg(unix)]
    #[test]
    fn a_file_of_the_users_keeps_its_mode_and_a_read_only_one_its_contents() {
        use std::os::unix::fs::PermissionsExt;
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("task.toml");
        let mode = || fs::metadata(&path).unwrap().permissions().mode() & 0o7777;
        for private in [0o600, 0o640, 0o664, 0o700] {
            fs::write(&path, "old").unwrap();
            fs::set_permissions(&path, Permissions::from_mode(private)).unwrap();
            write_named(&path, b"new").unwrap();
            assert_eq!((mode(), fs::read_to_string(&path).unwrap().as_str()), (private, "new"));
        }
        fs::set_permissions(&path, Permissions::from_mode(0o444)).unwrap();
        let error = write_named(&path, b"newer").unwrap_err();
        assert_eq!(error.to_string(), "it is read-only");
        assert_eq!((mode(), fs::read_to_string(&path).unwrap().as_str()), (0o444, "new"));
        assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 1, "no temporary file");
    }

    #[test]
    fn a_table_is_replaced_without_a_copy_and_an_empty_one_is_not_left() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("table.csv");
        drop(LockedFile::open(&path, LARGEST_INPUT).unwrap());
        assert!(!path.exists());
        for text in ["a line\n", "another beginning\n"] {
            LockedFile::open(&path, LARGEST_INPUT).unwrap().replace(text).unwrap();
            assert_eq!(LockedFile::open(&path, LARGEST_INPUT).unwrap().text(), text);
        }
        assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 1, "no copy");
    }
}
