//! Evaluations kept in a folder, so that no study measures what another has measured.
//!
//! A file holds one evaluation and is named by the SHA-256 of a text of everything that
//! determines it: task and finger in full with what a design sets, robot, search, engine
//! with its settings, and the program's sources. So a file is never out of date, and the
//! folder may be deleted at any time.
//!
//! Files are written beside their place and renamed into it, so readers and writers of
//! many processes need no lock; of two writers the later wins with an equal file. A file
//! that is torn or damaged fails its check and is measured and written again.

use super::plausible;
use super::provenance::SIMULATION_SOURCES;
use super::seal::{seal, sha256_hex, unseal};
use input::files::{self, LARGEST_OWN};
use insertion::evaluation::Evaluation;
use insertion::robot::Robot;
use insertion::trial::engine::EngineRecord;
use serde::{Deserialize, Serialize};
use std::fmt::Debug;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::{fs, io};

/// A folder of evaluations, for one robot and one engine.
#[derive(Debug)]
pub struct Cache {
    dir: PathBuf,
    /// Prefix of all keys.
    context: String,
    found: AtomicU64,
    problem: Mutex<Option<io::Error>>,
}

#[derive(Serialize, Deserialize)]
struct Entry {
    /// SHA-256 of what determines the evaluation: another entry under this name shows.
    key: String,
    /// SHA-256 of `measured` as it is written: an accident shows. Who computes it anew is not
    /// found out; the journal says which values came from here.
    measured_sha256: String,
    measured: Evaluation,
}

impl Cache {
    /// The cache in `dir`, which need not exist.
    pub fn new(dir: &Path, robot: &Robot, engine: &EngineRecord) -> Self {
        Cache {
            dir: dir.to_owned(),
            context: format!("sources {SIMULATION_SOURCES}\nengine {engine:?}\nrobot {robot:?}\n"),
            found: AtomicU64::new(0),
            problem: Mutex::new(None),
        }
    }

    /// The name of the evaluation that `inputs`, with robot and engine, determine. Their
    /// `Debug` must show all of them; it shows numbers so that they read back as the same bits.
    pub fn key(&self, inputs: &impl Debug) -> String {
        let text = format!("{}inputs {inputs:?}\n", self.context);
        sha256_hex(text.as_bytes())
    }

    /// The evaluation of that name, if a whole one is there.
    pub fn get(&self, key: &str) -> Option<Evaluation> {
        let text = files::read_own(&self.path(key), LARGEST_OWN).ok()?;
        let (content, _) = unseal(text.strip_suffix('\n')?).ok()?;
        let entry: Entry = serde_json::from_str(&content).ok()?;
        let whole = serde_json::to_string(&entry.measured).ok()?;
        if entry.key != key || entry.measured_sha256 != sha256_hex(whole.as_bytes()) {
            return None;
        }
        if plausible::implausible(&entry.measured).is_some() {
            return None;
        }
        self.found.fetch_add(1, Ordering::Relaxed);
        Some(entry.measured)
    }

    /// Keeps an evaluation. What cannot be kept is measured again next time, so a failure is
    /// only noted ([`problem`](Self::problem)).
    pub fn put(&self, key: &str, evaluation: &Evaluation) {
        let write = || {
            let measured_sha256 = sha256_hex(serde_json::to_string(evaluation)?.as_bytes());
            let (key, measured) = (key.to_owned(), evaluation.clone());
            let path = self.path(&key);
            let text = seal(&Entry { key, measured_sha256, measured }, None)?;
            fs::create_dir_all(path.parent().unwrap_or(&self.dir))?;
            files::write_own(&path, text.as_bytes())
        };
        if let Err(error) = write()
            && let Ok(mut problem) = self.problem.lock()
        {
            problem.get_or_insert(error);
        }
    }

    /// How many evaluations were found.
    pub fn found(&self) -> u64 {
        self.found.load(Ordering::Relaxed)
    }

    /// Why evaluations could not be kept, if so: folder and the system's first answer.
    pub fn problem(&self) -> Option<String> {
        let problem = self.problem.lock().ok()?;
        problem.as_ref().map(|error| format!("{}: {error}", self.dir.display()))
    }

