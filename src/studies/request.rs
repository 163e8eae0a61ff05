//! Studies for callers that measure themselves.

use super::open::OpenStudy;
use crate::commands::{resume, study};
use crate::failure::Failure;
use crate::setup::run::RunRequest;
use std::path::PathBuf;

/// A study that is begun, or gone on with.
#[derive(Debug, Clone)]
pub enum AnyStudy {
    /// By what it measures.
    Asked(Box<study::Request>),
    /// By its folder.
    Resumed(resume::Request),
}

impl AnyStudy {
    /// Returns the study that is asked for by what it measures.
    pub fn asked(request: study::Request) -> Self {
        AnyStudy::Asked(Box::new(request))
    }

    /// Returns how it is run, and whether all numbers behind the answer are printed.
    pub fn how(&self) -> (&RunRequest, bool) {
        match self {
            AnyStudy::Asked(request) => (&request.run, request.verbose),
            AnyStudy::Resumed(request) => (&request.run, request.verbose),
        }
    }

    /// Opens it; where no batch is given a new study's is `workers`.
    pub fn open(&self, workers: Option<u64>) -> Result<OpenStudy, Failure> {
        match self {
            AnyStudy::Asked(request) => request.open(workers),
            AnyStudy::Resumed(request) => request.open(),
        }
    }

    /// Its folder, with all checked that is asked for; nothing is written.
    pub fn folder(&self) -> Result<PathBuf, Failure> {
        match self {
            AnyStudy::Asked(request) => Ok(request.look()?.2),
            AnyStudy::Resumed(request) => Ok(request.dir.clone()),
        }
    }
}
