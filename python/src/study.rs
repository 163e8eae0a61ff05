//! Studies: records, and studies whose designs Python measures.

use crate::call::{interruptible, read, released, watched};
use crate::errors::{InputError, Refused, StudyError, exception};
use ::study::{SOURCES, StudyRecord, evaluations_csv};
use finger_opt::command::parse;
use finger_opt::commands::resume;
use finger_opt::keywords::request;
use finger_opt::program::program;
use finger_opt::studies::ask_tell::{self, NextStep, RejectedResult};
use finger_opt::studies::recommended;
use finger_opt::studies::request::AnyStudy;
use finger_opt::studies::summary::summary;
use finger_opt::studies::text;
use finger_opt::{Context, Failure};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use report::answer::Answer;
use serde_json::json;
use std::ffi::OsString;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Cancellation of the work in this process.
#[pyclass(frozen)]
pub struct Stop(pub AtomicBool);

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

/// Measures a unit of work, given as bytes, and returns its result as bytes; ends early once `stop` is set.
#[pyfunction]
pub fn perform<'py>(
    py: Python<'py>,
    work: &[u8],
    worker: &str,
    stop: &Stop,
) -> PyResult<Bound<'py, PyBytes>> {
    let work = work.to_vec();
    let done = watched(py, &stop.0, || ask_tell::perform(&work, worker, &stop.0))?;
    // Cancelled by `stop`, not by Ctrl-C.
    let failed = |failure| match failure {
        Failure::Interrupted(_) => StudyError::new_err(failure.to_string()),
        failure => exception(failure),
    };
    Ok(PyBytes::new(py, &done.map_err(failed)?))
}

/// Returns the SHA-256 of the sources of this build.
#[pyfunction]
pub fn source_sha256() -> &'static str {
    SOURCES
}

/// Request of a study, and the form of its output.
#[pyclass(frozen)]
pub struct StudyRequest {
    study: AnyStudy,
    /// Executor, if one was requested.
    #[pyo3(get)]
    executor: Option<String>,
    /// Whether progress is hidden.
    #[pyo3(get)]
    quiet: bool,
    format: OutputFormat,
}

/// Form of the output of a study.
#[derive(Clone, Copy, Default)]
struct OutputFormat {
    json: bool,
    verbose: bool,
}

impl StudyRequest {
    fn of(study: AnyStudy) -> Self {
        StudyRequest { study, executor: None, quiet: false, format: OutputFormat::default() }
    }
}

#[pymethods]
impl StudyRequest {
    /// Creates the request for a study with these keywords.
    #[new]
    fn new(keywords: &str) -> PyResult<Self> {
        Ok(StudyRequest::of(AnyStudy::asked(request(&read(keywords)?).map_err(exception)?)))
    }

    /// Creates the request to continue the study in a folder with these keywords.
    #[staticmethod]
    fn resumed(folder: PathBuf, keywords: &str) -> PyResult<Self> {
        let run = request(&read(keywords)?).map_err(exception)?;
        let request = resume::Request { dir: folder, run, verbose: false };
        Ok(StudyRequest::of(AnyStudy::Resumed(request)))
    }

    /// Creates the request from the words of a command line.
    #[staticmethod]
    fn in_words(words: Vec<OsString>) -> PyResult<Self> {
        let has = |flag: &str| words.iter().any(|word| word == flag);
        let (json, quiet) = (has("--json"), has("--quiet"));
        let read = match words.split_first() {
            Some((first, rest)) if first == "resume" => parse(rest).map(AnyStudy::Resumed),
            Some((first, rest)) if first == "study" => parse(rest).map(AnyStudy::asked),
            _ => parse(&words).map(AnyStudy::asked),
        };
        let study = read.map_err(exception)?;
        let (run, verbose) = study.run_options();
        let (executor, format) = (run.executor.clone(), OutputFormat { json, verbose });
        Ok(StudyRequest { study, executor, quiet, format })
    }

    /// Writes the study without measuring and returns its folder.
    fn create(&self, py: Python<'_>) -> PyResult<PathBuf> {
        released(py, || self.study.create())?.map_err(exception)
    }

    /// Starts or continues the study.
    fn open(&self, py: Python<'_>, workers: Option<u64>) -> PyResult<AskTellStudy> {
        let open = || {
            let open = self.study.open(workers)?;
            open.warn(&Context::terminal(self.format.json, true, program))?;
            ask_tell::AskTellStudy::new(open)
        };
        let opened = released(py, open)?.map_err(exception)?;
        Ok(AskTellStudy { open: Mutex::new(Some(opened)), format: self.format })
    }
}

