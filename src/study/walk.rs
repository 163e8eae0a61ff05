//! Walks the best designs of a study; why is in `walked.rs`.

use super::error::StudyError;
use super::folder::{Study, write_own_file};
use super::record::{Recorded, Walked};
use super::walked::{WALK_FILE, WalkFile, WalkedRow, candidates, decides, ranked};
use crate::evaluation::evaluator::Evaluate;
use rayon::ThreadPool;
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};

/// Walks the best designs of a study, those that were walked before left out, and keeps what
/// that finds. Nothing is kept once `stop` is set.
pub fn walk_best(
    study: &Study,
    walker: &dyn Evaluate,
    pool: &ThreadPool,
    stop: &AtomicBool,
) -> Result<Vec<Walked>, StudyError> {
    let (record, goals) = (study.record(), study.config.goals());
    if !decides(&goals) {
        return Ok(Vec::new());
    }
    let best = candidates(&goals, record.current());
    let known = |index: u64| record.walked.iter().find(|w| w.recorded.index == index);
    let walk = |recorded: &&Recorded| -> Result<WalkedRow, StudyError> {
        let tasks = match known(recorded.index) {
            Some(walked) => walked.recorded.tasks.clone(),
            None => {
                walker
                    .evaluate(&recorded.design)
                    .map_err(|source| StudyError::Impossible {
                        index: recorded.index,
                        design: recorded.design.to_string(),
                        source,
                    })?
                    .tasks
            }
        };
        Ok(WalkedRow { evaluation: recorded.index, tasks })
    };
    let rows = pool.install(|| best.par_iter().map(walk).collect::<Result<Vec<_>, _>>())?;
    if stop.load(Ordering::SeqCst) || rows.is_empty() {
        return Ok(Vec::new());
    }
    let walked = ranked(&goals, record.current(), &rows);
    let file = WalkFile { provenance: study.provenance().clone(), walked: rows };
    let path = study.dir().join(WALK_FILE);
    let text = serde_json::to_string(&file)
        .map_err(|error| StudyError::File { path: path.clone(), problem: error.to_string() })?;
    write_own_file(&path, &(text + "\n"))?;
    Ok(walked)
}
