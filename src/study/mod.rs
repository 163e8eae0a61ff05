//! Studies: seeded runs of one optimizer on one task and space, in a folder
//! that survives whatever happens to the process.

mod attributes;
mod cache;
mod config;
mod error;
mod evaluator;
mod folder;
mod header;
mod journal;
mod line;
mod record;
mod runner;
mod seal;
mod store;
mod table;
mod time;

pub use cache::{Cache, Key};
pub use config::{StudyConfig, Versions, study_name};
pub use error::{LineError, StudyError};
pub use evaluator::{Evaluate, Measured, Simulated};
pub use folder::{
    CONFIG_FILE, Inputs, JOURNAL_FILE, Study, read_config, read_inputs, sha256, write_file,
};
pub use header::SCHEMA_VERSION;
pub use journal::Journal;
pub use line::{decode, encode};
pub use record::{Recorded, StudyRecord, Timing, Volume, best, front, nearest, volume};
pub use runner::{Ending, Runner};
pub use seal::strip_times;
pub use store::{FileStore, Store};
pub use table::write_evaluations_csv;
