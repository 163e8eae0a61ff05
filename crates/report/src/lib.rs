//! Plots and pages of a study and of the stiffness model: pure functions of the recorded results,
//! without simulation or file access.
#![forbid(unsafe_code)]
#![warn(missing_docs)]
#![deny(clippy::print_stdout, clippy::print_stderr)]
// A panic is a bug; invalid input must produce an error with a message.
#![cfg_attr(not(test), deny(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

pub mod answer;
mod bar;
mod bench;
mod beside;
pub mod calibrate;
mod chart;
pub mod compare;
mod convergence;
mod drawn;
mod elements;
mod explore;
mod first;
mod front;
mod glossary;
pub mod identify;
pub mod levers;
pub mod map;
mod marks;
mod page;
pub mod printer;
mod provenance;
pub mod replay;
pub mod sensitivity;
mod set;
mod shape;
pub mod sheet;
pub mod stiffness;
mod surface;
#[cfg(test)]
mod tests;
mod text_table;
mod theme;

pub use beside::{Film, PageFiles, PostAnalysis};
pub use convergence::svg as convergence_svg;
pub use first::preferred;
pub use front::svg as front_svg;
pub use page::{card, page};
pub use text_table::text_table;

/// Error of the drawing library.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("cannot draw {plot}: {problem}")]
pub struct ReportError {
    /// Name of the plot.
    plot: &'static str,
    /// The library's message.
    problem: String,
}
