//! Levers: numbers beside the infill that a user could change, and what each does to a finger's range.
//!
//! One number at a time goes to the ends of its interval, with the start taught again for each.

mod lever;
mod measure;
mod question;
mod rows;

pub use lever::{Base, Lever, Levers, apart, counts, plain};
pub use question::Question;
