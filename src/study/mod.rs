//! Studies: seeded runs of one optimizer on one task and space, in a folder
//! that survives whatever happens to the process.

mod config;
mod record;

pub use config::{StudyConfig, Versions};
pub use record::{Recorded, StudyRecord, Timing, best};
