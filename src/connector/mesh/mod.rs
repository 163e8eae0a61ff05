//! Plug and socket from triangle meshes: read, checked, cut into convex parts, measured.

mod cut;
mod decompose;
pub mod import;
mod merge;
mod read;
mod reduce;
mod surface;

use super::plan::PlanError;
pub use read::read;
pub use surface::Surface;

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
