//! Studies: read from their folders, and run by whoever measures.

use crate::errors::{InputError, Refused, StudyError, raise};
use crate::keywords::{Keywords, TaskWord};
use crate::measure::{interruptible, released, watched};
use ::study::{Ending, SOURCES, StudyRecord, evaluations_csv};
use finger_opt::cli::call;
use finger_opt::session::{
    self, AnyStudy, Failure, NotTaken, Order, POLISH, ResumeRequest, StudyRequest,
};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use serde_json::json;
use std::ffi::OsString;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Ends what a run still performs in this process.
#[pyclass(frozen)]
pub struct Stop(AtomicBool);

#[pymethods]
impl Stop {
    #[new]
    fn new() -> Self {
        Stop(AtomicBool::new(false))
    }

    fn set(&self) {
        self.0.store(true, Ordering::SeqCst);
    }
}

/// The unit of work: bytes in, bytes out; ends early once `stop` is set.
#[pyfunction]
pub fn perform<'py>(
    py: Python<'py>,
    work: &[u8],
    worker: &str,
    stop: &Stop,
) -> PyResult<Bound<'py, PyBytes>> {
    let work = work.to_vec();
    let done = watched(py, &stop.0, || session::perform(&work, worker, &stop.0))?;
    // Ended by `stop`: nobody pressed Ctrl-C here.
    let failed = |failure| match failure {
        Failure::Interrupted(_) => StudyError::new_err(failure.to_string()),
        failure => raise(failure),
    };
    Ok(PyBytes::new(py, &done.map_err(failed)?))
}

/// SHA-256 of the sources of this build.
#[pyfunction]
pub fn source_sha256() -> &'static str {
    SOURCES
}

/// A study that is asked for.
#[pyclass(frozen)]
pub struct Asked(call::Asked);

impl Asked {
    fn of(study: AnyStudy) -> Self {
        Asked(call::Asked { study, executor: None, shown: call::Shown::default() })
    }
}

/// The study of these tasks and keywords.
#[pyfunction]
#[pyo3(signature = (tasks, /, **settings))]
pub fn study<'py>(
    py: Python<'py>,
    tasks: Vec<TaskWord>,
    settings: Option<&Bound<'py, PyDict>>,
) -> PyResult<Asked> {
    let words = Keywords::new(py, settings)?;
    let budget = words.take("budget")?;
    let usual = StudyRequest::new(words.setup(tasks)?, budget);
    let request = StudyRequest {
        polish: words.number_or("polish", POLISH)?.unwrap_or(usual.polish),
        indifference_mm: words.take("indifference_mm")?.unwrap_or(usual.indifference_mm),
        optimizer: words.listed("optimizer")?.unwrap_or(usual.optimizer),
        objective: words.listed("objective")?.unwrap_or(usual.objective),
        constraints: words.parsed("constraint")?,
        uncertainty: words.text("uncertainty")?,
        measurements: words.text("measurements")?,
        priors: words.text("priors")?,
        aggregate: words.choice("aggregate")?,
        weights: words.numbers("weights")?,
        seed: words.take("seed")?.unwrap_or(usual.seed),
        batch: words.take("batch")?,
        asynchronous: words.flag("async")?,
        out: words.take("out")?,
        run: words.run()?,
        ..usual
    };
    words.finish()?;
    Ok(Asked::of(AnyStudy::Asked(Box::new(request))))
}

/// The study in a folder, to be gone on with.
#[pyfunction]
#[pyo3(signature = (folder, /, **settings))]
pub fn resume<'py>(
    py: Python<'py>,
    folder: PathBuf,
    settings: Option<&Bound<'py, PyDict>>,
) -> PyResult<Asked> {
    let words = Keywords::new(py, settings)?;
    let request = ResumeRequest { dir: folder, run: words.run()? };
    words.finish()?;
    Ok(Asked::of(AnyStudy::Resumed(request)))
}

/// The study of these words of the command line.
#[pyfunction]
pub fn asked(words: Vec<OsString>) -> PyResult<Asked> {
    call::asked(&words).map(Asked).map_err(raise)
}

#[pymethods]
impl Asked {
    /// Where it is measured.
    #[getter]
    fn executor(&self) -> Option<&str> {
        self.0.executor.as_deref()
    }

    /// Whether no progress is shown.
    #[getter]
    fn quiet(&self) -> bool {
        self.0.shown.quiet
    }

