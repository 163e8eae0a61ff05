//! Studies: seeded runs of one optimizer on one task and space, in a folder
//! that survives whatever happens to the process.
#![forbid(unsafe_code)]
#![deny(clippy::print_stdout, clippy::print_stderr)]
// A panic is a defect; what input can reach is an error with a message.
#![cfg_attr(not(test), deny(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

mod cache;
mod config;
mod course;
mod differences;
mod error;
mod fits;
mod folder;
mod header;
mod journal;
mod line;
mod on_bench;
mod plausible;
mod provenance;
mod race;
mod recommendation;
mod record;
mod rule;
mod runner;
mod seal;
mod simulated;
mod store;
mod table;
mod time;
mod walk;
mod walked;
mod work;

pub use cache::Cache;
pub use config::{
    BenchEffort, Conclusion, Confirmation, INDIFFERENCES_MM, LARGEST_BATCH, LARGEST_BUDGET,
    StudyConfig, study_name,
};
pub use course::Ending;
pub use course::{Arrived, Course, Next, Wanted};
pub use error::StudyError;
pub use folder::{
    CELL, FINGER, IfChanged, Inputs, input_path, read_config, sha256, write_own_file,
};
pub use folder::{Study, write_file};
pub use line::{decode, encode};
pub use on_bench::{BenchFinger, LeaveOneOut, OnBench};
pub use provenance::{BENCH_ROLES, Provenance};
pub use provenance::{SOURCES, Segment};
pub use record::{ByRibs, Volume, Walked, best, nearest, volume};
pub use record::{Recorded, StudyRecord, Timing};
pub use runner::Runner;
pub use seal::sha256_hex;
pub use seal::strip_times;
pub use simulated::Simulated;
pub use store::Store;
pub use table::evaluations_csv;
pub use table::write_evaluations_csv;
pub use walk::{Confirmed, Confirmer, Kept};
pub use work::{Work, WorkError};
