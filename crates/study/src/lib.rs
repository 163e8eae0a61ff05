//! Studies: seeded runs of one optimizer on one or several tasks and a space. A study is recorded in a folder and
//! can be resumed after the process was killed.
#![allow(missing_docs)]

mod cache;
mod cached_evaluator;
mod config;
mod confirmed;
mod confirmer;
mod differences;
mod error;
mod folder;
mod header;
mod journal;
mod limits;
mod line;
mod lock;
mod on_bench;
mod provenance;
mod race;
mod recommendation;
mod record;
mod rule;
mod runner;
mod scheduler;
mod seal;
mod table;
mod work;

pub use cache::Cache;
pub use cached_evaluator::CachedEvaluator;
pub use config::{
    AnalysisSettings, BenchEffort, Confirmation, INDIFFERENCES_MM, LARGEST_BATCH, LARGEST_BUDGET,
    StudyConfig, study_name,
};
pub use confirmer::{ConfirmationLog, ConfirmationStep, Confirmer};
pub use error::StudyError;
pub use folder::{
    CELL, FINGER, Inputs, ROBOT_STOP_FILE, Study, has_begun, input_path, read_analysis, read_config,
};
pub use folder::{sha256, write_analysis, write_file, write_own_file};
pub use limits::ForceLimits;
pub use line::{decode, encode};
pub use on_bench::{BENCH_FILE, BenchFinger, BenchPrediction, LeaveOneOut};
pub use provenance::{BENCH_ROLES, Provenance, SOURCES, Segment};
pub use record::{ByRibs, Recorded, StudyRecord, Timing, Volume, Walked, best, nearest, volume};
pub use runner::Runner;
pub use scheduler::{Ending, Next, Proposal, ProposalResult, Scheduler};
pub use seal::sha256_hex;
pub use table::{EVALUATIONS_CSV, evaluations_csv};
pub use work::{Work, WorkError};
