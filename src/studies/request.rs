//! Requests of studies whose designs the caller evaluates.

use super::open::OpenStudy;
use crate::commands::{resume, study};
use crate::{Failure, RunRequest};
use std::path::PathBuf;

/// Request to begin or resume a study.
#[derive(Debug, Clone)]
pub enum AnyStudy {
    /// Begin a study, or continue the one in its folder.
    Asked(Box<study::Request>),
    /// Resume the study in a folder.
    Resumed(resume::Request),
}

impl AnyStudy {
    /// Returns the request to begin a study.
    pub fn asked(request: study::Request) -> Self {
        AnyStudy::Asked(Box::new(request))
    }

    /// Returns the options of the run, and whether all numbers on which the answer is based are printed.
    pub fn run_options(&self) -> (&RunRequest, bool) {
        match self {
            AnyStudy::Asked(request) => (&request.run, request.verbose),
            AnyStudy::Resumed(request) => (&request.run, request.verbose),
        }
    }

    /// Opens the study; `workers` is the default batch size of a new one.
    ///
    /// # Errors
    /// If the request or the folder is invalid.
    pub fn open(&self, workers: Option<u64>) -> Result<OpenStudy, Failure> {
        match self {
            AnyStudy::Asked(request) => request.open(workers),
            AnyStudy::Resumed(request) => request.open(),
        }
    }

    /// Writes the study without evaluating designs and returns its folder.
    ///
    /// # Errors
    /// If the request is invalid, or the folder holds a study of another configuration or cannot be written.
    pub fn create(&self) -> Result<PathBuf, Failure> {
        match self {
            AnyStudy::Asked(request) => request.create(),
            AnyStudy::Resumed(request) => Ok(request.dir.clone()),
        }
    }
}
