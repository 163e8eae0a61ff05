//! Studies: read from their folders, and run by whoever measures.

use crate::errors::{InputError, Refused, RunError, raise};
use crate::measure::{Files, interruptible, sources};
use finger_opt::cli::call;
use finger_opt::cli::guided::{self, NotTaken, Order};
use finger_opt::study::{Ending, SOURCES};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Set while what this process performs is to end early.
static STOP: AtomicBool = AtomicBool::new(false);

/// The unit of work: bytes in, bytes out.
#[pyfunction]
pub fn perform<'py>(py: Python<'py>, work: &[u8], worker: &str) -> PyResult<Bound<'py, PyBytes>> {
    let work = work.to_vec();
    let done = py.allow_threads(|| guided::perform(&work, worker, &STOP)).map_err(raise)?;
    Ok(PyBytes::new(py, &done))
}

/// Whether what this process performs is to end early.
#[pyfunction]
pub fn stop_performing(stop: bool) {
    STOP.store(stop, Ordering::SeqCst);
}

/// SHA-256 of the sources of this build.
#[pyfunction]
pub fn source_sha256() -> &'static str {
    SOURCES
}

/// Where the study of these words is measured, and whether quietly.
#[pyfunction]
pub fn session(words: Vec<String>) -> PyResult<(Option<String>, bool)> {
    call::session(&words).map_err(raise)
}

/// The folder of the study of these words, which are checked.
#[pyfunction]
pub fn study_folder(py: Python<'_>, words: Vec<String>, files: Files) -> PyResult<PathBuf> {
    let tasks = sources(files);
    py.allow_threads(|| call::study_folder(&words, &tasks)).map_err(raise)
}

/// A study as its folder holds it now.
#[pyclass(frozen)]
pub struct Recorded(call::Read);

#[pymethods]
impl Recorded {
    #[new]
    fn new(py: Python<'_>, folder: PathBuf) -> PyResult<Self> {
        py.allow_threads(|| call::Read::new(&folder)).map(Recorded).map_err(raise)
    }

    fn config(&self) -> String {
        self.0.config().to_string()
    }

    fn length(&self) -> usize {
        self.0.length()
    }

    fn best(&self) -> String {
        self.0.best().to_string()
    }

    fn table(&self) -> PyResult<String> {
        self.0.table().map_err(raise)
    }

    fn card(&self) -> String {
        self.0.card()
    }
}

/// A study that is open and whose measuring the caller does.
#[pyclass(frozen)]
pub struct Guided(Mutex<Option<guided::Guided>>);

/// What is to be measured (none: wait for a result), and how the study ended, if it did.
type Next<'py> = (Vec<(u64, Bound<'py, PyBytes>)>, Option<&'static str>);

impl Guided {
    fn of(study: guided::Guided) -> Self {
        Guided(Mutex::new(Some(study)))
    }

    fn open(&self) -> MutexGuard<'_, Option<guided::Guided>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Does something with the study, without the interpreter's lock.
    fn with<T: Send>(
        &self,
        py: Python<'_>,
        what: impl FnOnce(&mut guided::Guided) -> T + Send,
    ) -> PyResult<T> {
        let done = py.allow_threads(|| self.open().as_mut().map(what));
        done.ok_or_else(|| RunError::new_err("the study is closed"))
    }
}

const ENDINGS: [(Ending, &str); 3] = [
    (Ending::BudgetSpent, "budget_spent"),
    (Ending::SpaceExhausted, "space_exhausted"),
    (Ending::Converged, "converged"),
];

#[pymethods]
impl Guided {
    /// Begins or continues the study of these words.
    #[staticmethod]
    fn begin(
        py: Python<'_>,
        words: Vec<String>,
        files: Files,
        workers: Option<u64>,
    ) -> PyResult<Self> {
        let tasks = sources(files);
        let begun = py.allow_threads(|| guided::Guided::begin(&words, &tasks, workers));
        begun.map(Guided::of).map_err(raise)
    }

    /// Continues the study in a folder.
    #[staticmethod]
    fn resume(py: Python<'_>, words: Vec<String>) -> PyResult<Self> {
        py.allow_threads(|| guided::Guided::resume(&words)).map(Guided::of).map_err(raise)
    }

    fn next<'py>(&self, py: Python<'py>) -> PyResult<Next<'py>> {
        let order = interruptible(py, |_| self.open().as_mut().map(guided::Guided::order))?;
        let order = order.ok_or_else(|| RunError::new_err("the study is closed"))?;
        Ok(match order.map_err(raise)? {
            Order::Wait => (Vec::new(), None),
            Order::Measure(work) => {
                let bytes = |(proposal, work): (u64, Vec<u8>)| (proposal, PyBytes::new(py, &work));
                (work.into_iter().map(bytes).collect(), None)
            }
            Order::Finish(ending) => {
                let word = ENDINGS.iter().find(|(known, _)| *known == ending);
                (Vec::new(), Some(word.map_or("interrupted", |(_, word)| word)))
            }
        })
    }

    fn take(&self, py: Python<'_>, proposal: u64, result: &[u8]) -> PyResult<bool> {
        let result = result.to_vec();
        self.with(py, |study| study.take(proposal, &result))?.map_err(|why| match why {
            NotTaken::Refused(error) => Refused::new_err(error.to_string()),
            NotTaken::Failed(failure) => raise(failure),
        })
    }

    fn progress(&self, py: Python<'_>) -> PyResult<(usize, u64, String)> {
        self.with(py, |study| study.progress())
    }

    fn hint(&self, py: Python<'_>) -> PyResult<String> {
        self.with(py, |study| study.hint())
    }

    fn threads(&self, py: Python<'_>) -> PyResult<usize> {
        self.with(py, |study| study.threads())
    }

    /// What the command prints at the end, and why it fails all the same, if so.
    fn finish(&self, py: Python<'_>, ending: &str) -> PyResult<(String, Option<String>)> {
        let ending = ENDINGS.iter().find(|(_, word)| *word == ending);
        let ending = ending.map(|(ending, _)| *ending);
        let ending = ending.ok_or_else(|| InputError::new_err("ending: is none"))?;
        let finish =
            |stop: &AtomicBool| self.open().as_mut().map(|study| study.finish(ending, stop));
        let done = interruptible(py, finish)?;
        let (text, failure) =
            done.ok_or_else(|| RunError::new_err("the study is closed"))?.map_err(raise)?;
        Ok((text, failure.map(|failure| failure.to_string())))
    }

    /// Lets other processes open the study.
    fn close(&self, py: Python<'_>) {
        py.allow_threads(|| *self.open() = None);
    }
}
