//! Studies: opened, run on the threads of this process or measured by the caller, concluded and reported.

pub mod analysis;
pub mod ask_tell;
pub mod concluded;
mod film;
pub mod on_bench;
pub mod open;
mod optimizer;
mod printable;
pub mod recommended;
pub mod report;
pub mod request;
pub mod standing;
pub mod summary;
pub mod sweep;
pub mod text;
mod unusable;
