//! The printed finger: its profile, its stiffness from its ribs, its picture.
//!
//! ```text
//! geometry (outline, fit, polygon) -> mesh -> meshed -> condense (halving, frontal)
//!     elements: elasticity (in the plane), plate (across it) -> stiffness, mechanics, picture
//! ```
#![forbid(unsafe_code)]
#![warn(missing_docs)]
#![deny(clippy::print_stdout, clippy::print_stderr)]
// A panic is a defect; what input can reach is an error with a message.
#![cfg_attr(not(test), deny(clippy::unwrap_used, clippy::expect_used, clippy::panic))]
pub mod condense;
pub mod elasticity;
pub mod export;
mod fit;
mod frontal;
pub mod geometry;
mod halving;
pub mod infill;
pub mod mechanics;
pub mod mesh;
pub mod meshed;
mod outline;
pub mod picture;
pub mod plate;
pub mod polygon;
pub mod printed;
pub mod stiffness;
#[cfg(test)]
mod tests;

/// Reason why a printed finger cannot be.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FingerError {
    /// A number of the finger file or the design out of range, or parts that do not fit.
    #[error(transparent)]
    Value(#[from] input::InputError),
    /// A profile that cannot be meshed.
    #[error("{file}: the profile cannot be meshed: {problem}")]
    Mesh {
        /// Finger file.
        file: String,
        /// Reason.
        problem: mesh::MeshError,
    },
    /// A stiffness that no such finger has.
    #[error(
        "{file}: the units look wrong: the compliance stiffness comes out as {compliance:.3e} N/mm, \
         a finger has 0.05 to 100; check that lengths are in mm and material.modulus_gpa in GPa \
         (PETG has 2)"
    )]
    Units {
        /// Finger file.
        file: String,
        /// Computed compliance stiffness, N/mm.
        compliance: f64,
    },
    /// Springs that cannot be about this remote centre.
    #[error(
        "{file}: a finger of {at_pad:.2} N/mm in {axis} at its pad cannot turn about a centre \
         {lever:.1} mm beside it at {tilting:.2} N m/rad: that alone gives way at {turning:.2} N/mm; \
         bring finger.rcc_mm nearer to the pad, or use --finger-model paper"
    )]
    Springs {
        /// Finger file.
        file: String,
        /// `compliance` or `assembly`.
        axis: &'static str,
        /// Stiffness at the pad, N/mm.
        at_pad: f64,
        /// Distance of the remote centre across that direction, mm.
        lever: f64,
        /// Tilting stiffness, N m/rad.
        tilting: f64,
        /// Stiffness at the pad of the tilting spring alone, N/mm.
        turning: f64,
    },
    /// A task whose file couples springs that are computed.
    #[error(
        "the task `{task}`: finger.coupling goes with --finger-model paper; the springs of a \
         computed finger are coupled as its ribs say"
    )]
    Coupled {
        /// Name of the task.
        task: String,
    },
}

impl FingerError {
    fn mesh(geometry: &geometry::Geometry, problem: mesh::MeshError) -> Self {
        FingerError::Mesh { file: geometry.finger.file.clone(), problem }
    }
}
