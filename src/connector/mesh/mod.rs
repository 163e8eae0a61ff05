//! Plug and socket from triangle meshes: read, checked, cut into convex parts, measured.

mod cut;
mod decompose;
pub mod import;
mod intrusion;
mod merge;
mod read;
mod reduce;
mod surface;

use super::plan::PlanError;
use decompose::MOST_PARTS;
use import::MOST_FACES;
use input::units::MM;
pub use read::read;
use reduce::TOLERANCE;
pub use surface::Surface;

/// Error of an import.
#[derive(Debug, thiserror::Error, PartialEq)]
pub enum MeshError {
    /// File and its fault.
    #[error("{0}: {1}")]
    File(String, Fault),
    /// No strategy can be derived for the shapes.
    #[error(transparent)]
    Plan(#[from] PlanError),
}

/// Fault of a mesh.
#[derive(Debug, thiserror::Error, PartialEq)]
pub enum Fault {
    /// Neither STL nor OBJ, with the reason.
    #[error("is neither an STL nor an OBJ file: {0}")]
    Format(String),
    /// Open edges: their number, and the middle of the first, mm.
    #[error(
        "is not watertight: {0} edges have a face on one side only, the first at {1:?} mm \
         (as in the file, scaled); close the surface in your CAD or with a mesh repair"
    )]
    Open(usize, [f64; 3]),
    /// Edges between faces of opposite orientation: their number, and the middle of the first, mm.
    #[error(
        "{0} edges lie between faces that look to opposite sides, the first at {1:?} mm; \
         let all normals point outward"
    )]
    Orientation(usize, [f64; 3]),
    /// No volume.
    #[error("holds no volume")]
    Flat,
    /// Largest extent, mm, of no connector, and a hint at the unit.
    #[error("is {0:.3} mm long; connectors are 3 to 300 mm: {1}")]
    Size(f64, &'static str),
    /// No opening, seen along the option given.
    #[error("has no opening on its top ({0}): no closed hole goes in from there")]
    NoOpening(String),
    /// No place to hold the plug.
    #[error(
        "no place to hold the plug was found: two faces across y, with a shoulder above them for \
         the fingers' roofs; give --like T, whose grip fits, or write [grip] by hand"
    )]
    NoGrip,
    /// An approximation that would take minutes.
    #[error(
        "is no solid of flat sides that up to {MOST_PARTS} convex pieces make, and approximating it \
         with --resolution {resolution} would take minutes: give --resolution {finest} or less, export \
         the mesh with fewer flats (a circle of 32 is exact), begin with `optimize task new --round`, \
         or write its parts by hand (docs/guide/tasks.md)"
    )]
    Long {
        /// Resolution requested, voxels along the longest side.
        resolution: u32,
        /// Finest resolution that does not take as long.
        finest: u32,
    },
    /// Number of faces of the file, and of those left within the tolerance of a reduction.
    #[error(
        "has {0} faces, and {1} where all within {tolerance} mm is made flat; at most {MOST_FACES} are \
         taken: leave out threads, text and knurls, or export the mesh more coarsely",
        tolerance = TOLERANCE / MM
    )]
    Faces(usize, usize),
    /// Number of convex hulls, more than the parts a task may have.
    #[error(
        "comes to {0} convex hulls; a task may have {MOST_PARTS}: export the mesh with fewer \
         flats (a circle of 32 is exact), begin with `optimize task new --round`, or write its parts \
         by hand (docs/guide/tasks.md)"
    )]
    Many(usize),
}

impl Fault {
    fn of(self, file: &str) -> MeshError {
        MeshError::File(file.to_owned(), self)
    }
}