    fn path(&self, key: &str) -> PathBuf {
        let (folder, name) = key.split_at(2);
        self.dir.join(folder).join(format!("{name}.json"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plausible::tests::sound;
    use input::shipped::ROBOTS;
    use insertion::trial::engine::EngineKind;

    fn cache(dir: &Path) -> Cache {
        let robot = Robot::parse(ROBOTS[0].text, ROBOTS[0].file).unwrap();
        Cache::new(dir, &robot, &EngineKind::Direct.record())
    }

    fn files(dir: &Path) -> Vec<PathBuf> {
        let below = |dir: &Path| -> Vec<PathBuf> {
            fs::read_dir(dir).unwrap().map(|entry| entry.unwrap().path()).collect()
        };
        below(dir).iter().flat_map(|folder| below(folder)).collect()
    }

    #[test]
    fn what_is_put_is_found_by_its_own_inputs_only() {
        let dir = tempfile::tempdir().unwrap();
        let cache = cache(dir.path());
        let (a, b) = (cache.key(&0.1), cache.key(&(0.1 + f64::EPSILON)));
        assert_eq!(cache.get(&a), None);
        cache.put(&a, &sound());
        assert_eq!(cache.get(&a), Some(sound()));
        assert_eq!((cache.get(&b), cache.found(), cache.problem()), (None, 1, None));
        let robot = Robot::parse(ROBOTS[1].text, ROBOTS[1].file).unwrap();
        let (direct, rapier) = (EngineKind::Direct.record(), EngineKind::Rapier.record());
        let others = [
            Cache::new(dir.path(), &robot, &direct),
            Cache::new(dir.path(), &Robot { stop_force: 1.0, ..robot }, &direct),
            Cache::new(dir.path(), &Robot::parse(ROBOTS[0].text, "").unwrap(), &rapier),
        ];
        for other in others {
            assert_eq!(other.get(&other.key(&0.1)), None);
        }
    }

    #[test]
    fn a_torn_or_damaged_file_is_as_good_as_none_and_is_written_again() {
        let dir = tempfile::tempdir().unwrap();
        let cache = cache(dir.path());
        let (key, found) = (cache.key(&1), sound());
        cache.put(&key, &found);
        let [file] = &files(dir.path())[..] else { panic!("one file") };
        let whole = fs::read(file).unwrap();
        for torn in 0..whole.len() {
            fs::write(file, &whole[..torn]).unwrap();
            assert_eq!(cache.get(&key), None, "{torn} bytes");
        }
        for at in 0..whole.len() {
            let mut damaged = whole.clone();
            damaged[at] ^= 1;
            fs::write(file, &damaged).unwrap();
            assert_eq!(cache.get(&key), None, "byte {at}");
        }
        // Another evaluation's file under this name.
        let other = cache.key(&2);
        cache.put(&other, &Evaluation { trials: found.trials + 1, ..sound() });
        fs::copy(cache.path(&other), file).unwrap();
        assert_eq!(cache.get(&key), None);
        cache.put(&key, &found);
        assert_eq!(cache.get(&key), Some(found));
    }

    #[test]
    fn many_writers_and_readers_see_whole_evaluations_only() {
        let dir = tempfile::tempdir().unwrap();
        let caches = [cache(dir.path()), cache(dir.path())];
        let key = caches[0].key(&1);
        caches[0].put(&key, &sound());
        std::thread::scope(|scope| {
            for cache in caches.iter().cycle().take(8) {
                scope.spawn(|| {
                    for _ in 0..200 {
                        cache.put(&key, &sound());
                        assert_eq!(cache.get(&key), Some(sound()));
                    }
                });
            }
        });
        assert_eq!(files(dir.path()).len(), 1, "no temporary file is left");
        assert_eq!(caches.map(|cache| cache.problem()), [None, None]);
    }

    #[test]
    fn a_folder_that_cannot_be_written_is_told_and_harms_nothing() {
        let dir = tempfile::tempdir().unwrap();
        let file = dir.path().join("file");
        fs::write(&file, "").unwrap();
        let cache = cache(&file);
        let key = cache.key(&1);
        cache.put(&key, &sound());
        assert_eq!(cache.get(&key), None);
        assert!(cache.problem().unwrap().contains("file: "));
    }
}
