//! Printed finger: profile, stiffness computed from its ribs, picture, files for 3D printing.
//!
//! A notch near the tip holds the gripped part: its *pad*, from tip to corner, presses on the part's side, and its
//! *roof*, perpendicular to the pad, rests on the part. The *base*, at the other end, has no ribs; the gripper clamps a
//! part of it.
//!
//! ```text
//! outline, holes -> printed -> infill -> geometry (polygon) -> mesh -> meshed -> condense (halving, frontal)
//!     elements: elasticity (in the plane), plate (out of it) -> stiffness, mechanics, picture
//! ```

pub mod condense;
pub mod elasticity;
pub mod export;
mod frontal;
pub mod geometry;
mod halving;
pub mod holes;
pub mod infill;
pub mod mechanics;
pub mod mesh;
pub mod meshed;
pub mod outline;
pub mod picture;
pub mod plate;
pub mod polygon;
pub mod printed;
pub mod stiffness;
#[cfg(test)]
mod tests;

/// Error of a printed finger.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FingerError {
    /// A number of the finger file or the design is out of range, parts do not fit together, the finger cannot be
    /// meshed, or its stiffness is not plausible.
    #[error(transparent)]
    Value(#[from] input::InputError),
    /// The task file couples springs, but they are computed from the ribs.
    #[error(
        "the task `{task}`: finger.coupling goes with --finger-model paper; the springs of a \
         computed finger are coupled by its ribs"
    )]
    Coupled {
        /// Name of the task.
        task: String,
    },
}

impl input::Placed for FingerError {
    fn place(&self) -> input::Place {
        match self {
            FingerError::Value(error) => error.place(),
            FingerError::Coupled { .. } => input::Place::default().key("finger_model"),
        }
    }
}

impl FingerError {
    /// Creates an error about a finger as a whole, not about one of its values.
    pub fn finger(finger: &printed::PrintedFinger, problem: String) -> Self {
        FingerError::Value(input::Place::file(&finger.file).fault(problem))
    }

    fn mesh(geometry: &geometry::Geometry, problem: mesh::MeshError) -> Self {
        let problem = format!("the profile cannot be meshed: {problem}");
        FingerError::finger(&geometry.finger, problem)
    }
}
