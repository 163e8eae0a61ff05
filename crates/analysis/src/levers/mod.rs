//! Levers: parameters other than the infill that a user can change, and their effect on a finger's range.
//!
//! One-at-a-time sensitivity analysis: each parameter is set to both ends of its interval, with the start taught again
//! each time.

mod bounds;
mod lever;
mod measure;

pub use lever::{Base, Lever, Levers, difference_mm, is_relevant, thousandths};
pub use measure::LeverAnalysis;