/// Record of a study in its folder.
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
        Ok(Recorded { folder, record: read.map_err(|error| exception(error.into()))? })
    }

    /// Returns the configuration of `study.toml` as JSON.
    fn config(&self) -> String {
        json!(self.record.config).to_string()
    }

    /// Returns the number of evaluations in its journal.
    fn length(&self) -> usize {
        self.record.evaluations.len()
    }

    fn settled(&self) -> bool {
        self.record.settled
    }

    fn best(&self) -> String {
        recommended::best(&Answer::of(&self.record)).to_string()
    }

    fn answer(&self) -> String {
        recommended::advice(&Answer::of(&self.record), &self.folder).to_string()
    }

    /// Returns the text of `evaluations.csv`.
    fn table(&self) -> PyResult<String> {
        evaluations_csv(&self.folder, &self.record).map_err(|error| exception(error.into()))
    }

    /// Returns the answer as an HTML fragment.
    fn card(&self) -> String {
        report::card(&Answer::of(&self.record), &self.folder)
    }
}

/// Open study whose designs the caller measures.
#[pyclass(frozen)]
pub struct AskTellStudy {
    open: Mutex<Option<ask_tell::AskTellStudy>>,
    /// Form of its output.
    format: OutputFormat,
}

/// Work to be measured, empty if the caller has to wait for a result, and the ending once the study has ended.
type Next<'py> = (Vec<(u64, Bound<'py, PyBytes>)>, Option<String>);

impl AskTellStudy {
    fn lock(&self) -> MutexGuard<'_, Option<ask_tell::AskTellStudy>> {
        self.open.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Calls `action` with the study.
    fn with<T>(&self, action: impl FnOnce(&mut ask_tell::AskTellStudy) -> T) -> PyResult<T> {
        self.lock().as_mut().map(action).ok_or_else(|| StudyError::new_err("the study is closed"))
    }
}

#[pymethods]
impl AskTellStudy {
    fn next<'py>(&self, py: Python<'py>) -> PyResult<Next<'py>> {
        let step = interruptible(py, |stop| self.with(|study| study.next_step(stop)))??;
        Ok(match step.map_err(exception)? {
            NextStep::Wait => (Vec::new(), None),
            NextStep::Evaluate(work) => {
                let bytes = |(proposal, work): (u64, Vec<u8>)| (proposal, PyBytes::new(py, &work));
                (work.into_iter().map(bytes).collect(), None)
            }
            NextStep::Finish(ending) => (Vec::new(), json!(ending).as_str().map(str::to_owned)),
        })
    }

    fn take(&self, py: Python<'_>, proposal: u64, result: &[u8]) -> PyResult<bool> {
        let result = result.to_vec();
        let taken = released(py, || self.with(|study| study.take(proposal, &result)))??;
        taken.map_err(|why| match why {
            RejectedResult::Refused(error) => Refused::new_err(error.to_string()),
            RejectedResult::Failed(failure) => exception(failure),
        })
    }

    fn progress(&self, py: Python<'_>) -> PyResult<(usize, u64, String)> {
        released(py, || self.with(|study| study.progress()))?
    }

    fn hint(&self, py: Python<'_>) -> PyResult<String> {
        released(py, || self.with(|study| study.hint()))?
    }

    fn threads(&self, py: Python<'_>) -> PyResult<usize> {
        released(py, || self.with(|study| study.threads()))?
    }

    /// Returns the output of the command, and the reason for which the study has no result, if there is one.
    fn finish(&self, py: Python<'_>, ending: &str) -> PyResult<(String, Option<String>)> {
        let ending = serde_json::from_value(json!(ending));
        let ending = ending.map_err(|error| InputError::new_err(format!("ending: {error}")))?;
        let ended = interruptible(py, |stop| self.with(|study| study.finish(ending, stop)))??;
        let ended = ended.map_err(exception)?;
        let unusable = ended.unusable.as_ref().map(ToString::to_string);
        let answer = Answer::of(&ended.record);
        let analyse = |stop: &AtomicBool| ended.analyse(&answer, &Context::silent(stop));
        let analyses = interruptible(py, analyse)?.map_err(exception)?;
        let text = match self.format.json {
            true => summary(&ended, &answer, &analyses).to_string() + "\n",
            false => {
                let answered = text::ended(&ended, &answer, self.format.verbose);
                answered + &text::analyses(&analyses) + &text::next(&answer, &ended.dir)
            }
        };
        Ok((text, unusable))
    }

    /// Closes the study, so that other processes can open it.
    fn close(&self, py: Python<'_>) {
        py.allow_threads(|| *self.lock() = None);
    }
}
