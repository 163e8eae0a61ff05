//! Plots, tables, texts and pages of the recorded results: pure functions without simulation or file access.

pub mod answer;
mod bar;
mod bench;
pub mod calibrate;
mod chart;
pub mod compare;
mod convergence;
mod elements;
mod explore;
mod front;
mod glossary;
pub mod identify;
pub mod levers;
pub mod map;
mod marks;
mod overview;
mod page;
mod page_files;
pub mod printer;
mod provenance;
pub mod replay;
mod selection;
pub mod sensitivity;
mod shape;
pub mod sheet;
pub mod stiffness;
mod surface;
#[cfg(test)]
mod tests;
mod text_table;
mod theme;
mod ties;

pub use convergence::svg as convergence_svg;
pub use front::svg as front_svg;
pub use overview::preferred;
pub use page::{card, page};
pub use page_files::{FilmPair, PageFiles, PostAnalysis};
pub use text_table::text_table;

/// Error of the drawing library, or of the model whose curve is drawn.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("cannot draw {plot}: {problem}")]
pub struct ReportError {
    /// Name of the plot.
    plot: &'static str,
    /// Message of the library or of the model.
    problem: String,
}
