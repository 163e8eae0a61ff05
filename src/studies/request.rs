//! Studies for callers that measure themselves.

use super::open::OpenStudy;
use crate::commands::{resume, study};
use crate::failure::Failure;
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
