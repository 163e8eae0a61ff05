//! Studies run in this process, with an evaluator of the test.

use ask_tell::{Grid, Optimizer};
use insertion::evaluation::evaluator::Evaluate;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use study::{Ending, Runner, Study, StudyError, StudyRecord};

/// Runs the study in a folder on so many threads.
pub fn run(
    dir: &Path,
    evaluator: &dyn Evaluate,
    optimizer: &dyn Fn(Grid) -> Box<dyn Optimizer>,
    threads: usize,
) -> Result<(Ending, StudyRecord), StudyError> {
    let mut study = Study::resume(dir)?;
    let mut optimizer = optimizer(Grid::new(study.config.space.levels()));
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let stop = &AtomicBool::new(false);
    let runner = Runner { evaluator, pool: &pool, stop };
    let ending = runner.run(&mut study, &mut *optimizer, &mut |_, _| Ok(false), &mut |_| ())?;
    Ok((ending, study.record()))
}
