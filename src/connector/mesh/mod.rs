//! Plug and socket from triangle meshes: read, checked, cut into convex parts, measured.

mod cut;
mod decompose;
pub mod import;
mod intrusion;
mod merge;
mod read;
mod surface;

use decompose::MOST_PARTS;
pub use read::read;
pub use surface::Surface;

/// Why a mesh cannot be used.
#[derive(Debug, thiserror::Error, PartialEq)]
pub enum MeshError {
    /// Neither STL nor OBJ.
    #[error("{file}: is neither an STL nor an OBJ file: {problem}")]
    Format {
        /// The file.
        file: String,
        /// What was found.
        problem: String,
    },
    /// Open edges.
    #[error(
        "{file}: is not watertight: {edges} edges have a face on one side only, the first at {at_mm:?} mm \
         (as in the file, scaled); close the surface in your CAD or with a mesh repair"
    )]
    Open {
        /// The file.
        file: String,
        /// How many.
        edges: usize,
        /// The middle of one of them, mm.
        at_mm: [f64; 3],
    },
    /// Neighbouring faces that look to opposite sides.
    #[error(
        "{file}: {edges} edges lie between faces that look to opposite sides, the first at {at_mm:?} mm; \
         let all normals point outward"
    )]
    Orientation {
        /// The file.
        file: String,
        /// How many.
        edges: usize,
        /// The middle of one of them, mm.
        at_mm: [f64; 3],
    },
    /// Nothing inside.
    #[error("{file}: holds no volume")]
    Flat {
        /// The file.
        file: String,
    },
    /// Too large or too small.
    #[error("{file}: is {size_mm:.3} mm long; connectors are 3 to 300 mm: {hint}")]
    Size {
        /// The file.
        file: String,
        /// Largest extent, mm.
        size_mm: f64,
        /// Which unit it may be in.
        hint: &'static str,
    },
    /// No opening.
    #[error("{file}: has no opening on its top ({along}): no closed hole goes in from there")]
    NoOpening {
        /// The file.
        file: String,
        /// Where the top was looked for.
        along: String,
    },
    /// Nothing to hold.
    #[error(
        "{file}: no place to hold the plug was found: two faces across y, with a shoulder above them for \
         the fingers' roofs; give --like T, whose grip fits, or write [grip] by hand"
    )]
    NoGrip {
        /// The file.
        file: String,
    },
    /// To be approximated more finely than there is time for.
    #[error(
        "{file}: is no solid of flat sides that up to {MOST_PARTS} convex pieces make, and approximating it \
         with --resolution {resolution} would take minutes: give --resolution {finest} or less, export \
         the mesh with fewer flats (a circle of 32 is exact), begin with `optimize task new --round`, \
         or write its parts by hand (docs/guide/tasks.md)"
    )]
    Long {
        /// The file.
        file: String,
        /// As asked for, voxels along the longest side.
        resolution: u32,
        /// What does not take long.
        finest: u32,
    },
    /// More parts than a task may have.
    #[error(
        "{file}: comes to {parts} convex hulls; a task may have {MOST_PARTS}: export the mesh with fewer \
         flats (a circle of 32 is exact), begin with `optimize task new --round`, or write its parts \
         by hand (docs/guide/tasks.md)"
    )]
    Many {
        /// The file.
        file: String,
        /// How many.
        parts: usize,
    },
    /// No strategy.
    #[error(transparent)]
    Plan(#[from] super::plan::PlanError),
}
