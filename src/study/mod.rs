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

pub use cache::Cache;
pub use config::{
    Conclusion, Confirmation, INDIFFERENCE_MM, INDIFFERENCES_MM, LARGEST_BATCH, LARGEST_BUDGET,
    StudyConfig, study_name,
};
pub use course::{Arrived, Course, Ending, Next, Wanted};
pub use error::{LineError, StudyError};
pub use folder::{
    CONFIG_FILE, FINGER, IfChanged, Inputs, JOURNAL_FILE, Study, input_path, read_config, sha256,
    write_file, write_own_file,
};
pub use header::SCHEMA_VERSION;
pub use journal::Journal;
pub use line::{decode, encode};
pub use on_bench::{BenchEffort, BenchFinger, LeaveOneOut, OnBench};
pub use provenance::{BENCH_ROLES, Provenance, SOURCES, Segment};
pub use record::{
    ByRibs, Recorded, StudyRecord, Timing, Volume, Walked, best, front, nearest, volume,
};
pub use runner::{Judge, Runner};
pub use seal::{sha256_hex, strip_times};
pub use simulated::Simulated;
pub use store::{FileStore, Store};
pub use table::{evaluations_csv, write_evaluations_csv};
pub use walk::{Confirmed, Confirmer, Kept};
pub use work::{Work, WorkError};
