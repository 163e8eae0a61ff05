//! Studies with their journals in memory.

use ask_tell::{Grid, Optimizer};
use insertion::evaluation::evaluator::Evaluate;
use std::io;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex};
use study::{Ending, Runner, Store, Study, StudyError, StudyRecord, strip_times};

/// Memory whose operations fail from a given one on, as a full disk's do.
#[derive(Clone, Default)]
pub struct Memory {
    pub bytes: Arc<Mutex<Vec<u8>>>,
    /// Operations left before the failures, if there are any.
    pub left: Option<u32>,
    /// Whether cutting back fails as well.
    pub truncate_fails: bool,
}

impl Memory {
    pub fn journal(&self) -> String {
        strip_times(std::str::from_utf8(&self.bytes.lock().unwrap()).unwrap())
    }
}

impl Store for Memory {
    fn read(&mut self) -> io::Result<Vec<u8>> {
        Ok(self.bytes.lock().unwrap().clone())
    }

    fn append(&mut self, bytes: &[u8]) -> io::Result<()> {
        let fails = self.left == Some(0);
        let written = if fails { &bytes[..bytes.len() / 2] } else { bytes };
        self.bytes.lock().unwrap().extend_from_slice(written);
        if fails {
            return Err(io::ErrorKind::StorageFull.into());
        }
        self.left = self.left.map(|left| left - 1);
        Ok(())
    }

    fn truncate(&mut self, len: u64) -> io::Result<()> {
        if self.left == Some(0) && self.truncate_fails {
            return Err(io::ErrorKind::StorageFull.into());
        }
        self.bytes.lock().unwrap().truncate(len as usize);
        Ok(())
    }
}

/// Runs the study in a folder on so many threads.
pub fn run(
    dir: &Path,
    store: &Memory,
    evaluator: &dyn Evaluate,
    optimizer: &dyn Fn(Grid) -> Box<dyn Optimizer>,
    threads: usize,
) -> Result<(Ending, StudyRecord), StudyError> {
    let mut study = Study::resume_with(dir, Box::new(store.clone()))?;
    let mut optimizer = optimizer(Grid::new(study.config.space.levels()));
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let stop = &AtomicBool::new(false);
    let runner = Runner { evaluator, pool: &pool, stop };
    let ending = runner.run(&mut study, &mut *optimizer, &mut |_, _| Ok(false), &mut |_| ())?;
    Ok((ending, study.record()))
}