    /// Its folder, with all checked that is asked for.
    fn folder(&self, py: Python<'_>) -> PyResult<PathBuf> {
        released(py, || self.0.study.folder())?.map_err(raise)
    }

    /// Begins it or goes on with it.
    fn open(&self, py: Python<'_>, workers: Option<u64>) -> PyResult<Guided> {
        let open = || self.0.study.open(workers).and_then(|open| call::warned(open)?.guided());
        let opened = released(py, open)?.map_err(raise)?;
        Ok(Guided { open: Mutex::new(Some(opened)), shown: self.0.shown })
    }
}

/// A study as its folder holds it now.
#[pyclass(frozen)]
pub struct Recorded {
    folder: PathBuf,
    record: StudyRecord,
}

#[pymethods]
impl Recorded {
    #[new]
    fn new(py: Python<'_>, folder: PathBuf) -> PyResult<Self> {
        let read = py.allow_threads(|| StudyRecord::load(&folder));
        let record = read.map_err(|error| raise(error.into()))?;
        Ok(Recorded { folder, record })
    }

    /// Configuration asked for, as `study.toml` has it, as JSON.
    fn config(&self) -> String {
        json!(self.record.config).to_string()
    }

    /// How many evaluations its journal holds.
    fn length(&self) -> usize {
        self.record.evaluations.len()
    }

    fn settled(&self) -> bool {
        self.record.settled
    }

    fn best(&self) -> String {
        call::best(&self.record).to_string()
    }

    fn answer(&self) -> String {
        call::answer(&self.record, &self.folder).to_string()
    }

    /// The text of `evaluations.csv`.
    fn table(&self) -> PyResult<String> {
        evaluations_csv(&self.folder, &self.record).map_err(|error| raise(error.into()))
    }

    /// The answer as a piece of HTML.
    fn card(&self) -> String {
        report::card(&self.record, &self.folder)
    }
}

/// A study that is open and whose measuring the caller does.
#[pyclass(frozen)]
pub struct Guided {
    open: Mutex<Option<session::Guided>>,
    /// Whether its result is printed as JSON.
    shown: call::Shown,
}

/// Work to be measured (none: wait for a result), and how the study ended, if it did.
type Next<'py> = (Vec<(u64, Bound<'py, PyBytes>)>, Option<&'static str>);

impl Guided {
    fn study(&self) -> MutexGuard<'_, Option<session::Guided>> {
        self.open.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Does something with the study, without the interpreter's lock.
    fn with<T: Send>(
        &self,
        py: Python<'_>,
        what: impl FnOnce(&mut session::Guided) -> T + Send,
    ) -> PyResult<T> {
        let done = released(py, || self.study().as_mut().map(what))?;
        done.ok_or_else(|| StudyError::new_err("the study is closed"))
    }
}

const ENDINGS: [(Ending, &str); 5] = [
    (Ending::BudgetSpent, "budget_spent"),
    (Ending::SpaceExhausted, "space_exhausted"),
    (Ending::Converged, "converged"),
    (Ending::Settled, "settled"),
    (Ending::NothingInserts, "nothing_inserts"),
];

#[pymethods]
impl Guided {
    fn next<'py>(&self, py: Python<'py>) -> PyResult<Next<'py>> {
        let order = interruptible(py, |stop: &AtomicBool| {
            self.study().as_mut().map(|study| study.order(stop))
        })?;
        let order = order.ok_or_else(|| StudyError::new_err("the study is closed"))?;
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

    /// Output of the command at the end, and why it fails all the same, if so.
    fn finish(&self, py: Python<'_>, ending: &str) -> PyResult<(String, Option<String>)> {
        let ending = ENDINGS.iter().find(|(_, word)| *word == ending);
        let ending = ending.map(|(ending, _)| *ending);
        let ending = ending.ok_or_else(|| InputError::new_err("ending: is none"))?;
        let finish =
            |stop: &AtomicBool| self.study().as_mut().map(|study| study.finish(ending, stop));
        let done = interruptible(py, finish)?;
        let ended = done.ok_or_else(|| StudyError::new_err("the study is closed"))?;
        let ended = ended.map_err(raise)?;
        let unusable = ended.unusable.as_ref().map(ToString::to_string);
        let around = interruptible(py, |stop: &AtomicBool| ended.around(stop))?.map_err(raise)?;
        Ok((call::text(&ended, &around, self.shown), unusable))
    }

    /// Lets other processes open the study.
    fn close(&self, py: Python<'_>) {
        py.allow_threads(|| *self.study() = None);
    }
}
