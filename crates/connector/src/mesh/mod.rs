//! Plug and socket from triangle meshes: read, mated, covered with convex parts, checked.

pub mod axes;
pub mod mated;
mod mend;
mod read;
mod reduce;
pub mod skin;
mod solid;
mod surface;

use input::{Place, Placed};
pub use read::{Body, Triangle, is_step, pick, read, separate};
pub use reduce::{TOLERANCE, reduced};
pub use surface::{SIZES, Surface};

/// Names of the files of plug and socket, for messages.
pub type Files<'a> = [&'a str; 2];

impl Placed for MeshError {
    fn place(&self) -> Place {
        match self {
            MeshError::File(file, _) => Place::file(file),
        }
    }
}

/// Error of an import.
#[derive(Debug, thiserror::Error, PartialEq)]
pub enum MeshError {
    /// File and its fault, with advice.
    #[error("{0}: {1}")]
    File(String, String),
}
