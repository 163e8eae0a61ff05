//! Plug and socket from triangle meshes: read, checked, cut into convex parts, measured.

mod axes;
mod cut;
mod decompose;
pub mod import;
pub mod mated;
mod mend;
mod merge;
pub mod place;
mod read;
mod reduce;
pub mod skin;
mod surface;

use super::plan::PlanError;
use input::{Place, Placed};
pub use read::{Body, Triangle, is_step, pick, read, separate};
pub use surface::{SIZES, Surface};

/// Names of the files of plug and socket, for messages.
pub type Files<'a> = [&'a str; 2];

impl Placed for MeshError {
    fn place(&self) -> Place {
        match self {
            MeshError::File(file, _) => Place::file(file),
            MeshError::Plan(_) => Place::default(),
        }
    }
}

/// Error of an import.
#[derive(Debug, thiserror::Error, PartialEq)]
pub enum MeshError {
    /// File and its fault, with advice.
    #[error("{0}: {1}")]
    File(String, String),
    /// No strategy can be derived for the shapes.
    #[error(transparent)]
    Plan(#[from] PlanError),
}
