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
