//! A study whose designs are measured by somebody else: a process pool, a cluster. It says
//! what is to be measured, checks what comes back, and writes the journal.

use super::progress::Progress;
use super::session::{self, SessionArguments};
use super::setup::Setup;
use super::{Failure, call, resume, study, summary, unusable};
use crate::study::{
    Arrived, Cache, Course, Ending, Next, Simulated, Study, StudyError, Timing, Wanted, Work,
    WorkError, now,
};
use ask_tell::Optimizer;
use input::shipped::Source;
use insertion::evaluation::evaluator::Evaluate;
use insertion::evaluation::objective::Measure;
use insertion::evaluation::robustness::Plan;
use insertion::evaluation::tolerance::Search;
use insertion::trial::NEVER;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

/// A study that is open; no other process can open it meanwhile.
pub struct Guided {
    study: Study,
    setup: Setup,
    session: SessionArguments,
    plan: Plan,
    cache: Option<Cache>,
    optimizer: Box<dyn Optimizer + Send>,
    course: Course,
    /// What is being measured, by the number of its proposal.
    measuring: BTreeMap<u64, Work>,
    progress: Progress,
}

/// What is to be done next.
pub enum Order {
    /// Let these be measured: number of the proposal, and the bytes for [`perform`].
    Measure(Vec<(u64, Vec<u8>)>),
    /// Wait for a result.
    Wait,
    /// [Finish](Guided::finish).
    Finish(Ending),
}

/// Why a result was not taken.
pub enum NotTaken {
    /// It is not believed; the work may be done again.
    Refused(WorkError),
    /// The study cannot go on.
    Failed(Failure),
}

impl Guided {
    /// Begins or continues the study of `optimize` with these words; `tasks`, if there are
    /// any, in place of the files that `--task` names; `workers` is the batch unless one is
    /// given or the study has one.
    ///
    /// # Errors
    /// As the command fails before it measures.
    pub fn begin(
        words: &[String],
        tasks: &[Source],
        workers: Option<u64>,
    ) -> Result<Self, Failure> {
        let mut arguments: study::Arguments = call::read(words)?;
        arguments.setup.given = tasks.to_vec();
        let (study, setup) = arguments.open(workers)?;
        Guided::new(study, setup, arguments.session)
    }

    /// Continues the study in a folder as `optimize resume` does with these words.
    ///
    /// # Errors
    /// As the command fails before it measures.
    pub fn resume(words: &[String]) -> Result<Self, Failure> {
        let arguments: resume::Arguments = call::read(words)?;
        let (study, setup) = arguments.open()?;
        Guided::new(study, setup, arguments.session)
    }

    fn new(study: Study, setup: Setup, session: SessionArguments) -> Result<Self, Failure> {
        session::check(&study.config, &setup)?;
        let optimizer = session::optimizer(&setup, &study.config)?;
        let (course, progress) = (Course::new(&study), Progress::new(&study, true));
        let goals = study.config.goals();
        let plan = setup.plan(study.config.seed, |measure| goals.need(measure))?;
        let (cache, measuring) = (session.cache(&setup), BTreeMap::new());
        Ok(Guided { study, setup, session, plan, cache, optimizer, course, measuring, progress })
    }

    /// What is to be done next. What the cache knows is taken from there.
    ///
    /// # Errors
    /// If the journal holds other designs than are proposed, or cannot be written.
    pub fn order(&mut self) -> Result<Order, Failure> {
        loop {
            let wanted = match self.course.next(&self.study, &mut *self.optimizer)? {
                Next::Wait => return Ok(Order::Wait),
                Next::Ended(ending) => return Ok(Order::Finish(ending)),
                Next::Measure(wanted) => wanted,
            };
            let mut unknown = Vec::new();
            for wanted in wanted {
                if !self.recall(&wanted)? {
                    unknown.push(self.give(wanted)?);
                }
            }
            if !unknown.is_empty() {
                return Ok(Order::Measure(unknown));
            }
        }
    }

    /// Takes a design's evaluation from the cache; false if it is not there.
    fn recall(&mut self, wanted: &Wanted) -> Result<bool, Failure> {
        let (datetime_start, clock) = (now(), Instant::now());
        let Some(measured) = self.simulated(&NEVER).known(&wanted.design) else {
            return Ok(false);
        };
        let timing = Timing {
            datetime_start,
            datetime_complete: now(),
            wall_s: clock.elapsed().as_secs_f64(),
            cached: measured.cached.clone(),
        };
        self.accept(Arrived { proposal: wanted.proposal, measured, timing })
    }

    fn give(&mut self, wanted: Wanted) -> Result<(u64, Vec<u8>), Failure> {
        let work = self.work(wanted);
        let bytes = work.encode().map_err(|error| Failure::running(error.to_string()))?;
        let proposal = work.proposal;
        self.measuring.insert(proposal, work);
        Ok((proposal, bytes))
    }

    fn simulated<'a>(&'a self, stop: &'a AtomicBool) -> Simulated<'a> {
        let (evaluator, plan, cache) = (&self.setup.evaluator, &self.plan, self.cache.as_ref());
        Simulated { evaluator, search: Search::default(), plan, cache, stop }
    }

