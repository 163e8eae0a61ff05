//! Cache of evaluations, shared by studies.
//!
//! Each file holds one evaluation. Its name is the SHA-256 of everything that determines the evaluation:
//! task and finger with the settings of the design, robot, method of the window search, plan of the trials under
//! drawn errors, engine with its settings, and the program's sources. A file therefore never becomes outdated,
//! and the folder may be deleted at any time.
//!
//! Files are written under a temporary name and then renamed, so that several processes need no lock. A
//! torn or damaged file fails its checksum; the design is then evaluated and written again.

use super::provenance::SIMULATION_SOURCES;
use super::seal::{seal, unseal};
use super::sha256_hex;
use input::files::{self, LARGEST_OWN};
use insertion::trial::engine::EngineRecord;
use insertion::{Evaluation, Robot};
use std::fmt::Debug;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering};
use std::{fs, io};

/// Cache of the evaluations with one robot and one engine.
#[derive(Debug)]
pub struct Cache {
    dir: PathBuf,
    /// Prefix of all keys.
    context: String,
    hits: AtomicU64,
    /// First write error.
    problem: OnceLock<io::Error>,
}

impl Cache {
    /// Returns the cache in `dir`, which need not exist.
    pub fn new(dir: &Path, robot: &Robot, engine: &EngineRecord) -> Self {
        let context = format!("sources {SIMULATION_SOURCES}\nengine {engine:?}\nrobot {robot:?}\n");
        Cache { dir: dir.to_owned(), context, hits: AtomicU64::new(0), problem: OnceLock::new() }
    }

    /// Returns the key of the evaluation that `inputs`, robot and engine determine. `Debug` of the inputs
    /// must contain all of them, with numbers that read back to the same bits.
    pub fn key(&self, inputs: &impl Debug) -> String {
        sha256_hex(format!("{}inputs {inputs:?}\n", self.context).as_bytes())
    }

    /// Returns the evaluation with this key, if the cache has an undamaged one.
    pub fn get(&self, key: &str) -> Option<Evaluation> {
        let text = files::read_text(&self.path(key), LARGEST_OWN).ok()?;
        let (content, _) = unseal(text.strip_suffix('\n')?).ok()?;
        let evaluation = serde_json::from_str(&content).ok()?;
        self.hits.fetch_add(1, Ordering::Relaxed);
        Some(evaluation)
    }

    /// Stores an evaluation. A write error does not stop the study; see [`problem`](Self::problem).
    pub fn put(&self, key: &str, evaluation: &Evaluation) {
        let write = || {
            let path = self.path(key);
            fs::create_dir_all(path.parent().unwrap_or(&self.dir))?;
            files::write_atomic(&path, seal(evaluation, None)?.as_bytes())
        };
        if let Err(error) = write() {
            self.problem.get_or_init(|| error);
        }
    }

    /// Returns the number of evaluations read from the cache.
    pub fn hits(&self) -> u64 {
        self.hits.load(Ordering::Relaxed)
    }

    /// Returns the first write error, if there is one.
    pub fn problem(&self) -> Option<String> {
        self.problem.get().map(|error| format!("{}: {error}", self.dir.display()))
    }

    fn path(&self, key: &str) -> PathBuf {
        let (folder, name) = key.split_at(2);
        self.dir.join(folder).join(format!("{name}.json"))
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use input::shipped::ROBOTS;
    use insertion::evaluation::tolerance::{Search, evaluate};
    use insertion::finger::Finger;
    use insertion::tests::fake::FakeRig;
    use insertion::trial::engine::EngineKind;

    pub fn sound() -> Evaluation {
        evaluate(&FakeRig::default(), &Finger::new(3e3, 2e4), Search::Strides)
    }

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
    fn an_evaluation_is_found_by_its_own_inputs_only() {
        let dir = tempfile::tempdir().unwrap();
        let cache = cache(dir.path());
        let (a, b) = (cache.key(&0.1), cache.key(&(0.1 + f64::EPSILON)));
        assert_eq!(cache.get(&a), None);
        cache.put(&a, &sound());
        assert_eq!(cache.get(&a), Some(sound()));
        assert_eq!((cache.get(&b), cache.hits(), cache.problem()), (None, 1, None));
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
    fn a_torn_or_damaged_file_counts_as_missing_and_is_written_again() {
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
    fn a_folder_that_cannot_be_written_is_reported_and_harms_nothing() {
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
