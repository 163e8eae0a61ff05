//! Plots and pages of a study and of the stiffness model: pure functions of
//! what was measured. Nothing here simulates, and nothing reads or writes files.

mod again;
mod bench;
mod best;
mod chart;
pub mod compare;
mod compare_plot;
mod convergence;
mod drawn;
mod elements;
mod explore;
mod front;
mod limits;
mod marks;
mod page;
pub mod printer;
mod provenance;
mod published;
pub mod quartiles;
pub mod replay;
pub mod sensitivity;
mod shape;
pub mod stiffness;
mod stiffness_plot;
mod surface;
#[cfg(test)]
mod tests;
mod theme;
mod windows;

use crate::study::StudyRecord;

pub use compare_plot::svg as compare_svg;
pub use page::{Beside, Replay, card, page};

/// Why a plot could not be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ReportError {
    /// The drawing library refused.
    #[error("cannot draw {plot}: {problem}")]
    Draw {
        /// The plot.
        plot: &'static str,
        /// The library's message.
        problem: String,
    },
}

/// `convergence.svg`: value of each evaluation and best so far (of several objectives the
/// hypervolume) against the number of evaluations, on a white ground.
///
/// # Errors
/// If the drawing library refuses.
pub fn convergence_svg(record: &StudyRecord) -> Result<String, ReportError> {
    convergence::svg(record, (880, 480))
}

/// `front.svg`: the first two objectives of all evaluations and the front, on a white ground;
/// `None` if there is one objective only or nothing has values.
///
/// # Errors
/// If the drawing library refuses.
pub fn front_svg(record: &StudyRecord) -> Result<Option<String>, ReportError> {
    front::svg(record, (880, 480))
}