    fn work(&self, Wanted { proposal, design }: Wanted) -> Work {
        let goals = self.study.config.goals();
        Work {
            proposal,
            design,
            seed: self.study.config.seed,
            success_rate: goals.need(Measure::SuccessRate),
            robust_range: goals.need(Measure::RobustRange),
            tasks: self.study.config.tasks.len() as u64,
            provenance: self.study.provenance().clone(),
            inputs: self.setup.inputs.clone(),
        }
    }

    /// Takes in the result of a proposal; false if it is not awaited (it came before).
    ///
    /// # Errors
    /// If the result cannot be one of this work, or the journal cannot be written.
    pub fn take(&mut self, proposal: u64, result: &[u8]) -> Result<bool, NotTaken> {
        let Some(work) = self.measuring.get(&proposal) else { return Ok(false) };
        let impossible = |error| NotTaken::Failed(Failure::input(error));
        let stiffness = self.setup.evaluator.predict(&work.design).map_err(impossible)?;
        let arrived = work.check(result, &stiffness).map_err(NotTaken::Refused)?;
        self.simulated(&NEVER).keep(&work.design, &arrived.measured);
        let taken = self.accept(arrived).map_err(NotTaken::Failed)?;
        self.measuring.remove(&proposal);
        Ok(taken)
    }

    fn accept(&mut self, arrived: Arrived) -> Result<bool, Failure> {
        let progress = &mut self.progress;
        let mut see = |recorded: &_| progress.measured(recorded);
        let taken = self.course.take(&mut self.study, arrived, &mut see);
        taken.map_err(|error| session::hint(self.study.rescue(error), &self.study))
    }

    /// Evaluations written, evaluations in all, and the best so far in words.
    pub fn progress(&self) -> (usize, u64, String) {
        let evaluations = self.study.config.evaluations();
        (self.study.evaluations.len(), evaluations, self.progress.best())
    }

    /// How to go on with the study.
    pub fn hint(&self) -> String {
        session::resume_hint(&self.study)
    }

    /// Confirms what is recommended on the threads of this process, writes tables and report,
    /// and gives what the command prints, and its failure if no design inserts anywhere.
    ///
    /// # Errors
    /// If a file cannot be written; if `stop` is set meanwhile.
    pub fn finish(
        &mut self,
        ending: Ending,
        stop: &AtomicBool,
    ) -> Result<(String, Option<Failure>), Failure> {
        let Guided { study, setup, session, cache, .. } = self;
        let known = cache.as_ref().map_or(0, Cache::found);
        let (pool, ended) = (session.pool()?, (ending, cache.as_ref()));
        let record = session::conclude(study, setup, session, ended, &pool, stop)?;
        let text = summary::words(study.dir(), &record, ending, known, session.json);
        Ok((text, unusable::check(study.dir(), &record, setup).err()))
    }

    /// How many threads measure if nobody else does; 0 for one per processor.
    pub fn threads(&self) -> usize {
        self.session.threads()
    }
}

/// What was last set up, by the bytes that name it: one worker measures many designs of one study.
static LAST: Mutex<Option<(Value, Arc<Setup>)>> = Mutex::new(None);

fn set_up(work: &Work) -> Result<Arc<Setup>, Failure> {
    let name = json!([work.inputs, work.provenance.engine.name]);
    let mut last = LAST.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((known, setup)) = &*last
        && *known == name
    {
        return Ok(Arc::clone(setup));
    }
    let setup = Arc::new(Setup::from_inputs(&work.inputs, &work.provenance.engine.name)?);
    *last = Some((name, Arc::clone(&setup)));
    Ok(setup)
}

/// The unit of work: what a [`Guided`] study gave out in, the result for it out. Depends on
/// nothing else, so it may be done twice. `worker` is the host and process that does it.
///
/// # Errors
/// If the bytes are no work, this program is not the one that the study wants, or the design
/// cannot be simulated; if `stop` is set meanwhile.
pub fn perform(bytes: &[u8], worker: &str, stop: &AtomicBool) -> Result<Vec<u8>, Failure> {
    // One thread: whoever calls has as many workers as there are processors. And a new one: a
    // process that was forked has not the threads of the pool that all share.
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    let alone =
        alone.map_err(|error| Failure::running(format!("cannot start a thread: {error}")))?;
    alone.install(|| measure(bytes, worker, stop))
}

fn measure(bytes: &[u8], worker: &str, stop: &AtomicBool) -> Result<Vec<u8>, Failure> {
    let work = Work::decode(bytes).map_err(Failure::input)?;
    let setup = set_up(&work)?;
    work.admit(&setup.provenance(), worker).map_err(Failure::input)?;
    let plan = setup.plan(work.seed, |measure| match measure {
        Measure::SuccessRate => work.success_rate,
        Measure::RobustRange => work.robust_range,
        _ => false,
    })?;
    let (evaluator, search) = (&setup.evaluator, Search::default());
    let simulated = Simulated { evaluator, search, plan: &plan, cache: None, stop };
    let (datetime_start, clock) = (now(), Instant::now());
    let measured = simulated.evaluate(&work.design).map_err(|source| {
        let (index, design) = (work.proposal, work.design.to_string());
        StudyError::Impossible { index, design, source }
    })?;
    if stop.load(Ordering::SeqCst) {
        return Err(Failure::running("interrupted"));
    }
    let wall_s = clock.elapsed().as_secs_f64();
    let datetime_complete = now();
    let timing = Timing { datetime_start, datetime_complete, wall_s, cached: Vec::new() };
    work.done(measured, &timing, worker).map_err(|error| Failure::running(error.to_string()))
}
