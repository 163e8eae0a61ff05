//! Studies: opening, evaluation of designs on the threads of this process or by the caller, output and reports.

pub mod analysis;
pub mod ask_tell;
pub mod best_so_far;
mod film;
pub mod on_bench;
pub mod open;
mod optimizer;
pub mod output;
mod printable;
pub(crate) use printable::study_name;
pub mod recommended;
pub mod report;
pub mod request;
pub mod summary;
pub mod sweep;
pub mod text;
mod unusable;
