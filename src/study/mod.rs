//! Studies: seeded runs of one optimizer on one task and space, in a folder
//! that survives whatever happens to the process.

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

pub(crate) use cache::Cache;
pub(crate) use config::{
    Conclusion, Confirmation, INDIFFERENCE_MM, INDIFFERENCES_MM, LARGEST_BATCH, LARGEST_BUDGET,
    StudyConfig, study_name,
};
pub use course::Ending;
pub(crate) use course::{Arrived, Course, Next, Wanted};
pub use error::StudyError;
pub(crate) use folder::{
    CELL, FINGER, IfChanged, Inputs, input_path, read_config, sha256, write_own_file,
};
pub use folder::{Study, write_file};
pub use line::{decode, encode};
pub(crate) use on_bench::{BenchEffort, BenchFinger, LeaveOneOut, OnBench};
pub(crate) use provenance::{BENCH_ROLES, Provenance};
pub use provenance::{SOURCES, Segment};
pub(crate) use record::{ByRibs, Volume, Walked, best, nearest, volume};
pub use record::{Recorded, StudyRecord, Timing};
pub use runner::Runner;
pub(crate) use seal::sha256_hex;
pub use seal::strip_times;
pub(crate) use simulated::Simulated;
pub use store::Store;
pub use table::evaluations_csv;
pub(crate) use table::write_evaluations_csv;
pub(crate) use walk::{Confirmed, Confirmer, Kept};
pub(crate) use work::{Work, WorkError};
